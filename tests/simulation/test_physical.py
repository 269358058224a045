"""Wheel and radar, made from their figures, keep the laws that follow from those figures, and not much tighter ones."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.errors import InputError
from safeloc.models.vocabulary.error_law import RADAR, WHEEL
from safeloc.simulation.law_check import first_breach
from safeloc.simulation.motion import Leg, Motion, VehicleConfig, move, plan
from tests.simulation.physical import RadarConfig, WheelConfig, radar, radar_law, wheel, wheel_law

VEHICLE = VehicleConfig()
TO_AND_FRO = move(VEHICLE, [Leg(15_000, 30.0), Leg(0, 25.0), Leg(-15_000, 60.0)], 100, start_nm=-3)


@cache
def service(seed: int) -> Motion:
    """A random minute."""
    return move(VEHICLE, plan(VEHICLE, 60, np.random.default_rng(seed)), 100)


@given(st.integers(0, 50), st.integers(-200_000, 200_000), st.integers(100, 1_000_000))
def test_the_wheel_keeps_its_law(seed: int, diameter_error_ppm: int, pulse_um: int) -> None:
    """For every diameter and pulse length that the configuration admits."""
    config = WheelConfig(diameter_error_ppm=diameter_error_ppm, pulse_um=pulse_um)
    motion = service(seed % 5)
    assert first_breach(motion, wheel_law(config), wheel("wheel", motion, config)) is None


@given(st.integers(0, 50), st.integers(-100_000, 100_000), st.integers(6, 10_000))
def test_the_radar_keeps_its_law(seed: int, scale_error_ppm: int, noise_mm_s: int) -> None:
    """For every scale and noise that the configuration admits, at any speed."""
    config = RadarConfig(scale_error_ppm=scale_error_ppm, noise_mm_s=noise_mm_s, cut_off_mm_s=0)
    motion = service(seed % 5)
    unit = radar("radar", motion, config, np.random.default_rng(seed))
    assert first_breach(motion, radar_law(config), unit) is None


def test_default_figures_are_within_the_laws_of_the_odometry_machine() -> None:
    """Wheel and radar as figured may be given to a machine that assumes SUBSET-041."""
    wheel_steps = wheel("wheel", TO_AND_FRO, WheelConfig())
    radar_steps = radar("radar", TO_AND_FRO, RadarConfig(), np.random.default_rng(0))
    for law, unit in ((WHEEL, wheel_steps), (RADAR, radar_steps)):
        assert first_breach(TO_AND_FRO, law, unit) is None


def test_the_diameter_shows_in_the_distance() -> None:
    """A wheel thicker by 8.2 % measures too little, to within a pulse and a millimetre."""
    config = WheelConfig(diameter_error_ppm=82_000)
    motion = move(VEHICLE, [Leg(20_000, 60.0)], 100)
    true_mm = int(motion.position_nm[-1]) / 1e6
    assert wheel("wheel", motion, config).distance_mm.sum() == pytest.approx(true_mm / 1.082, abs=14.4)


def test_pulses_do_not_add_up() -> None:
    """There and back: the wheel ends within one pulse and a millimetre of where it began."""
    unit = wheel("wheel", TO_AND_FRO, WheelConfig(diameter_error_ppm=0))
    back = np.flatnonzero(np.abs(TO_AND_FRO.position_nm + 3) < 2_000_000_000)[-1]
    measured = int(unit.distance_mm[: back + 1].sum())
    assert abs(int(TO_AND_FRO.position_nm[back]) + 3 - measured * 1_000_000) <= 14_400_000


def test_a_law_without_the_diameter_is_broken() -> None:
    """The rate is needed: the check is no formality."""
    config = WheelConfig()
    unit = wheel("wheel", TO_AND_FRO, config)
    law = wheel_law(config)
    assert first_breach(TO_AND_FRO, law.model_copy(update={"rate_ppm": law.rate_ppm - 1}), unit) is not None


def test_a_law_with_half_the_noise_is_broken() -> None:
    """So is the floor."""
    config = RadarConfig(scale_error_ppm=0)
    unit = radar("radar", TO_AND_FRO, config, np.random.default_rng(0))
    law = radar_law(config)
    assert first_breach(TO_AND_FRO, law.model_copy(update={"floor_mm_s": law.floor_mm_s // 2}), unit) is not None


def test_the_radar_is_silent_when_slow() -> None:
    """Below the cut-off there is no output, above it only drop-outs."""
    config = RadarConfig(dropout_ppm=0)
    unit = radar("radar", TO_AND_FRO, config, np.random.default_rng(0))
    assert np.array_equal(unit.present, np.abs(TO_AND_FRO.speed_mm_s) >= 1_000)
    assert not unit.present.all()


def test_drop_outs_come_as_often_as_configured() -> None:
    """A tenth of the cycles, within a few standard deviations."""
    config = RadarConfig(cut_off_mm_s=0, dropout_ppm=100_000)
    unit = radar("radar", TO_AND_FRO, config, np.random.default_rng(0))
    assert (~unit.present).mean() == pytest.approx(0.1, abs=0.04)


def test_noise_below_the_rounding_is_refused() -> None:
    """5 mm/s in 100 ms is half a millimetre: whole mm cannot show it."""
    with pytest.raises(InputError, match=r"^noise of 5 mm/s is below the rounding of 100 ms cycles to whole mm\.$"):
        radar("radar", TO_AND_FRO, RadarConfig(noise_mm_s=5), np.random.default_rng(0))
