"""The test emitter: only its own pattern, from its place, when it is due; a dead chain is reported in time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import pytest
from pydantic import ValidationError

from safeloc.language.expr import FALSE, TRUE, Bool
from safeloc.language.interpret import run
from safeloc.language.system import lower, without_ghosts
from safeloc.language.trace import Trace
from safeloc.models import emitter
from safeloc.models.emitter import Emitter, EmitterConfig, Parts, build, judgement, parts
from safeloc.properties.emitter import properties
from safeloc.runtime.streams.steps import Cell
from tests.models.everything_proved import unproved_of
from tests.models.fibre_family import labels, mode_labels
from tests.models.inductive import changed, inductive
from tests.models.wrong_edits import lost

CONFIG = EmitterConfig()
OWN: dict[str, Cell] = {"heard_pattern": CONFIG.pattern, "heard_place_mm": CONFIG.place_mm}


@cache
def made() -> Emitter:
    """The machine with its variables."""
    return build(parts(CONFIG))


def heard(cycles: int, at: dict[int, dict[str, Cell]]) -> Trace:
    """So many cycles, with something heard or asked in some."""
    steps = [{"test_requested": False, **at.get(cycle, {})} for cycle in range(cycles)]
    return run(without_ghosts(lower(made().machine)), steps)


def test_regular_patterns_keep_the_chain_tested() -> None:
    """One pattern in every due window."""
    trace = heard(60, {18: OWN, 37: OWN, 56: OWN})
    assert mode_labels(made().machine, trace)[18:] == ["TESTED"] * 42


def test_a_missing_pattern_fails_in_time() -> None:
    """Tested up to the due time after the last pattern, failed one cycle later."""
    found = mode_labels(made().machine, heard(60, {18: OWN}))
    assert found[18 + CONFIG.due_cycles] == "TESTED"
    assert found[18 + CONFIG.due_cycles + 1] == "FAILED"


@pytest.mark.parametrize(
    ("cells", "verdict", "mode"),
    [
        ({"heard_pattern": CONFIG.pattern ^ 1, "heard_place_mm": CONFIG.place_mm}, "FOREIGN", "TESTED"),
        ({"heard_pattern": CONFIG.pattern}, "NO_PLACE", "TESTED"),
        (OWN, "NOT_DUE", "TESTED"),
        (
            {"heard_pattern": CONFIG.pattern, "heard_place_mm": CONFIG.place_mm + CONFIG.place_tolerance_mm + 1},
            "ELSEWHERE",
            "FAILED",
        ),
    ],
)
def test_what_does_not_pass(cells: dict[str, Cell], verdict: str, mode: str) -> None:
    """It renews nothing; the own pattern from another place fails the chain at once."""
    trace = heard(30, {18: OWN, 23: cells})
    assert (labels(trace, "verdict")[23], mode_labels(made().machine, trace)[23]) == (verdict, mode)
    assert trace.steps[23].outputs["next_due_in_cycles"] < CONFIG.due_cycles


def test_a_request_is_answered_or_fails() -> None:
    """An answer counts before its regular time; none fails within its own time and one cycle."""
    ask: dict[str, Cell] = {"test_requested": True}
    assert labels(heard(30, {18: OWN, 22: ask, 25: OWN}), "verdict")[25] == "PASSED"
    found = mode_labels(made().machine, heard(40, {18: OWN, 22: ask}))
    assert found.index("FAILED") == 22 + CONFIG.answer_cycles


def test_a_request_is_not_forgotten() -> None:
    """Made in the cycle in which the chain fails, or while the own pattern comes from elsewhere: its answer counts."""
    ask: dict[str, Cell] = {"test_requested": True}
    elsewhere: dict[str, Cell] = {**OWN, "heard_place_mm": CONFIG.place_mm + CONFIG.place_tolerance_mm + 1}
    assert labels(heard(40, {18: OWN, 22: ask, 24: elsewhere, 26: OWN}), "verdict")[26] == "PASSED"
    assert labels(heard(40, {18: OWN, 22: ask, 28: ask, 30: OWN}), "verdict")[30] == "PASSED"


def test_a_pattern_that_comes_too_late_still_tells_the_time() -> None:
    """The chain fails, but a repetition of that pattern in the next cycle is not due."""
    trace = heard(60, {18: OWN, 39: OWN, 40: OWN})
    assert (mode_labels(made().machine, trace)[39], labels(trace, "verdict")[40]) == ("FAILED", "NOT_DUE")


def test_recovery_takes_several_patterns() -> None:
    """After a failure one pattern is not enough."""
    found = mode_labels(made().machine, heard(90, {18: OWN, 45: OWN, 62: OWN}))
    assert (found[45], found[62]) == ("FAILED", "TESTED")


@pytest.mark.thorough
def test_everything_is_proved() -> None:
    """All properties, without bound."""
    assert unproved_of(made().machine, properties(made())) == {}


@pytest.mark.parametrize(
    ("row", "fields", "broken"),
    [
        ("pattern does not come", {"when": FALSE}, "a dead chain is reported"),
        ("own pattern from elsewhere", {"when": FALSE}, "own pattern from elsewhere fails"),
        ("first pattern passes", {"when": TRUE}, "tested rests on a pattern"),
        ("wait for the next pattern", {"set": {}}, "a dead chain is reported"),
    ],
)
def test_a_broken_row_is_noticed(row: str, fields: dict[str, object], broken: str) -> None:
    """A pattern that is not waited for, or not looked at, loses a proof."""
    wrong = replace(made(), machine=changed(made().machine, row, **fields))
    assert not inductive(wrong.machine, next(prop for prop in properties(wrong) if prop.name == broken))


def test_a_pattern_that_counts_at_any_time_is_refused() -> None:
    """A window as long as the due time tests nothing."""
    with pytest.raises(ValidationError, match="tests nothing"):
        EmitterConfig(window_cycles=20)


Edit = Callable[[Parts], Bool]
EDITS: dict[str, tuple[str, Edit, str]] = {
    "the pattern counts at any time": ("due", lambda own: TRUE, "a dead chain is reported"),
    "and shows a chain that is dead": ("due", lambda own: TRUE, "a pattern that passes came through the chain"),
    "one cycle too early": (
        "due",
        lambda own: (
            (own.since_passed + 2 >= own.config.due_cycles - own.config.window_cycles) | (own.since_request > 0)
        ),
        "a pattern that passes came through the chain",
    ),
    "the answer to a request does not count": (
        "due",
        lambda own: own.since_passed + 1 >= own.config.due_cycles - own.config.window_cycles,
        "a pattern passes when the emitter is to send, and only then",
    ),
    "from anywhere": ("near", lambda own: TRUE, "only the own pattern passes"),
    "from anywhere below": (
        "near",
        lambda own: own.place.value - own.config.place_mm <= own.config.place_tolerance_mm,
        "a pattern that passes came through the chain",
    ),
    "no pattern is awaited": (
        "overdue",
        lambda own: own.since_request >= own.config.answer_cycles,
        "silence is reported",
    ),
    "no answer is awaited": (
        "overdue",
        lambda own: own.since_passed >= own.config.due_cycles,
        "request is answered",
    ),
}


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("edit", EDITS)
def test_a_wrong_edit_of_a_term_is_noticed(edit: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """FVA-8: known place and known time, in the terms that the machine judges by."""
    name, term, broken = EDITS[edit]
    for module in (judgement, emitter):
        monkeypatch.setattr(module, name, term, raising=False)
    wrong = build(parts(CONFIG))
    assert lost(wrong.machine, properties(wrong), broken)


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize(
    ("row", "forgets", "broken"),
    [
        ("one more pattern passes", "passes", "patterns count one after the other"),
        ("pattern does not come", "since_request", "a pattern passes when the emitter is to send, and only then"),
        ("own pattern from elsewhere", "since_request", "a pattern passes when the emitter is to send, and only then"),
        pytest.param(
            "pattern does not come",
            "since_passed",
            "a pattern that passes came through the chain",
            marks=pytest.mark.slow,
        ),
        ("wait for a pattern after the failure", "passes", "patterns count one after the other"),
    ],
)
def test_a_clock_that_a_row_forgets_is_noticed(row: str, forgets: str, broken: str) -> None:
    """Every row keeps both clocks and the count going."""
    wrong = build(parts(CONFIG))
    kept = next(one for one in wrong.machine.transitions if one.name == row)
    fewer = {var: term for var, term in kept.set.items() if var is not getattr(wrong.own, forgets)}
    wrong = replace(wrong, machine=changed(wrong.machine, row, set=fewer))
    assert lost(wrong.machine, properties(wrong), broken)


@pytest.mark.thorough
@pytest.mark.parametrize("fields", [{"passes_to_recover": 1}, {"passes_to_recover": 3, "window_cycles": 1}])
def test_other_figures_are_proved(fields: dict[str, int]) -> None:
    """One pattern recovers at once, or three; a window of one cycle."""
    model = build(parts(EmitterConfig(**fields)))
    assert lost(model.machine, properties(model)) == {}
