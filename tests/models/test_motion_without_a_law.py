"""What is lost where a law of the vehicle's motion is broken: a run of each in which the reported interval misses the front end, and where that ends.

`safeloc faults localizer --clause localizer/motion/A3` proves which claims are kept: all that do not say that an interval holds the truth.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from numpy.typing import NDArray

from safeloc.campaign.judged import judge_of
from safeloc.language.expr import Lit
from safeloc.language.units import NM_PER_MM
from safeloc.models.balise.groups import Group
from safeloc.models.localizer import LocalizerConfig
from safeloc.models.localizer.simulation.journey import Journey, Vehicles
from safeloc.models.localizer.simulation.sources import Fleet
from safeloc.models.localizer.target import target
from safeloc.models.motion.world import CHECK_LAWFUL, ODOMETER_LAWFUL
from safeloc.simulation.many_runs import ManyRuns
from safeloc.simulation.motion import Leg
from safeloc.simulation.vehicle_seed import VehicleSeed

CONFIG = LocalizerConfig(sources=("balise",))
ODOMETER, CHECK = "motion.odometer_mm", "motion.check_mm"
GROUPS = [Group(number, number * 100_000) for number in range(1, 5)]
RUN = Journey(legs=[Leg(20_000, 130)], groups=[*GROUPS, Group(5, 1_200_000), Group(6, 1_300_000), Group(7, 1_400_000)])
CREEPS = Journey(legs=[Leg(10_000, 45), Leg(400, 240)], groups=[*GROUPS, Group(5, 1_200_000)])
_RAMP_CYCLES = 40
_GHOST = "motion: the one-off error of the reported run"
"""The law of a ghost, which here is still that of the units before they were changed."""


@dataclass(frozen=True)
class Found:
    """A run: the laws that do not hold, how far the front end is from the interval at most, the cycles in which it is outside, and the last one with an interval."""

    broken: list[str]
    most_mm: int
    cycles: list[int]
    last_told: int


def found(journey: Journey, measured: dict[str, float], begins: int, lawful: Lit) -> Found:
    """The run of a vehicle whose units measure, from this cycle on, a share of what they measured; by hindsight this unit keeps its law, if one does."""
    shown = target(CONFIG)
    runs = Fleet(Vehicles(CONFIG, [journey], [VehicleSeed(1)]), shown.system, None).runs()
    inputs = dict(runs.inputs)
    for name, share in measured.items():
        values: NDArray[np.int64] = inputs[name]
        shares = 1 + (share - 1) * np.clip((np.arange(len(values)) - begins) / _RAMP_CYCLES, 0, 1)
        inputs[name] = (values * shares[:, None]).astype(np.int64)
    judge = judge_of(shown, compiled=False)
    judged = judge.outcome(ManyRuns(inputs, {**runs.first, "motion.lawful_unit": np.array([lawful.value])}))
    wrong = judged.told & (judged.margin_nm < 0)
    broken = [name for name, held in zip(judge.clauses, judged.held, strict=True) if not held.all() and name != _GHOST]
    most_mm = int(-judged.margin_nm[wrong].min() // NM_PER_MM) if wrong.any() else 0
    return Found(broken, most_mm, np.flatnonzero(wrong[:, 0]).tolist(), int(np.flatnonzero(judged.told[:, 0])[-1]))


def test_one_unit_may_measure_anything() -> None:
    """The wheel measures a fifth too little: the radar keeps its law, no law of the whole is broken, and no interval is wrong."""
    alone = found(RUN, {ODOMETER: 0.8}, 350, CHECK_LAWFUL)
    assert (alone.broken, alone.most_mm, alone.cycles) == ([], 0, [])


def test_a_common_cause_is_not_noticed_between_groups() -> None:
    """Wheel and radar measure a fifth too little: 7 s later the interval is wrong, and it is withdrawn where groups contradict it."""
    both = found(RUN, {ODOMETER: 0.8, CHECK: 0.8}, 350, ODOMETER_LAWFUL)
    assert both.broken == ["motion: the odometer, if it is the lawful unit, obeys its error law"]
    assert 65_000 < both.most_mm < 75_000
    assert 415 < both.cycles[0] < 425
    assert both.cycles[-1] == both.last_told < 1_299


@pytest.mark.thorough
def test_a_vehicle_that_creeps_with_a_locked_wheel_is_taken_for_one_that_stands() -> None:
    """0.4 m/s, below the radar's floor, and no pulse: after three minutes the front end is 69 m outside; nothing ends it."""
    creeps = found(CREEPS, {ODOMETER: 0.0}, 650, CHECK_LAWFUL)
    assert creeps.broken == ["motion: a vehicle that measures nothing stays between two pulses"]
    assert 65_000 < creeps.most_mm < 75_000
    assert creeps.cycles[-1] == creeps.last_told == 2_849
