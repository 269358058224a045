"""Makes the almanac that a constellation broadcasts, from its ephemerides: fewer parameters, in the message's coarse steps."""

from __future__ import annotations

import math
from collections.abc import Iterable

from safeloc.sensing.satellite.almanac import Almanac, AlmanacOrbit
from safeloc.sensing.satellite.ephemeris import Ephemeris
from safeloc.sensing.satellite.figures import EARTH_GRAVITY_M3_PER_S2

_HALF_TURN = math.pi
_STEPS = {
    "eccentricity": 2.0**-21,
    "inclination": 2.0**-19 * _HALF_TURN,
    "omega_dot": 2.0**-38 * _HALF_TURN,
    "sqrt_a": 2.0**-11,
    "omega0": 2.0**-23 * _HALF_TURN,
    "omega": 2.0**-23 * _HALF_TURN,
    "m0": 2.0**-23 * _HALF_TURN,
}
"""IS-GPS-200, table 20-VI: the value of the last bit; angles are half turns there."""


def broadcast_almanac(ephemerides: Iterable[Ephemeris]) -> Almanac:
    """Return the almanac of these satellites; of several ephemerides of one, the last counts."""
    last = {one.satellite: one for one in ephemerides}
    return Almanac(tuple(_coarse(one) for one in last.values()))


def _coarse(e: Ephemeris) -> AlmanacOrbit:
    motion = math.sqrt(EARTH_GRAVITY_M3_PER_S2) / e.sqrt_a**3 + e.delta_n
    exact = {
        "eccentricity": e.eccentricity,
        "inclination": e.i0,
        "omega_dot": e.omega_dot,
        "sqrt_a": (math.sqrt(EARTH_GRAVITY_M3_PER_S2) / motion) ** (1 / 3),
        "omega0": e.omega0,
        "omega": e.omega,
        "m0": e.m0,
    }
    figures = {name: round(value / _STEPS[name]) * _STEPS[name] for name, value in exact.items()}
    return AlmanacOrbit(satellite=e.satellite, healthy=e.healthy, time_s=e.orbit_time_s, **figures)
