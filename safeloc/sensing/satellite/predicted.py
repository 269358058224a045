"""Predicts pseudorange and range rate of a satellite from an estimated state (SAT-1, SAT-2; [0060], [0061]).

Range rate is positive if the distance grows, Doppler if it shrinks: rate = -wavelength * Doppler.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

from safeloc.errors import InputError
from safeloc.sensing.satellite.atmosphere import Klobuchar, troposphere_m
from safeloc.sensing.satellite.ephemeris import Ephemeris
from safeloc.sensing.satellite.figures import EARTH_RATE_RAD_PER_S, L1_WAVELENGTH_M, LIGHT_M_PER_S
from safeloc.sensing.satellite.orbits import SatelliteState, satellite_state
from safeloc.sensing.satellite.places import Place, Vector, dot


@dataclass(frozen=True, slots=True)
class Predicted:
    """Pseudorange (m) and its rate (m/s) without the receiver's clock; unit vector to the satellite; its elevation."""

    pseudorange_m: float
    rate_m_per_s: float
    direction: Vector
    elevation_rad: float


Signal: TypeAlias = Callable[[float, Place, Vector], Predicted]
"""From time of reception (GPS seconds, without the clock's error), place and velocity (m/s) of the antenna to the signal of a satellite."""


def rate_of_doppler(doppler_hz: float, wavelength_m: float = L1_WAVELENGTH_M) -> float:
    """Return the range rate in m/s for a Doppler as in RINEX, positive if the satellite approaches."""
    return -wavelength_m * doppler_hz


def predicted(
    ephemeris: Ephemeris, received_s: float, place: Place, velocity_m_per_s: Vector, ionosphere: Klobuchar | None
) -> Predicted:
    """Predict the satellite's signal at this GPS time of reception (true time, without the clock's bias).

    A clock error of 1 us left in the time costs less than 1 mm. InputError for an expired ephemeris, and for a velocity that
    is not finite. Below the horizon the delay of the atmosphere is omitted: mask low satellites.
    """
    _require_finite(velocity_m_per_s)
    satellite, range_m = _seen(ephemeris, received_s, place.earth_fixed_m())

    def air_m(elevation: float, azimuth: float) -> float:
        return _air_m(place, elevation, azimuth, received_s, ionosphere) if elevation > 0 else 0.0

    return _signal(satellite, range_m, place, velocity_m_per_s, air_m)


def predicted_of_state(sent: SatelliteState, place: Place, velocity_m_per_s: Vector) -> Predicted:
    """Predict a signal that is corrected for the atmosphere, from the satellite's state at transmission.

    The state is Earth-fixed at the time of transmission; the turn of the Earth during the travel is applied here. InputError
    for a velocity that is not finite.
    """
    _require_finite(velocity_m_per_s)
    at = place.earth_fixed_m()
    travel_s = 0.0
    for _ in range(3):
        travel_s = math.dist(_turned(sent.position_m, travel_s), at) / LIGHT_M_PER_S
    satellite = _received(sent, travel_s)
    return _signal(satellite, math.dist(satellite.position_m, at), place, velocity_m_per_s, lambda *_: 0.0)


def _require_finite(velocity_m_per_s: Vector) -> None:
    if not all(map(math.isfinite, velocity_m_per_s)):
        raise InputError("the estimated velocity is not finite; declare no prediction instead.")


def _signal(
    satellite: SatelliteState,
    range_m: float,
    place: Place,
    velocity_m_per_s: Vector,
    air_m: Callable[[float, float], float],
) -> Predicted:
    """Return the signal of a satellite in the frame of reception. air_m: the delay by elevation and azimuth."""
    at = place.earth_fixed_m()
    direction = tuple((s - p) / range_m for s, p in zip(satellite.position_m, at, strict=True))
    unit: Vector = (direction[0], direction[1], direction[2])
    elevation, azimuth = place.elevation_azimuth_rad(unit)
    closing = dot(unit, satellite.velocity_m_per_s) * (1 - dot(unit, satellite.velocity_m_per_s) / LIGHT_M_PER_S)
    rate = closing - dot(unit, velocity_m_per_s) - LIGHT_M_PER_S * satellite.clock_drift
    pseudorange = range_m + air_m(elevation, azimuth) - LIGHT_M_PER_S * satellite.clock_s
    return Predicted(pseudorange, rate, unit, elevation)


def _air_m(
    place: Place, elevation_rad: float, azimuth_rad: float, time_s: float, ionosphere: Klobuchar | None
) -> float:
    ions = 0.0 if ionosphere is None else ionosphere.delay_m(place, elevation_rad, azimuth_rad, time_s)
    return ions + troposphere_m(place.height_m, elevation_rad)


def _seen(ephemeris: Ephemeris, received_s: float, at: Vector) -> tuple[SatelliteState, float]:
    """Return the satellite at transmission, in the Earth-fixed frame of reception, and its distance."""
    travel_s = 0.075
    for _ in range(2):
        travel_s = math.dist(_turned(_sent(ephemeris, received_s - travel_s), travel_s), at) / LIGHT_M_PER_S
    sent = satellite_state(ephemeris, received_s - travel_s)
    satellite = _received(sent, travel_s)
    return satellite, math.dist(satellite.position_m, at)


def _received(sent: SatelliteState, travel_s: float) -> SatelliteState:
    """Return the state at transmission in the Earth-fixed frame of reception."""
    position, velocity = _turned(sent.position_m, travel_s), _turned(sent.velocity_m_per_s, travel_s)
    return SatelliteState(position, velocity, sent.clock_s, sent.clock_drift)


def _sent(ephemeris: Ephemeris, sent_s: float) -> Vector:
    return satellite_state(ephemeris, sent_s).position_m


def _turned(vector: Vector, travel_s: float) -> Vector:
    angle = EARTH_RATE_RAD_PER_S * travel_s
    x, y, z = vector
    return x * math.cos(angle) + y * math.sin(angle), y * math.cos(angle) - x * math.sin(angle), z
