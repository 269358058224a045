"""Campaigns whose readers stamp late or are mounted beside their place: which laws that breaks, and what becomes of the vehicles."""

from __future__ import annotations

import numpy as np
import pytest

from safeloc.campaign.declaration import parse_campaign
from safeloc.campaign.judged import Outcome
from safeloc.campaign.scenes import check_strata, drawn_runs
from safeloc.campaign.shards import judge_of_target
from safeloc.errors import InputError
from safeloc.simulation.many_runs import ManyRuns

VALLEY = """machine = "{machine}"
cycles = 2000
seed = 5
[[lines]]
line = "valley"
[[vehicles]]
vehicle = "desiro-br642"
[[situations]]
name = "all"
weight = 1.0
vehicles = {vehicles}
"""


def runs(machine: str, vehicles: int, **figures: str) -> tuple[ManyRuns, Outcome, list[str]]:
    """The runs of vehicles with these figures, what becomes of them, and the clauses that break."""
    text = VALLEY.format(machine=machine, vehicles=vehicles)
    if figures:
        text += "[situations.figures]\n" + "".join(f"{name} = {{ {said} }}\n" for name, said in figures.items())
    campaign = parse_campaign(text, "c.toml")
    check_strata(campaign)
    scene, _, found = drawn_runs(campaign, campaign.shards[0])
    judge = judge_of_target(scene.target)
    outcome = judge.outcome(found)
    broken = [name for name, held in zip(judge.clauses, outcome.held, strict=True) if not held.all()]
    return found, outcome, broken


def fixed(value: float, unit: str) -> str:
    """One value."""
    return f'distribution = "fixed", value = {value}, unit = "{unit}"'


def uniform(low: float, high: float, unit: str) -> str:
    """Any value between two ends."""
    return f'distribution = "uniform", low = {low}, high = {high}, unit = "{unit}"'


def cycles(one: Outcome) -> list[int]:
    """Vehicle-cycles: law kept and contained, kept and wrong; broken and contained, silent, wrong."""
    wrong, broken = one.told & (one.margin_nm < 0), one.broken
    sorts = (
        ~broken & one.told & ~wrong,
        ~broken & wrong,
        broken & one.told & ~wrong,
        broken & ~one.told,
        broken & wrong,
    )
    return [int(flags.sum()) for flags in sorts]


@pytest.mark.thorough
def test_readers_as_late_as_declared_keep_every_law() -> None:
    """11 of 12 ms: the run since each marker is shorter than in time, and no clause breaks; mounting within the units' rate neither."""
    plain, _, _ = runs("odometry", 10)
    late, found, broken = runs("odometry", 10, reader_processing_ms=fixed(11, "ms"), rear_mounting_mm=fixed(250, "mm"))
    assert [] == broken
    assert found.told.any(axis=0).all()
    name = "front_marker_since_mm"
    both = plain.inputs[f"{name}.present"] & late.inputs[f"{name}.present"]
    speed_mm_s = plain.inputs["true_cycle_distance_nm"][both] / 1e5
    shorter = plain.inputs[name][both] - late.inputs[name][both]
    assert both.sum() > 100
    assert np.abs(shorter - speed_mm_s * 0.011).max() <= 2


@pytest.mark.thorough
def test_late_readers_break_the_law_of_readers_and_no_other() -> None:
    """Up to 1 s, 100 000 vehicle-cycles: contained before and after the breach, noticed, and not noticed; with the law kept none is wrong."""
    _, found, broken = runs("odometry", 50, reader_processing_ms=uniform(0, 1_000, "ms"))
    assert ["front reader stood over its marker", "rear reader stood over its marker"] == broken
    kept, contradicts, contained, noticed, unnoticed = cycles(found)
    assert 0 == contradicts
    assert min(kept, contained, noticed, unnoticed) > 1_000
    assert 100_000 >= kept + contained + noticed + unnoticed


@pytest.mark.thorough
def test_a_rear_reader_far_from_its_place_breaks_the_law_of_the_length() -> None:
    """Where no place of the marker explains the readings: ahead of its place the vehicle is too short. It is never longer than its data
    allow, so behind its place the reader was not over its marker.
    """
    for mounting, clause in (
        (9_000, "the readers are as far apart as configured"),
        (-9_000, "rear reader stood over its marker"),
    ):
        _, found, broken = runs("odometry", 6, rear_mounting_mm=fixed(mounting, "mm"))
        assert [clause] == broken
        assert 0 == cycles(found)[1]


@pytest.mark.thorough
def test_a_late_antenna_did_not_stand_over_the_group() -> None:
    """700 ms late it breaks that law and no other, and the machine notices; 5 ms late it breaks none."""
    _, found, broken = runs("balise", 6, reader_processing_ms=fixed(700, "ms"))
    assert ["the antenna stood over the group that is read"] == broken
    assert 0 == cycles(found)[1]
    read, _, broken = runs("balise", 6, reader_processing_ms=fixed(5, "ms"), antenna_mounting_mm=fixed(-50, "mm"))
    assert [] == broken and read.inputs["telegram_group.present"].any()


@pytest.mark.thorough
def test_a_reader_without_time_misses_markers() -> None:
    """Five telegrams of which half fail, in 0.3 m of contact: fast vehicles read few markers."""
    plain, _, _ = runs("odometry", 10)
    failing, _, broken = runs(
        "odometry",
        10,
        reader_telegrams=fixed(5, "telegrams"),
        reader_failed=fixed(0.5, "share"),
        reader_contact_mm=fixed(300, "mm"),
    )
    read = [int(one.inputs["front_marker.present"].sum()) for one in (plain, failing)]
    assert 0 < read[1] < read[0] / 2
    assert set(broken) <= {"front reader stood over its marker", "rear reader stood over its marker"}


@pytest.mark.parametrize(
    ("name", "said", "why"),
    [
        ("reader_processing_ms", fixed(5, "mm"), r"its unit is ms, not 'mm'"),
        ("reader_processing_ms", fixed(5_000, "ms"), r"5000 ms leaves the range 0 to 1000 ms"),
        ("reader_processing", fixed(5, "ms"), r"there is no such figure; there are .*reader_processing_ms"),
        ("antenna_mounting_mm", fixed(5, "mm"), r"there is no such figure"),
    ],
)
def test_a_wrong_figure_is_refused_with_its_line(name: str, said: str, why: str) -> None:
    """An unknown name, also that of another machine's reader, a wrong unit, a value out of range."""
    with pytest.raises(InputError, match=rf"^c\.toml:13: situations\.0\.figures\.{name}: .*{why}"):
        runs("odometry", 1, **{name: said})
