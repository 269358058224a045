"""Many vehicles at once are what one vehicle is: the sensors' laws, readings and faults of the single simulation."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from safeloc.campaign.declaration import parse_campaign
from safeloc.campaign.judged import IN_RANGE, judge_of
from safeloc.campaign.scenes import check_strata, drawn_runs
from safeloc.errors import InputError
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


PHYSICAL = """
adhesion = { distribution = "choice", values = [0.0, 0.05, 0.3], unit = "share" }
front_wheel_scale_ppm = { distribution = "uniform", low = -2000, high = 2000, unit = "ppm" }
map_walk_mm = { distribution = "fixed", value = 300, unit = "mm" }
map_own_share = { distribution = "fixed", value = 0.1, unit = "share" }
"""


def test_wheels_and_maps_by_physics_are_alone_what_they_are_among_others() -> None:
    """Bit by bit; leaves on the rail break the laws of wheels alone, a dry rail and a map that errs a little break none."""
    text = ON_VALLEY[: ON_VALLEY.index("[[situations.faults]]")]
    campaign = parse_campaign(text.replace("[figures]", f"[figures]{PHYSICAL}"), "c.toml")
    check_strata(campaign)
    scene, drawn, _ = drawn_runs(campaign, campaign.shards[0])
    figures = {**drawn.figures, "adhesion": np.array([0.05, 0.3, 0.0])}
    together = scene.simulation.runs(replace(drawn, figures=figures), 600)
    for vehicle in range(3):
        own = {name: values[vehicle : vehicle + 1] for name, values in figures.items()}
        alone = scene.simulation.runs(
            replace(drawn, vehicles=1, figures=own, faults=[[]], seeds=drawn.seeds[vehicle : vehicle + 1]), 600
        )
        assert all(
            np.array_equal(values[:, :1], together.inputs[name][:, vehicle : vehicle + 1])
            for name, values in alone.inputs.items()
        )
    judge = JUDGE(scene.target)
    held = judge.outcome(together).held
    broken = [
        {name for name, one in zip(judge.clauses, held, strict=True) if not one[:, vehicle].all()}
        for vehicle in range(3)
    ]
    assert [{"front_wheel obeys its error law", "rear_wheel obeys its error law"}, set(), set()] == broken


def test_radars_by_physics_break_their_law_where_they_are_mounted_wrongly() -> None:
    """A radar that measures a tenth too far breaks its law of five per cent, a noisy one does not; the wheel beside it keeps its own errors."""
    text = ON_VALLEY[: ON_VALLEY.index("[[situations.faults]]")]
    scene, drawn, by_law = drawn_runs(parse_campaign(text, "c.toml"), parse_campaign(text, "c.toml").shards[0])
    figures = {
        **drawn.figures,
        "front_radar_noise_mm_s": np.array([50.0, 50.0, 0.0]),
        "front_radar_mounting_ppm": np.array([0.0, 100_000.0, 100_000.0]),
    }
    runs = scene.simulation.runs(replace(drawn, figures=figures), 600)
    other = scene.simulation.runs(drawn, 600)
    changed = {name for name, values in runs.inputs.items() if not np.array_equal(values, other.inputs[name])}
    assert {"front_radar_mm", "front_radar_next_wander_nm"} == changed
    assert np.array_equal(
        runs.inputs["front_radar_mm"][:, 2], other.inputs["front_radar_mm"][:, 2]
    )  # by its law, without noise
    judge = JUDGE(scene.target)
    held = judge.outcome(runs).held
    broken = [
        {name for name, one in zip(judge.clauses, held, strict=True) if not one[:, vehicle].all()}
        for vehicle in range(3)
    ]
    assert [set(), {"front_radar obeys its error law"}, set()] == broken
    assert by_law.inputs.keys() == runs.inputs.keys()


@pytest.mark.parametrize(
    ("figure", "message"),
    [
        ('adhesion = { distribution = "fixed", value = 0.3, unit = "mm" }', "its unit is share, not 'mm'"),
        (
            'adhesion = { distribution = "fixed", value = 0.7, unit = "share" }',
            "0.7 share leaves the range 0 to 0.6 share",
        ),
        ('front_radar_scale_ppm = { distribution = "fixed", value = 1, unit = "ppm" }', "there is no such figure"),
    ],
)
def test_figures_of_physics_are_refused_with_file_and_line(figure: str, message: str) -> None:
    """A wrong unit, a value out of range, and a figure that the unit does not have: a radar is no wheel."""
    campaign = parse_campaign(ON_VALLEY.replace("[figures]", f"[figures]\n{figure}"), "c.toml")
    with pytest.raises(InputError, match=f"^c.toml:6: figures.{figure.split()[0]}: .*{message}"):
        check_strata(campaign)
