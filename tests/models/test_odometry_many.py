"""Many vehicles at once are what one vehicle is: the sensors' laws, readings and faults of the single simulation."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from safeloc.campaign.declaration import parse_campaign
from safeloc.campaign.judged import IN_RANGE, judge_of
from safeloc.campaign.scenes import check_strata, drawn_runs
from safeloc.language.units import NM_PER_MM
from safeloc.models.vocabulary.error_law import RADAR, WHEEL, ErrorLaw
from safeloc.simulation.many_runs import through_border
from safeloc.simulation.motion import Leg, VehicleConfig, move
from safeloc.simulation.sensors import measure, measured, passages, read_markers
from tests.campaign.declared import ON_VALLEY

JUDGE = cache(judge_of)
MOTION = move(VehicleConfig(), [Leg(20_000, 40), Leg(0, 20)], 100)


@pytest.mark.parametrize("law", [WHEEL, RADAR], ids=["wheel", "radar"])
@pytest.mark.parametrize("dropout", [0.0, 0.3])
def test_units_of_many_measure_as_one_does(law: ErrorLaw, dropout: float) -> None:
    """With the draws of single runs, the arrays hold exactly what the single runs measure."""
    cycles, runs = len(MOTION.distance_nm), 3
    draws = [np.random.default_rng(run) for run in range(runs)]
    bias = np.stack([rng.uniform(-1, 1) * np.ones(cycles) + rng.normal(0, 0.05, cycles) for rng in draws], axis=1)
    wanted = np.stack([rng.uniform(-1, 1, cycles // 100 + 1) for rng in draws], axis=1)
    present = np.stack([rng.random(cycles) >= dropout for rng in draws], axis=1)
    true = np.repeat(MOTION.distance_nm[:, None], runs, axis=1)
    step, wander = measured(true, 100, law, np.full(runs, 0.9), bias, wanted, present)
    for run in range(runs):
        one = measure("unit", MOTION, law, np.random.default_rng(run), dropout=dropout)
        assert np.array_equal(one.distance_mm, step[:, run])
        assert np.array_equal(one.wander_nm, wander[:, run])
    assert np.abs(wander).max() <= law.wander_nm


def test_passages_are_the_readings_of_a_run_that_never_turns_back() -> None:
    """For the same displaced markers, the same readings, without a loop over cycles."""
    markers = [(number, number * 60_000) for number in range(1, 9)]
    accuracy = {number: 2_000 + 500 * number for number, _ in markers}
    for seed, (end, offset) in enumerate(((0, 0), (1, 41_700))):
        rng = np.random.default_rng(seed)
        shifts = np.array([rng.uniform(-0.9, 0.9) * accuracy[marker] for marker, _ in markers])
        expected = read_markers(MOTION, end, offset, markers, accuracy, np.random.default_rng(seed))
        found = passages(MOTION.position_nm, MOTION.start_nm, end, offset, markers, shifts, accuracy)
        assert expected == found
        assert len(found) >= 5


def test_sensors_within_their_laws_break_no_clause_and_a_slide_breaks_one() -> None:
    """The world's clauses, judged on every vehicle-cycle."""
    campaign = parse_campaign(ON_VALLEY, "c.toml")
    check_strata(campaign)
    for shard, struck in zip(campaign.shards, (False, True), strict=True):
        scene, drawn, runs = drawn_runs(campaign, shard)
        judge = JUDGE(scene.target)
        found = judge.outcome(runs)
        law = judge.clauses.index("front_wheel obeys its error law")
        assert struck == (not found.held[law].all())
        others = [number for number in range(len(judge.clauses)) if number != law]
        assert found.held[others].all()
        assert IN_RANGE in judge.clauses
        assert not (found.told & (found.margin_nm < 0) & ~found.broken).any()
        assert found.told.any()
        if struck:
            begins = [faults[0].begin for faults in drawn.faults]
            first = [int(found.broken[:, run].argmax()) for run in range(len(begins))]
            assert all(100 <= begin <= 200 for begin in begins)
            assert all(0 <= at - begin < 50 for at, begin in zip(first, begins, strict=True))


def test_more_than_the_allowed_error_breaks_the_law() -> None:
    """A severity above 1 is a unit outside of its law."""
    text = ON_VALLEY.replace(
        "[figures]", '[figures]\nrear_radar_severity = { distribution = "fixed", value = 1.5, unit = "share" }'
    )
    campaign = parse_campaign(text, "c.toml")
    check_strata(campaign)
    scene, _, runs = drawn_runs(campaign, campaign.shards[0])
    judge = JUDGE(scene.target)
    found = judge.outcome(runs)
    assert not found.held[judge.clauses.index("rear_radar obeys its error law")].all()


def test_values_beyond_their_range_are_left_out_as_on_board() -> None:
    """They are neither clipped nor passed on, and counted for each vehicle."""
    campaign = parse_campaign(ON_VALLEY, "c.toml")
    scene, _, runs = drawn_runs(campaign, campaign.shards[0])
    wheel = runs.inputs["front_wheel_mm"].copy()
    wheel[7, 1] = 10**7
    found, refused = through_border(
        scene.target.system, replace(runs, inputs={**runs.inputs, "front_wheel_mm": wheel}).inputs
    )
    assert [0, 1, 0] == refused.tolist()
    assert (0, False) == (found["front_wheel_mm"][7, 1], found["front_wheel_mm.present"][7, 1])
    assert wheel[6, 1] == found["front_wheel_mm"][6, 1]
    assert runs.inputs["true_cycle_distance_nm"].sum() > NM_PER_MM
