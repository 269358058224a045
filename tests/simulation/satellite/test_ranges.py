"""Simulated ways of signals against the front end's predictions, which are computed another way."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from safeloc.sensing.satellite.atmosphere import troposphere_m
from safeloc.sensing.satellite.places import Place
from safeloc.sensing.satellite.predicted import predicted
from safeloc.simulation.satellite.ranges import orbits, seen
from tests.simulation.satellite.sky import sky


@pytest.mark.parametrize("time_s", [0.0, 1_000.0, -3_000.0])
def test_both_ways_of_counting_agree(time_s: float) -> None:
    """Way within a millimetre, rate within a millimetre a second, for a receiver that moves; all above the horizon."""
    place, velocity = Place.degrees(50.0, 8.0, 300.0), (10.0, -20.0, 5.0)
    true = seen(orbits(sky().ephemerides), np.array([time_s]), np.array([place.earth_fixed_m()]), np.array([velocity]))
    compared = 0
    for at, ephemeris in enumerate(sky().ephemerides):
        found = predicted(ephemeris, ephemeris.orbit_time_s + time_s, place, velocity, None)
        if found.elevation_rad > 0.1:
            way = found.pseudorange_m - troposphere_m(place.height_m, found.elevation_rad)
            assert abs(way - true.way_m[0, at]) < 1e-3
            assert abs(found.rate_m_per_s - true.rate_m_per_s[0, at]) < 1e-3
            assert np.allclose(found.direction, true.direction[0, at], atol=1e-9)
            compared += 1
    assert compared > 15


def test_orbits_refer_to_one_time() -> None:
    """Ephemerides of two times are refused: arrays have one time for all."""
    first, second = sky().ephemerides[:2]
    with pytest.raises(ValueError, match="too many values"):
        orbits([first, replace(second, orbit_time_s=second.orbit_time_s + 7_200)])
