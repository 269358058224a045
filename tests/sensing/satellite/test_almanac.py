"""The almanac: elevations that are coarse within a figure, ages, and the reader of its text format (SAT-6)."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from safeloc.errors import StreamError
from safeloc.models.satellite_selection import SelectionConfig
from safeloc.sensing.satellite.almanac import Almanac, read_almanac
from safeloc.sensing.satellite.ephemeris import Ephemeris
from safeloc.sensing.satellite.navigation import read_navigation
from safeloc.sensing.satellite.orbits import earth_fixed_m
from safeloc.sensing.satellite.places import Place
from safeloc.simulation.satellite.almanacs import broadcast_almanac
from safeloc.simulation.satellite.constellation import START_S
from tests.data_sources import data_file
from tests.simulation.satellite.sky import sky

PLACE = Place.degrees(50.0, 8.0, 200.0)
CONFIG = SelectionConfig()
RECORD = """\
******** Week  880 almanac for PRN-05 ********
ID:                         05
Health:                     000
Eccentricity:               0.5927642923E-002
Time of Applicability(s):  147456.0000
Orbital Inclination(rad):   0.9719266524
Rate of Right Ascen(r/s):  -0.8275344701E-008
SQRT(A)  (m 1/2):           5153.635742
Right Ascen at Week(rad):   0.2520897825E+001
Argument of Perigee(rad):   1.273307348
Mean Anom(rad):             0.1714815412E+001
Af0(s):                    -0.1774230040E-003
Af1(s/s):                  -0.1364242053E-011
week:                        880
"""


def elevation_rad(orbit: Ephemeris, time_s: float) -> float:
    """The elevation by the full orbit, whatever its validity."""
    at = PLACE.earth_fixed_m()
    away = [a - b for a, b in zip(earth_fixed_m(orbit, time_s), at, strict=True)]
    x, y, z = (part / math.hypot(*away) for part in away)
    return PLACE.elevation_azimuth_rad((x, y, z))[0]


def errors_mrad(almanac: Almanac, orbits: tuple[Ephemeris, ...], times_s: tuple[float, ...]) -> Iterator[float]:
    """How far the almanac's elevations are off those of the orbits."""
    for orbit in orbits:
        for time_s in times_s:
            told = almanac.elevation_mrad(orbit.satellite, time_s, PLACE)
            assert told is not None
            yield abs(told - 1_000 * elevation_rad(orbit, time_s))


def test_elevations_are_within_the_figure_until_the_almanac_expires() -> None:
    """Of simulated orbits, with the message's rounding, every 17 hours up to the limit: within a fifth of the accuracy."""
    orbits = sky().ephemerides
    times = tuple(START_S + hour * 3_600 for hour in range(0, CONFIG.almanac_limit_s // 3_600 + 1, 17))
    worst = max(errors_mrad(broadcast_almanac(orbits), orbits, times))
    assert worst < CONFIG.almanac_accuracy_mrad / 5


def test_recorded_satellites_are_where_the_almanac_has_them() -> None:
    """An almanac made of each satellite's first recorded ephemeris, against its last one, up to 80 minutes later."""
    every = read_navigation(data_file("gnss_septentrio/base.nav")).ephemerides
    recorded = tuple(one for one in every if one.healthy)
    first = {one.satellite: one for one in reversed(recorded)}
    last = tuple({one.satellite: one for one in recorded}.values())
    times = tuple(max(one.orbit_time_s for one in recorded) + 600 * n for n in range(6))
    assert max(errors_mrad(broadcast_almanac(first.values()), last, times)) < CONFIG.almanac_accuracy_mrad / 5


@pytest.mark.parametrize("figure", ["omega0", "m0", "omega_dot", "inclination"])
def test_a_wrong_orbit_is_noticed(figure: str) -> None:
    """A figure that is left out of one orbit moves its satellite by more than the accuracy within the validity."""
    orbits = tuple(one for one in sky().ephemerides if one.satellite.startswith("G"))
    almanac = broadcast_almanac(orbits)
    wrong = Almanac(tuple(replace(one, **{figure: 0.0}) for one in almanac.orbits))
    times = tuple(START_S + hour * 3_600 for hour in range(0, 144, 17))
    assert max(errors_mrad(wrong, orbits, times)) > CONFIG.almanac_accuracy_mrad / 5


def test_age_counts_both_ways_and_of_the_oldest_orbit() -> None:
    """An almanac of tomorrow is as old as one of yesterday; one orbit that was not renewed makes the whole old."""
    almanac = broadcast_almanac(sky().ephemerides)
    assert [3_600, 3_600, 1] == [almanac.age_s(START_S + later) for later in (3_600, -3_600, 0.25)]
    first, *rest = almanac.orbits
    assert 86_400 == Almanac((replace(first, time_s=START_S - 86_400), *rest)).age_s(START_S)
    assert Almanac(()).age_s(START_S) is None


def test_unknown_and_unhealthy_satellites_have_no_elevation() -> None:
    """Neither may be visible, by the almanac."""
    almanac = broadcast_almanac(sky().ephemerides)
    ill = Almanac(tuple(replace(one, healthy=one.satellite != "G01") for one in almanac.orbits))
    told = [ill.elevation_mrad(name, START_S, PLACE) is None for name in ("G01", "G02", "J01")]
    assert [True, False, True] == told


def written(folder: Path, text: str) -> Path:
    """A file with this text."""
    path = folder / "current.alm"
    path.write_text(text, encoding="ascii")
    return path


def test_the_text_format_is_read(tmp_path: Path) -> None:
    """Figures in the units of the file, the week with what ran over, and the health."""
    ill = RECORD.replace("PRN-05", "PRN-06").replace("ID:                         05", "ID:                         06")
    almanac = read_almanac(written(tmp_path, f"{RECORD}\n{ill.replace('000', '063', 1)}"), roll_overs=2)
    first, second = almanac.orbits
    assert ("G05", True, "G06", False) == (first.satellite, first.healthy, second.satellite, second.healthy)
    assert (2 * 1_024 + 880) * 604_800 + 147_456 == first.time_s
    assert (0.9719266524, 5153.635742, -0.8275344701e-8) == (first.inclination, first.sqrt_a, first.omega_dot)
    full = written(tmp_path, RECORD.replace("week:                        880", "week:                       2320"))
    assert 2_320 * 604_800 + 147_456 == read_almanac(full, roll_overs=2).orbits[0].time_s


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", r"^current\.alm:1: no YUMA almanac: a record begins with a line of asterisks\.$"),
        (RECORD.replace("Health", "Wealth"), r"^current\.alm:1: a record has the lines ID, Health, .*; mend or drop"),
        (RECORD.replace("5153.635742", "unknown"), r"^current\.alm:1: .*'unknown'; mend or drop the record\.$"),
        (RECORD[:200], r"^current\.alm:1: a record has the lines"),
    ],
)
def test_what_is_no_almanac_is_refused(tmp_path: Path, text: str, message: str) -> None:
    """With file and line, and what to do."""
    with pytest.raises(StreamError, match=message):
        read_almanac(written(tmp_path, text), roll_overs=2)


def test_an_orbit_that_is_no_ellipse_is_refused(tmp_path: Path) -> None:
    """At once, and not in the cycle that asks for its satellite."""
    with pytest.raises(StreamError, match=r"^current\.alm:1: ephemeris of G05: not an ellipse"):
        read_almanac(written(tmp_path, RECORD.replace("0.5927642923E-002", "1.5927642923")), roll_overs=2)
