"""Place and velocity of a satellite from its ephemeris, and both against a moving vehicle (SAT-2)."""

from __future__ import annotations

import math
from dataclasses import asdict, replace

import pytest

from safeloc.errors import InputError
from safeloc.sensing.satellite.ephemeris import Ephemeris
from safeloc.sensing.satellite.figures import EARTH_GRAVITY_M3_PER_S2, EARTH_RATE_RAD_PER_S, L1_HZ, L1_WAVELENGTH_M
from safeloc.sensing.satellite.navigation import read_navigation
from safeloc.sensing.satellite.orbits import satellite_state
from safeloc.sensing.satellite.places import Place
from safeloc.sensing.satellite.predicted import predicted, rate_of_doppler
from tests.data_sources import data_file

CIRCLE = Ephemeris(
    satellite="G01", clock_time_s=0.0, af0_s=0.0, af1=0.0, af2_per_s=0.0, crs_m=0.0, delta_n=0.0, m0=0.0, cuc=0.0,
    eccentricity=0.0, cus=0.0, sqrt_a=5_153.6, orbit_time_s=0.0, cic=0.0, omega0=0.0, cis=0.0, i0=0.0, crc_m=0.0,
    omega=0.0, omega_dot=0.0, idot=0.0, healthy=True, group_delay_s=0.0, sent_s=0.0,
)  # fmt: skip
RADIUS_M = CIRCLE.sqrt_a**2
EQUATOR = Place.degrees(0.0, 0.0, 0.0)


def test_a_circle_over_the_equator() -> None:
    """On its radius at any time, and at Kepler's speed less the Earth's turn."""
    for time_s in (0.0, 600.0, 3_600.0):
        state = satellite_state(CIRCLE, time_s)
        assert math.hypot(*state.position_m) == pytest.approx(RADIUS_M, abs=1e-3)
        expected = (math.sqrt(EARTH_GRAVITY_M3_PER_S2 / RADIUS_M**3) - EARTH_RATE_RAD_PER_S) * RADIUS_M
        assert math.hypot(*state.velocity_m_per_s) == pytest.approx(expected, abs=1e-3)


@pytest.mark.parametrize("speed_m_per_s", [-40.0, 0.0, 40.0])
def test_the_rate_is_how_the_range_changes(speed_m_per_s: float) -> None:
    """Predicted a second apart for a vehicle under way, the ranges differ by the rate: signs of vehicle and satellite."""
    north = replace(CIRCLE, i0=0.9, m0=0.3)
    velocity = (0.0, speed_m_per_s, 0.0)

    def range_m(seconds: float) -> float:
        place = Place.of_earth_fixed((EQUATOR.earth_fixed_m()[0], speed_m_per_s * seconds, 0.0))
        return predicted(north, 100.0 + seconds, place, velocity, None).pseudorange_m

    rate = predicted(north, 100.0, EQUATOR, velocity, None).rate_m_per_s
    assert range_m(0.5) - range_m(-0.5) == pytest.approx(rate, abs=0.01)


def test_towards_the_satellite_the_doppler_is_positive() -> None:
    """Doppler is positive while the distance shrinks, by its wavelength: 1 kHz are -190.3 m/s of range rate."""
    assert 0.1903 == pytest.approx(L1_WAVELENGTH_M, abs=1e-4)
    assert -190.3 == pytest.approx(rate_of_doppler(1_000.0), abs=0.01)
    still, towards = (
        predicted(replace(CIRCLE, m0=0.5), 0.0, EQUATOR, (0.0, speed, 0.0), None).rate_m_per_s for speed in (0.0, 30.0)
    )
    assert towards < still
    assert L1_HZ * L1_WAVELENGTH_M == pytest.approx(299_792_458.0)


def test_recorded_ephemerides_agree_where_they_meet() -> None:
    """Two messages of one satellite, an hour or two apart, tell the same place to metres in the middle between them."""
    every = [one for one in read_navigation(data_file("gnss_septentrio/base.nav")).ephemerides if one.healthy]
    pairs = [
        (a, b)
        for n, a in enumerate(every)
        for b in every[n + 1 :]
        if a.satellite == b.satellite and 600 < abs(a.orbit_time_s - b.orbit_time_s) <= 7_200
    ]
    assert len(pairs) > 20
    for a, b in pairs:
        middle_s = (a.orbit_time_s + b.orbit_time_s) / 2
        apart = math.dist(satellite_state(a, middle_s).position_m, satellite_state(b, middle_s).position_m)
        assert apart < 10, a.satellite


@pytest.mark.parametrize("name", ["m0", "sqrt_a", "af0_s", "orbit_time_s"])
def test_figures_that_are_not_finite_are_refused(name: str) -> None:
    """NaN in a message is no orbit; neither is a hyperbola."""
    with pytest.raises(InputError, match=f"{name} is not a finite number"):
        Ephemeris(**{**asdict(CIRCLE), name: math.nan})
    with pytest.raises(InputError, match="not an ellipse"):
        replace(CIRCLE, eccentricity=1.0)


def test_an_unhealthy_satellite_is_not_predicted() -> None:
    """Its message says so: as good as expired."""
    with pytest.raises(InputError, match="not valid"):
        satellite_state(replace(CIRCLE, healthy=False), 0.0)
