"""Machines with feedback between map and machine on board: balises on a line, and the localizer on its journeys."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from safeloc.campaign.declaration import parse_campaign
from safeloc.campaign.judged import judge_of
from safeloc.campaign.scenes import check_strata, drawn_runs
from safeloc.errors import InputError
from safeloc.models.localizer.simulation.journey import SPOOFED_MM
from safeloc.models.localizer.simulation.journeys import NOMINAL
from tests.campaign.declared import ON_VALLEY, SMALL

BALISE = (
    ON_VALLEY.replace('"odometry"', '"balise"')
    .replace("vehicles = 3", "vehicles = 1")
    .replace('"front_wheel"', '"odometer"')
)
LOCALIZER = """machine = "localizer"
cycles = 1000
shard_vehicles = 1
[[lines]]
line = "main-line"
[[situations]]
name = "spoofed"
weight = 1.0
vehicles = 1
[[situations.faults]]
kind = "spoofing"
begin = { distribution = "fixed", value = 800, unit = "cycles" }
lasts = { distribution = "fixed", value = 10, unit = "s" }
"""
SPOOFED_FROM = 800
SIGNAL_BOUND_MM = 21_500
"""Threshold, prediction and clock of a usable satellite together."""


@pytest.mark.thorough
def test_a_sliding_odometer_breaks_the_law_of_the_balise_machine() -> None:
    """Without a fault every clause holds; the slide breaks the odometer's law as it begins, or within a second."""
    campaign = parse_campaign(BALISE, "c.toml")
    check_strata(campaign)
    for shard, struck in zip(campaign.shards, (False, True), strict=True):
        scene, drawn, runs = drawn_runs(campaign, shard)
        found = judge_of(scene.target).outcome(runs)
        assert struck == bool(found.broken.any())
        if struck:
            assert 0 <= found.broken[:, 0].argmax() - drawn.faults[0][0].begin < 10


@pytest.mark.slow
def test_a_spoofed_localizer_is_counted_as_hazardous() -> None:
    """The truth of a journey that breaks laws is known too, and says which law was broken and when the interval was wrong."""
    campaign = parse_campaign(LOCALIZER.replace("main-line", "freight"), "c.toml")
    check_strata(campaign)
    scene, _, runs = drawn_runs(campaign, campaign.shards[0])
    judge = judge_of(scene.target)
    found = judge.outcome(runs)
    broken = [name for name, held in zip(judge.clauses, found.held, strict=True) if not held.all()]
    assert broken == ["position: a solution is off by no more than its signals make of it"]
    first = found.broken[:, 0].argmax()
    assert (
        0 < (first - SPOOFED_FROM) * SPOOFED_MM < 2 * SIGNAL_BOUND_MM
    )  # a solution is worth its dilution times that bound
    wrong = (found.told & (found.margin_nm < 0))[:, 0]
    assert wrong.any() and wrong.argmax() >= first


@pytest.mark.slow
@pytest.mark.parametrize("journey", NOMINAL)
def test_localizers_without_a_fault_keep_every_law(journey: str) -> None:
    """Every clause of every machine's world, in every cycle of as many vehicles as take the machines in C; no interval is wrong."""
    text = LOCALIZER[: LOCALIZER.index("[[situations.faults]]")].replace("main-line", journey)
    campaign = parse_campaign(text.replace("vehicles = 1\n", "vehicles = 12\n"), "c.toml")
    (shard,) = campaign.shards
    scene, _, runs = drawn_runs(campaign, shard)
    judge = judge_of(scene.target)
    found = judge.outcome(runs)
    assert [name for name, held in zip(judge.clauses, found.held, strict=True) if not held.all()] == []
    assert not (found.told & (found.margin_nm < 0)).any()
    assert found.told.any(axis=0).all()


@pytest.mark.slow
@pytest.mark.parametrize("journey", NOMINAL)
def test_a_silent_odometer_keeps_every_law(journey: str) -> None:
    """A unit that says nothing says nothing wrong, also with its first distances after a silence of any length."""
    text = (
        LOCALIZER.replace("main-line", journey)
        .replace("spoofing", "odometer silent")
        .replace("vehicles = 1\n", "vehicles = 16\n")
    )
    begin, lasts = ('low = 200, high = 600, unit = "cycles"', 'low = 10, high = 380, unit = "cycles"')
    text = text.replace('"fixed", value = 800, unit = "cycles"', f'"uniform", {begin}').replace(
        '"fixed", value = 10, unit = "s"', f'"log-uniform", {lasts}'
    )
    campaign = parse_campaign(text.replace("shard_vehicles = 1\n", "shard_vehicles = 16\n"), "c.toml")
    scene, drawn, runs = drawn_runs(campaign, campaign.shards[0])
    judge = judge_of(scene.target)
    found = judge.outcome(runs)
    assert [name for name, held in zip(judge.clauses, found.held, strict=True) if not held.all()] == []
    assert max((one.end or 0) - one.begin for (one,) in drawn.faults) > 100


@pytest.mark.parametrize("name", ["campaign.toml", "campaign-localizer.toml", "campaign-physics.toml"])
def test_the_examples_of_the_documentation_are_accepted(name: str) -> None:
    """Their figures, faults and places exist."""
    path = Path(__file__).parents[2] / "docs" / "examples" / name
    campaign = parse_campaign(path.read_text(encoding="utf-8"), str(path))
    check_strata(campaign)
    assert len(campaign.strata) in (3, 51, 33)


def test_a_journey_that_there_is_not_is_refused() -> None:
    """The lines of the localizer are its journeys."""
    with pytest.raises(InputError, match=r"c\.toml:4: lines\.0: the localizer has no journey 'x'; it has metro"):
        check_strata(parse_campaign(LOCALIZER.replace('"main-line"', '"x"'), "c.toml"))


def test_a_run_that_is_too_short_is_refused() -> None:
    """What `simulate` returns bounds the cycles."""
    campaign = parse_campaign(SMALL.replace("cycles = 150", "cycles = 201"), "c.toml")
    with pytest.raises(InputError, match=r"^odometer: a simulated run has 200 cycles; ask for no more"):
        drawn_runs(campaign, campaign.shards[0])


def test_every_vehicle_draws_by_itself() -> None:
    """Speeds, errors and faults differ between vehicles of a shard, and are the same when it is drawn again."""
    campaign = parse_campaign(ON_VALLEY.replace("vehicles = 3", "vehicles = 20"), "c.toml")
    _, drawn, runs = drawn_runs(campaign, campaign.shards[1])
    _, again, same = drawn_runs(campaign, campaign.shards[1])
    assert {0.9, 1.0} == set(drawn.figures["top_share"])
    assert len({faults[0].begin for faults in drawn.faults}) > 10
    assert len({tuple(column) for column in runs.inputs["front_wheel_mm"].T}) == 20
    assert drawn.faults == again.faults
    assert all(np.array_equal(values, same.inputs[name]) for name, values in runs.inputs.items())
