"""A Doppler radar: what mounting, ground, noise, dead band and silence make of the distance."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest

from safeloc.simulation.motion import Leg, Motion, VehicleConfig, move
from safeloc.simulation.physics.line_process import line_process
from safeloc.simulation.physics.speed_radar import SpeedRadars, figures_of_radar
from safeloc.simulation.vehicle_seed import VehicleSeed

MOTION = move(VehicleConfig(), [Leg(20_000, 60), Leg(0, 60)], 100)
RUN_MM = MOTION.position_nm[-1] / 1e6
SEEDS = [VehicleSeed(4, (number,)) for number in range(3)]


def told(
    figures: Mapping[str, float],
    *,
    vehicles: int = 3,
    silent: slice = slice(0, 0),
    stream: str = "front",
    motion: Motion = MOTION,
) -> np.ndarray:
    """What radars of a few vehicles with these figures tell in each cycle, mm."""
    given = {"ground_ppm": 0.0, **figures}
    named = {
        name: np.full(vehicles, given.get(name.removeprefix("unit_"), one.default))
        for name, one in figures_of_radar("unit").items()
    }
    true = np.repeat(motion.distance_nm[:, None], vehicles, axis=1)
    places = np.repeat(motion.position_nm[:, None], vehicles, axis=1)
    present = np.ones(true.shape, dtype=np.bool_)
    present[silent] = False
    ground = line_process(SEEDS[:vehicles], "ground", np.full(vehicles, 200_000.0), 0, int(RUN_MM)).at(places)
    return SpeedRadars("unit", stream, named, SEEDS[:vehicles]).told_mm(true, ground, present, 100)


def test_without_any_figure_it_tells_the_truth_in_whole_mm() -> None:
    off = np.cumsum(told({}), axis=0) - MOTION.position_nm[:, None] / 1e6
    assert np.abs(off).max() <= 0.5 + 1e-6


def test_it_is_simulated_from_its_physics_where_it_has_noise() -> None:
    named = {name: np.zeros(2) for name in figures_of_radar("unit")} | {"unit_noise_mm_s": np.array([0.0, 5.0])}
    assert SpeedRadars("unit", "front", named, SEEDS[:2]).by_physics.tolist() == [False, True]


def test_mounting_errs_in_proportion_and_ground_along_the_line() -> None:
    """One degree off an angle of 45; and ground that differs from vehicle to vehicle, the same for every radar of one."""
    assert told({"mounting_ppm": 17_500}).sum(axis=0) == pytest.approx(RUN_MM * 1.0175, abs=1)
    over = told({"ground_ppm": 10_000}).sum(axis=0) - RUN_MM
    assert (np.abs(over) > 1).all() and (np.abs(over) < 0.05 * RUN_MM).all()
    assert len(set(over.tolist())) == 3
    assert np.array_equal(told({"ground_ppm": 10_000}), told({"ground_ppm": 10_000}, stream="rear"))


def test_noise_is_each_radars_own_and_walks() -> None:
    """Of 60 mm/s in each tenth of a second: 6 mm a cycle that it moves, times the root of the cycles after all of them."""
    off = np.cumsum(told({"noise_mm_s": 60}), axis=0) - MOTION.position_nm[:, None] / 1e6
    steps = np.diff(off, axis=0)[MOTION.distance_nm[1:] != 0].std()
    assert steps == pytest.approx(6.0, rel=0.05)
    assert np.abs(off[-1]).max() < 5 * 6.0 * len(off) ** 0.5
    assert not np.array_equal(told({"noise_mm_s": 60}), told({"noise_mm_s": 60}, stream="rear"))


def test_below_the_dead_band_it_measures_nothing() -> None:
    """What is run while starting and stopping is missing, and noise at standstill is not told."""
    found = told({"dead_mm_s": 1_000, "noise_mm_s": 60})
    slow = np.abs(MOTION.distance_nm) <= 1_000 * 1e6 * 0.1
    assert slow.sum() > 100
    assert not found[slow].any()


def test_silence_loses_no_distance_and_vehicles_are_alone() -> None:
    """What was measured in silence comes with the next distance; a vehicle is bit by bit what it is beside others."""
    figures = {"noise_mm_s": 20, "ground_ppm": 5_000}
    heard, missed = told(figures), told(figures, silent=slice(100, 120))
    assert not missed[100:120].any()
    assert np.array_equal(heard[100:121].sum(axis=0), missed[120])
    assert np.array_equal(heard[:, :1], told(figures, vehicles=1))
