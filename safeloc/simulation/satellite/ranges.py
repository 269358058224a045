"""Computes the true distances that signals travel, for all satellites and epochs at once.

The computation uses an inertial frame; the time of transmission follows from the distance to the receiver at reception. The
front end corrects for the rotation of the Earth instead. Both methods are independent, and agree within a millimetre (tested).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from safeloc.sensing.array_types import Floats
from safeloc.sensing.satellite.ephemeris import Ephemeris
from safeloc.sensing.satellite.figures import (
    EARTH_GRAVITY_M3_PER_S2,
    EARTH_RATE_RAD_PER_S,
    GALILEO_GRAVITY_M3_PER_S2,
    LIGHT_M_PER_S,
    WEEK_S,
)

_FIELDS = (
    "af0_s", "af1", "af2_per_s", "crs_m", "delta_n", "m0", "cuc", "eccentricity", "cus", "sqrt_a", "cic", "omega0",
    "cis", "i0", "crc_m", "omega", "omega_dot", "idot", "group_delay_s",
)  # fmt: skip
_APART_S = 0.05


@dataclass(frozen=True)
class Orbits:
    """The orbits of all satellites, arrays [satellite]. `start_s` is their common reference time, from which times count."""

    start_s: float
    names: tuple[str, ...]
    figures: dict[str, Floats]


def orbits(ephemerides: Sequence[Ephemeris]) -> Orbits:
    """Return the orbits of the ephemerides. ValueError unless orbits and clocks all have one reference time."""
    (start_s,) = {time for one in ephemerides for time in (one.orbit_time_s, one.clock_time_s)}
    figures = {name: np.array([getattr(one, name) for one in ephemerides], dtype=np.float64) for name in _FIELDS}
    figures["root_of_gravity"] = np.sqrt([_gravity(one.satellite) for one in ephemerides])
    return Orbits(start_s, tuple(one.satellite for one in ephemerides), figures)


def _gravity(satellite: str) -> float:
    return GALILEO_GRAVITY_M3_PER_S2 if satellite.startswith("E") else EARTH_GRAVITY_M3_PER_S2


@dataclass(frozen=True)
class Seen:
    """Arrays [epoch, satellite]: distance travelled (m) and its rate, without receiver clock and atmosphere.

    direction  [epoch, satellite, 3] unit vectors from the receiver, Earth-fixed at reception
    """

    way_m: Floats
    rate_m_per_s: Floats
    direction: Floats


def seen(sky: Orbits, times_s: Floats, points_m: Floats, velocities_m_per_s: Floats) -> Seen:
    """Return distances from true times [epoch] (s from the orbits' start), Earth-fixed points and velocities [epoch, 3]."""
    before, _ = _ways(sky, times_s - _APART_S, points_m - _APART_S * velocities_m_per_s)
    after, _ = _ways(sky, times_s + _APART_S, points_m + _APART_S * velocities_m_per_s)
    way, direction = _ways(sky, times_s, points_m)
    return Seen(way, (after - before) / (2 * _APART_S), direction)


def _ways(sky: Orbits, times_s: Floats, points_m: Floats) -> tuple[Floats, Floats]:
    at = times_s[:, None]
    receiver = _turned(points_m, EARTH_RATE_RAD_PER_S * times_s)[:, None, :]
    travel = np.full((len(times_s), len(sky.names)), 0.075)
    for _ in range(3):
        travel = np.linalg.norm(_at_rest(sky, at - travel)[0] - receiver, axis=-1) / LIGHT_M_PER_S
    satellite, clock_s = _at_rest(sky, at - travel)
    travel = np.linalg.norm(satellite - receiver, axis=-1) / LIGHT_M_PER_S
    direction = (satellite - receiver) / (travel * LIGHT_M_PER_S)[..., None]
    back = -EARTH_RATE_RAD_PER_S * np.broadcast_to(at, travel.shape)
    return LIGHT_M_PER_S * (travel - clock_s), _turned(direction, back)


def _at_rest(sky: Orbits, since: Floats) -> tuple[Floats, Floats]:
    """Return clocks, and positions in the inertial frame that is Earth-fixed at the orbits' start (IS-GPS-200, table 20-IV)."""
    f = sky.figures
    eccentricity, axis = f["eccentricity"], f["sqrt_a"] ** 2
    mean = f["m0"] + (f["root_of_gravity"] / f["sqrt_a"] ** 3 + f["delta_n"]) * since
    anomaly = mean
    for _ in range(12):
        anomaly = mean + eccentricity * np.sin(anomaly)
    true = np.arctan2(np.sqrt(1 - eccentricity**2) * np.sin(anomaly), np.cos(anomaly) - eccentricity)
    argument = true + f["omega"]
    cos, sin = np.cos(2 * argument), np.sin(2 * argument)
    latitude = argument + f["cuc"] * cos + f["cus"] * sin
    radius = axis * (1 - eccentricity * np.cos(anomaly)) + f["crc_m"] * cos + f["crs_m"] * sin
    tilt = f["i0"] + f["idot"] * since + f["cic"] * cos + f["cis"] * sin
    node = f["omega0"] + f["omega_dot"] * since - EARTH_RATE_RAD_PER_S * (sky.start_s % WEEK_S)
    x, y = radius * np.cos(latitude), radius * np.sin(latitude)
    place = np.stack(
        (
            x * np.cos(node) - y * np.cos(tilt) * np.sin(node),
            x * np.sin(node) + y * np.cos(tilt) * np.cos(node),
            y * np.sin(tilt),
        ),
        axis=-1,
    )
    relativity = -2 * f["root_of_gravity"] / LIGHT_M_PER_S**2 * eccentricity * f["sqrt_a"] * np.sin(anomaly)
    return place, f["af0_s"] + f["af1"] * since + f["af2_per_s"] * since**2 + relativity - f["group_delay_s"]


def _turned(vectors: Floats, angles: Floats) -> Floats:
    """Return the vectors rotated about the Earth's axis, eastward for positive angles."""
    cos, sin = np.cos(angles), np.sin(angles)
    x, y, z = np.moveaxis(vectors, -1, 0)
    return np.stack((x * cos - y * sin, x * sin + y * cos, z), axis=-1)
