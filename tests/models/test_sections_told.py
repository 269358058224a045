"""Every report of a virtual section: rule, evidence, age and trust; timers as durations; what a broken machine loses."""

from __future__ import annotations

from dataclasses import replace

import pytest
from pydantic import ValidationError

from safeloc.language.interpret import run
from safeloc.language.trace import Trace
from safeloc.language.verdict import Violated
from safeloc.models.area import AreaConfig
from safeloc.models.area import build as build_area
from safeloc.models.area import parts as area_parts
from safeloc.models.area.judgement import EVIDENCE, TRUST
from safeloc.models.sections import Sections, SectionsConfig, compose_machines, joined, section
from safeloc.models.sections.simulate import Scene, TrainRun, first_state, simulate
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import prove
from safeloc.properties.sections import properties

CONFIG = SectionsConfig(area=AreaConfig(trains=2), sections=2)
MODEL = compose_machines(CONFIG)
CUTS = ((0, 5_000_000), (5_000_001, 10_000_000))
FAST = ((0, 40_000),)
SWEEPS = TrainRun(1, 5, 200_000, FAST)


def ran(*trains: TrainRun, seconds: int, model: Sections = MODEL, **more: object) -> Trace:
    """10 km in two sections."""
    scene = Scene((0, 10_000_000), CUTS, trains, seconds, **more)  # type: ignore[arg-type]
    return run(model.composition.system, simulate(CONFIG, scene, seed=2), first=first_state(scene))


def told(trace: Trace, second: int, number: int) -> tuple[str, int, str]:
    """Evidence, its age, and trust of a section."""
    outputs = trace.steps[second].outputs
    name = f"section_{number}"
    return (
        EVIDENCE[int(outputs[f"{name}.evidence"])].label,
        int(outputs[f"{name}.evidence_age_cycles"]),
        TRUST[int(outputs[f"{name}.trust"])].label,
    )


def test_a_section_tells_what_it_rests_on() -> None:
    """Uncounted vehicles at first; the sweeping train elsewhere; no train; then the train that follows."""
    trace = ran(SWEEPS, replace(SWEEPS, slot=2, enters_s=300), seconds=330)
    assert ("UNCOUNTED", 0, "NONE") == told(trace, 3, 1)
    assert ("TRAINS_ELSEWHERE", 0, "VERIFIED") == told(trace, 200, 1)
    assert ("NO_TRAIN", 0, "VERIFIED") == told(trace, 290, 2)
    assert ("TRAIN_FOLLOWED", 0, "VERIFIED") == told(trace, 320, 1)
    assert (0, 5_000_000) == tuple(trace.steps[320].outputs[f"section_1.{end}_mm"] for end in ("from", "to"))


def test_evidence_ages_and_runs_on() -> None:
    """Without reports it ages cycle by cycle; beyond the mute timer a clear section rests on bounds that ran on."""
    lost = replace(SWEEPS, slot=2, enters_s=300, withheld=((320, 330),))
    trace = ran(SWEEPS, lost, seconds=330)
    assert [("TRAIN_FOLLOWED", age, "VERIFIED") for age in (1, 5)] == [told(trace, second, 1) for second in (320, 324)]
    assert ("TRAIN_SILENT", 6, "RUN_ON") == told(trace, 325, 1)
    assert [("TRAINS_ELSEWHERE", 5, "VERIFIED"), ("TRAINS_ELSEWHERE", 6, "RUN_ON")] == [
        told(trace, second, 2) for second in (324, 325)
    ]
    assert trace.steps[325].outputs["section_2.clear"]


def test_a_part_left_behind_is_told_once_the_timer_ends() -> None:
    """Integrity not confirmed for longer than its timer."""
    split = TrainRun(2, 300, 200_000, FAST, splits_s=310, left_behind_mm=100_000)
    trace = ran(SWEEPS, split, seconds=360)
    assert "TRAIN_FOLLOWED" == told(trace, 339, 1)[0]
    assert "PART_LEFT_BEHIND" == told(trace, 340, 1)[0]


def test_timers_are_durations() -> None:
    """The same time in cycles of another length, rounded down; a timer that never ends is refused."""
    half = SectionsConfig(area=AreaConfig(period_ms=700))
    assert (5, 30) == (CONFIG.mute_limit_cycles, CONFIG.integrity_limit_cycles)
    assert (7, 42) == (half.mute_limit_cycles, half.integrity_limit_cycles)
    with pytest.raises(ValidationError, match="they would never end"):
        SectionsConfig(area=AreaConfig(count_limit=30))


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize(
    ("timers", "broken"),
    [
        ({"mute_ms": 3_000}, "section_1 obeys its timers"),
        ({"integrity_wait_ms": 4_000}, "section_1 obeys its timers"),
        ({"mute_ms": 1_000}, "section_1 doubts no train within its timers"),
        ({"integrity_wait_ms": 2_000}, "section_1 doubts no train within its timers"),
        ({"mute_ms": 4_000}, "section_1 is trusted as far as its reports are fresh"),
    ],
)
def test_a_section_with_other_timers_is_noticed(timers: dict[str, int], broken: str) -> None:
    """One or two cycles longer than configured break the property, and one cycle shorter."""
    config = SectionsConfig(area=AreaConfig(trains=1), mute_ms=2_000, integrity_wait_ms=3_000)
    slower = section(config.model_copy(update=timers), "section_1")
    wrong = joined(build_area(area_parts(config.area)), (replace(slower, config=config),))
    prop = next(one for one in properties(wrong) if one.name == broken)
    (found,) = [
        one
        for one in prove(wrong.composition.system, [prop], Limits(depth=12, seconds=20), jobs=1)
        if one.kind == "property"
    ]
    assert isinstance(found.result, Violated)


def test_a_rule_that_is_told_wrongly_is_noticed() -> None:
    """Another number for becoming clear."""
    own = section(SectionsConfig(area=AreaConfig(trains=1)), "section_1")
    row = next(one for one in own.machine.transitions if one.name == "#4 unknown to free")
    rule = next(var for var in row.set if var.name == "rule")
    rows = [replace(one, set={**one.set, rule: 5}) if one is row else one for one in own.machine.transitions]
    machine = replace(own.machine, transitions=rows)
    wrong = joined(build_area(area_parts(own.config.area)), (replace(own, machine=machine),))
    prop = next(one for one in properties(wrong) if one.name == "section_1 names the rule")
    (found,) = [
        one for one in prove(wrong.composition.system, [prop], Limits(seconds=20), jobs=1) if one.kind == "property"
    ]
    assert isinstance(found.result, Violated)
