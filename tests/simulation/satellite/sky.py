"""A sky and a straight track for tests."""

from __future__ import annotations

from functools import cache

import numpy as np

from safeloc.sensing.satellite.navigation import Navigation
from safeloc.sensing.satellite.places import Place
from safeloc.sensing.satellite.track_prediction import Portion
from safeloc.simulation.motion import Leg, Motion, VehicleConfig, move
from safeloc.simulation.satellite.constellation import BEIDOU, GALILEO, GPS, constellation

NORTH_M = 5_000.0


@cache
def sky() -> Navigation:
    """Three constellations."""
    return constellation((GPS, GALILEO, BEIDOU), np.random.default_rng(7))


def straight() -> Portion:
    """Five kilometres to the north, level, at 50 degrees north."""
    start, end = Place.degrees(50.0, 8.0, 200.0), Place.degrees(50.0449, 8.0, 200.0)
    return Portion(0.0, (start.earth_fixed_m(), end.earth_fixed_m()))


def ride(seconds: float = 40.0, period_ms: int = 1_000, start_m: int = 100, speed_mm_s: int = 25_000) -> Motion:
    """Away from a place, at a speed after the start."""
    return move(VehicleConfig(), [Leg(speed_mm_s, seconds)], period_ms, start_nm=start_m * 10**9)
