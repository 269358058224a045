"""Vehicles whose sensors keep their laws keep every law of their world: one that creeps, and one whose wheel slides beside a good radar."""

from __future__ import annotations

import numpy as np
import pytest

from safeloc.campaign.judged import judge_of
from safeloc.language.units import NM_PER_MM
from safeloc.models.balise.groups import Group
from safeloc.models.localizer import LocalizerConfig
from safeloc.models.localizer.simulation.journey import Journey, Vehicles
from safeloc.models.localizer.simulation.simulate import first_but_speed
from safeloc.models.localizer.simulation.sources import Fleet
from safeloc.models.localizer.target import target
from safeloc.models.motion.world import CHECK_LAWFUL
from safeloc.simulation.many_runs import ManyRuns
from safeloc.simulation.motion import Leg
from safeloc.simulation.vehicle_seed import VehicleSeed

CONFIG = LocalizerConfig(sources=("balise",))
CREEPING = Journey(legs=[Leg(400, 90)], groups=[Group(number, number * 600) for number in range(1, 70)])
"""0.4 m/s, where a radar may measure nothing: groups so close that many are read."""


@pytest.mark.thorough
def test_a_checked_distance_may_point_the_other_way_where_a_vehicle_creeps() -> None:
    """A radar within its law pulls the distance to 0 or less while the vehicle creeps on: every law holds, of a group's age too."""
    shown = target(CONFIG)
    vehicles = Vehicles(CONFIG, [CREEPING] * 6, [VehicleSeed(seed) for seed in range(6)])
    inputs = Fleet(vehicles, shown.system, None).inputs()
    judge = judge_of(shown, compiled=False)
    found = judge.outcome(ManyRuns(inputs, first_but_speed(CONFIG, CREEPING)))
    assert [] == [name for name, held in zip(judge.clauses, found.held, strict=True) if not held.all()]
    read = inputs["balise.telegram_group.present"] & ~inputs["balise.telegram_since_mm.present"]
    least_nm = CONFIG.balise.measuring_step_mm * NM_PER_MM
    ran = read & (inputs["balise.true_since_nm"] > least_nm) & (inputs["balise.telegram_age_ms"] <= 100)
    assert np.count_nonzero(ran) > 50
    assert found.told.any() and not (found.told & (found.margin_nm < 0)).any()


def _doubting() -> LocalizerConfig:
    motion = CONFIG.motion.model_copy(update={"standing_believed": False})
    balise = CONFIG.balise.model_copy(update={"odometer": motion.reported_law})
    return LocalizerConfig(sources=("balise",), motion=motion, balise=balise)


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("config", [CONFIG, _doubting()], ids=["standing believed", "standing not believed"])
def test_a_sliding_wheel_beside_a_good_radar_breaks_no_law(config: LocalizerConfig) -> None:
    """One unit keeps its law, nobody knows which: by hindsight the radar. The balises' laws of the checked distance hold as well.

    The wheel measures nothing while the vehicle runs to its next pulse at each start and stop: that is within the law of standing.
    """
    journey = Journey(
        legs=[Leg(0, 2), Leg(25_000, 38), Leg(0, 20), Leg(100, 10)],
        groups=[Group(number, number * 60_000) for number in range(1, 12)],
        physics={"adhesion": 0.05, "adhesion_spread": 0.0},
    )
    shown = target(config)
    vehicles = Vehicles(config, [journey] * 3, [VehicleSeed(seed) for seed in range(3)])
    runs = Fleet(vehicles, shown.system, None).runs()
    judge = judge_of(shown, compiled=False)
    found = judge.outcome(ManyRuns(runs.inputs, {**first_but_speed(config, journey), **runs.first}))
    assert np.array_equal(runs.first["motion.lawful_unit"], [CHECK_LAWFUL.value] * 3)
    assert [] == [name for name, held in zip(judge.clauses, found.held, strict=True) if not held.all()]
    unmeasured = runs.inputs["motion.odometer_mm.present"] & (runs.inputs["motion.odometer_mm"] == 0)
    assert (np.abs(runs.inputs["true_cycle_distance_nm"])[unmeasured] > 5 * NM_PER_MM).any()
    off_mm = np.abs(np.cumsum(runs.inputs["motion.odometer_mm"], axis=0) - vehicles.motions.position_nm / NM_PER_MM)
    assert (off_mm.max(axis=0) > 5_000).all()
    assert not (found.told & (found.margin_nm < 0)).any()
