"""A broadcast ephemeris (GPS, QZSS, Galileo) and its window of validity (SAT-D1; [0030]: expired is not usable)."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, fields

from safeloc.errors import InputError

FIT_HOURS = 4.0
"""The curve fit interval if the message does not give it (IS-GPS-200, 20.3.4.4)."""


@dataclass(frozen=True, slots=True)
class Ephemeris:
    """Clock and orbit of one satellite, named as in IS-GPS-200 tables 20-I and 20-II; SI units and radians.

    Times are GPS seconds. InputError for a figure that is not finite, and for an orbit that is not an ellipse.
    """

    satellite: str
    clock_time_s: float
    af0_s: float
    af1: float
    af2_per_s: float
    crs_m: float
    delta_n: float
    m0: float
    cuc: float
    eccentricity: float
    cus: float
    sqrt_a: float
    orbit_time_s: float
    cic: float
    omega0: float
    cis: float
    i0: float
    crc_m: float
    omega: float
    omega_dot: float
    idot: float
    healthy: bool
    group_delay_s: float
    sent_s: float
    fit_hours: float = FIT_HOURS

    def __post_init__(self) -> None:
        for field in fields(self)[1:]:
            if not math.isfinite(getattr(self, field.name)):
                raise InputError(
                    f"ephemeris of {self.satellite}: {field.name} is not a finite number; drop the record."
                )
        if not 0 <= self.eccentricity < 1 or self.sqrt_a <= 0 or self.fit_hours <= 0:
            raise InputError(f"ephemeris of {self.satellite}: not an ellipse with a fit interval; drop the record.")

    def valid_at(self, time_s: float) -> bool:
        """Return whether the satellite is healthy and the time within half the fit interval of the reference time; False for NaN."""
        return self.healthy and abs(time_s - self.orbit_time_s) <= self.fit_hours * 1800


def usable(ephemerides: Iterable[Ephemeris], satellite: str, time_s: float) -> Ephemeris | None:
    """Return the valid ephemeris of a satellite nearest in time; None, and so no prediction, if all have expired.

    It may have been sent after this time, since recordings are distributed with such ephemerides.
    """
    valid = [one for one in ephemerides if one.satellite == satellite and one.valid_at(time_s)]
    return min(valid, key=lambda one: abs(time_s - one.orbit_time_s), default=None)
