"""A wheel that counts pulses: what scale, eccentricity, creep and silence make of the distance."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest

from safeloc.simulation.motion import Leg, Motion, VehicleConfig, move
from safeloc.simulation.physics.pulse_wheel import STEP_MM, PulseWheels, figures_of_wheel
from safeloc.simulation.vehicle_seed import VehicleSeed

MOTION = move(VehicleConfig(), [Leg(20_000, 60), Leg(0, 60)], 100)
SEEDS = [VehicleSeed(4, (number,)) for number in range(3)]


def told(
    figures: Mapping[str, float],
    *,
    adhesion: float = 0.3,
    vehicles: int = 3,
    silent: slice = slice(0, 0),
    motion: Motion = MOTION,
) -> np.ndarray:
    """What wheels of a few vehicles with these figures tell in each cycle, mm."""
    all_ = {f"unit_{name}": np.full(vehicles, value) for name, value in figures.items()}
    named = {name: all_.get(name, np.full(vehicles, one.default)) for name, one in figures_of_wheel("unit").items()}
    true = np.repeat(motion.distance_nm[:, None], vehicles, axis=1)
    present = np.ones(true.shape, dtype=np.bool_)
    present[silent] = False
    wheels = PulseWheels("unit", "stream", named, SEEDS[:vehicles])
    return wheels.told_mm(true, np.full(true.shape, adhesion), present, 100)


def off_mm(found: np.ndarray) -> np.ndarray:
    """The distance told so far less the true one."""
    return np.cumsum(found, axis=0) - MOTION.position_nm[:, None] / 1e6


def test_a_wheel_that_rolls_freely_tells_whole_pulses() -> None:
    """Within a pulse and half a millimetre of the truth for good; a pulse is 13.4 mm."""
    found = off_mm(told({"effort": 0}))
    assert 13.352 == pytest.approx(STEP_MM, abs=1e-3)
    assert np.abs(found).max() <= STEP_MM + 0.5
    assert np.ptp(found) > STEP_MM


def test_scale_and_eccentricity() -> None:
    """A worn wheel measures too far in proportion; one off its centre errs by twice that at most, and comes back."""
    run = MOTION.position_nm[-1] / 1e6
    assert run * 1.08 == pytest.approx(told({"effort": 0, "scale_ppm": 80_000}).sum(axis=0), abs=STEP_MM + 0.5)
    turns = off_mm(told({"effort": 0, "eccentricity_mm": 20}))
    assert 40 - STEP_MM < np.ptp(turns, axis=0).min() and np.abs(turns).max() <= 40 + STEP_MM + 0.5


def test_a_wheel_creeps_forward_driving_and_back_braking() -> None:
    """Driving it measures too far, braking too little; where the rail does not hold, far more."""
    dry, wet = (off_mm(told({}, adhesion=one)) for one in (0.3, 0.05))
    brakes, stands = 600, 900
    assert 200 < dry[brakes].min() and dry[brakes].max() < 300  # of 235 m at 1 m/s2: a tenth of a per cent
    assert (np.abs(dry[stands]) < 50).all()
    assert (wet[brakes] > 30_000).all()
    assert (wet[stands] < wet[brakes] - 25_000).all()


def test_a_locked_wheel_measures_nothing() -> None:
    """While the vehicle brakes on, within a cycle."""
    found = told({"slide": 1, "effort": 20}, adhesion=0.05)
    braking = np.flatnonzero(np.diff(MOTION.speed_mm_s) < -60)
    assert found[braking[len(braking) // 2]].max() <= STEP_MM + 1


def test_silence_loses_no_pulse_and_vehicles_are_alone() -> None:
    """What was counted in silence comes with the next distance; a vehicle is bit by bit what it is beside others."""
    heard, missed = told({}), told({}, silent=slice(100, 120))
    assert not missed[100:120].any()
    assert np.array_equal(heard[100:121].sum(axis=0), missed[120])
    assert np.array_equal(np.delete(heard, slice(100, 121), axis=0), np.delete(missed, slice(100, 121), axis=0))
    assert np.array_equal(heard[:, :1], told({}, vehicles=1))
    assert len({tuple(column) for column in heard.T}) == 3
