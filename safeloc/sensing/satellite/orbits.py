"""Computes position, velocity and clock of a satellite from its ephemeris (IS-GPS-200, 20.3.3.3.3 and 20.3.3.4.3).

QZSS and Galileo use the same model, with Galileo's own gravity constant (IS-QZSS-PNT, 5.5; Galileo OS SIS ICD, 5.1.1).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from safeloc.errors import InputError
from safeloc.sensing.satellite.ephemeris import Ephemeris
from safeloc.sensing.satellite.figures import (
    EARTH_GRAVITY_M3_PER_S2,
    EARTH_RATE_RAD_PER_S,
    GALILEO_GRAVITY_M3_PER_S2,
    LIGHT_M_PER_S,
    WEEK_S,
)

Vector = tuple[float, float, float]
_HALF_STEP_S = 0.5
_ROOT_GPS, _ROOT_GALILEO = math.sqrt(EARTH_GRAVITY_M3_PER_S2), math.sqrt(GALILEO_GRAVITY_M3_PER_S2)


@dataclass(frozen=True, slots=True)
class SatelliteState:
    """Earth-fixed position (m) and velocity (m/s) at the time of transmission; clock offset (s) and drift (s/s)."""

    position_m: Vector
    velocity_m_per_s: Vector
    clock_s: float
    clock_drift: float


def satellite_state(ephemeris: Ephemeris, time_s: float) -> SatelliteState:
    """Return the state at a GPS time. The velocity is a central difference over 1 s, true to 0.01 mm/s.

    The clock includes relativity and the L1 group delay. InputError outside the window of validity (SAT-D1).
    """
    if not ephemeris.valid_at(time_s):
        raise InputError(f"{ephemeris.satellite}: the ephemeris is not valid at {time_s} s; use a valid one or none.")
    before = earth_fixed_m(ephemeris, time_s - _HALF_STEP_S)
    after = earth_fixed_m(ephemeris, time_s + _HALF_STEP_S)
    velocity = (after[0] - before[0], after[1] - before[1], after[2] - before[2])
    drift = _clock(ephemeris, time_s + _HALF_STEP_S) - _clock(ephemeris, time_s - _HALF_STEP_S)
    return SatelliteState(earth_fixed_m(ephemeris, time_s), velocity, _clock(ephemeris, time_s), drift)


def earth_fixed_m(e: Ephemeris, time_s: float) -> Vector:
    """Return the place at a GPS time without a look at the validity, for orbits whose age is judged elsewhere."""
    since = time_s - e.orbit_time_s
    anomaly = _eccentric_anomaly(e, since)
    true = math.atan2(math.sqrt(1 - e.eccentricity**2) * math.sin(anomaly), math.cos(anomaly) - e.eccentricity)
    argument = true + e.omega
    twice = (math.cos(2 * argument), math.sin(2 * argument))
    latitude = argument + e.cuc * twice[0] + e.cus * twice[1]
    radius = e.sqrt_a**2 * (1 - e.eccentricity * math.cos(anomaly)) + e.crc_m * twice[0] + e.crs_m * twice[1]
    tilt = e.i0 + e.idot * since + e.cic * twice[0] + e.cis * twice[1]
    node = e.omega0 + e.omega_dot * since - EARTH_RATE_RAD_PER_S * (e.orbit_time_s % WEEK_S + since)
    x, y = radius * math.cos(latitude), radius * math.sin(latitude)
    return (
        x * math.cos(node) - y * math.cos(tilt) * math.sin(node),
        x * math.sin(node) + y * math.cos(tilt) * math.cos(node),
        y * math.sin(tilt),
    )


def _eccentric_anomaly(e: Ephemeris, since_s: float) -> float:
    """Solve Kepler's equation by Newton's method; ten steps are far more than an eccentricity below 0.1 needs."""
    mean = e.m0 + (_root_of_gravity(e) / e.sqrt_a**3 + e.delta_n) * since_s
    anomaly = mean
    for _ in range(10):
        step = (anomaly - e.eccentricity * math.sin(anomaly) - mean) / (1 - e.eccentricity * math.cos(anomaly))
        anomaly -= step
        if abs(step) < 1e-14:
            break
    return anomaly


def _clock(e: Ephemeris, time_s: float) -> float:
    since = time_s - e.clock_time_s
    anomaly = _eccentric_anomaly(e, time_s - e.orbit_time_s)
    relativity = -2 * _root_of_gravity(e) / LIGHT_M_PER_S**2 * e.eccentricity * e.sqrt_a * math.sin(anomaly)
    return e.af0_s + e.af1 * since + e.af2_per_s * since**2 + relativity - e.group_delay_s


def _root_of_gravity(e: Ephemeris) -> float:
    return _ROOT_GALILEO if e.satellite.startswith("E") else _ROOT_GPS
