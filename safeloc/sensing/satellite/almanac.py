"""The almanac: coarse orbits of all satellites, from which follows which of them may be visible (SAT-6; [0028], [0029]).

A satellite broadcasts the almanac of its whole constellation. Its orbits hold for days and are kilometres off, so they give
elevations, and no predictions of signals. `read_almanac` reads the usual text format, YUMA.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from safeloc.errors import StreamError
from safeloc.runtime.outside import reading_file
from safeloc.sensing.satellite.ephemeris import Ephemeris
from safeloc.sensing.satellite.log_lines import decimal, integer, log_lines
from safeloc.sensing.satellite.orbits import earth_fixed_m
from safeloc.sensing.satellite.places import Place
from safeloc.sensing.satellite.times import of_week

_ROLL_OVER_WEEKS = 1024
_FIELDS = (
    "ID", "Health", "Eccentricity", "Time of Applicability(s)", "Orbital Inclination(rad)", "Rate of Right Ascen(r/s)",
    "SQRT(A)  (m 1/2)", "Right Ascen at Week(rad)", "Argument of Perigee(rad)", "Mean Anom(rad)", "Af0(s)", "Af1(s/s)", "week",
)  # fmt: skip
"""The lines of a record, in this order (celestrak.org, YUMA definition)."""


@dataclass(frozen=True, slots=True)
class AlmanacOrbit:
    """The orbit of one satellite, as an almanac has it: no harmonics and no rates but that of the node; SI units and radians."""

    satellite: str
    healthy: bool
    time_s: float
    eccentricity: float
    inclination: float
    omega_dot: float
    sqrt_a: float
    omega0: float
    omega: float
    m0: float

    def ephemeris(self) -> Ephemeris:
        """Return the same orbit in the words of an ephemeris, without a clock. InputError for an orbit that is not an ellipse."""
        none = dict.fromkeys(
            ("af0_s", "af1", "af2_per_s", "crs_m", "delta_n", "cuc", "cus", "cic", "cis", "crc_m", "idot", "group_delay_s"), 0.0
        )  # fmt: skip
        return Ephemeris(
            satellite=self.satellite, clock_time_s=self.time_s, m0=self.m0, eccentricity=self.eccentricity, sqrt_a=self.sqrt_a,
            orbit_time_s=self.time_s, omega0=self.omega0, i0=self.inclination, omega=self.omega, omega_dot=self.omega_dot,
            healthy=self.healthy, sent_s=self.time_s, **none,
        )  # fmt: skip


@dataclass(frozen=True)
class Almanac:
    """The orbits of all satellites. InputError for an orbit that is not an ellipse of finite figures."""

    orbits: tuple[AlmanacOrbit, ...]

    def __post_init__(self) -> None:
        _ = self._healthy

    @cached_property
    def _healthy(self) -> dict[str, Ephemeris]:
        every = {one.satellite: one.ephemeris() for one in self.orbits}
        return {name: one for name, one in every.items() if one.healthy}

    def age_s(self, time_s: float) -> int | None:
        """Return the time from applicability to this GPS time, or back, in whole seconds, rounded up; of the orbit farthest away.

        None for an almanac without orbits.
        """
        return max((math.ceil(abs(time_s - one.time_s)) for one in self.orbits), default=None)

    def elevation_mrad(self, satellite: str, time_s: float, place: Place) -> int | None:
        """Return the satellite's elevation, rounded down; None for one that the almanac does not have, or has as unhealthy."""
        orbit = self._healthy.get(satellite)
        if orbit is None:
            return None
        at = place.earth_fixed_m()
        away = [there - here for there, here in zip(earth_fixed_m(orbit, time_s), at, strict=True)]
        length = math.hypot(*away)
        elevation, _ = place.elevation_azimuth_rad((away[0] / length, away[1] / length, away[2] / length))
        return math.floor(elevation * 1_000)


def read_almanac(path: Path, roll_overs: int, letter: str = "G") -> Almanac:
    """Return the almanac of a YUMA file. StreamError names file and line.

    roll_overs  how often the ten bits of the week have run over: 0 up to August 1999, 1 up to April 2019, then 2; it is not in the
                file, and a guess by the clock would make an old file look new. A file whose week exceeds ten bits has it in full
    letter      of the constellation, as in RINEX
    """
    with reading_file(path, path.name):
        return Almanac(tuple(_records(log_lines(path), path, roll_overs, letter)))


def _records(lines: Sequence[str], path: Path, roll_overs: int, letter: str) -> Iterator[AlmanacOrbit]:
    begins = [number for number, line in enumerate(lines) if line.startswith("****")]
    if not begins:
        raise StreamError(f"{path.name}:1: no YUMA almanac: a record begins with a line of asterisks.")
    for at in begins:
        try:
            orbit = _orbit(_values(lines[at + 1 : at + 1 + len(_FIELDS)]), roll_overs, letter)
            orbit.ephemeris()  # refuses an orbit that is not an ellipse of finite figures, here with its line
            yield orbit
        except (ValueError, OverflowError) as error:
            raise StreamError(f"{path.name}:{at + 1}: {error}; mend or drop the record.") from error


def _values(lines: Iterable[str]) -> list[str]:
    found = [tuple(part.strip() for part in line.split(":", 1)) for line in lines]
    if [one[0] for one in found] != list(_FIELDS):
        raise ValueError(f"a record has the lines {', '.join(_FIELDS)}")
    return [one[1] for one in found]


def _orbit(cells: Sequence[str], roll_overs: int, letter: str) -> AlmanacOrbit:
    identity, health, eccentricity, time, inclination, rate, root, node, perigee, anomaly, _, _, week = cells
    weeks = integer(week)
    if weeks < _ROLL_OVER_WEEKS:
        weeks += roll_overs * _ROLL_OVER_WEEKS
    return AlmanacOrbit(
        satellite=f"{letter}{integer(identity):02d}", healthy=integer(health) == 0, time_s=of_week(weeks, decimal(time)),
        eccentricity=decimal(eccentricity), inclination=decimal(inclination), omega_dot=decimal(rate), sqrt_a=decimal(root),
        omega0=decimal(node), omega=decimal(perigee), m0=decimal(anomaly),
    )  # fmt: skip
