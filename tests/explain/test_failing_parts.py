"""Why a property fails: the parts that do, with their values in the last step."""

from __future__ import annotations

import pytest

from safeloc.errors import PropertyError
from safeloc.explain.failing_parts import Part, failing_parts
from safeloc.language.interpret import run
from safeloc.language.monitor import check
from safeloc.language.nodes import Value
from safeloc.language.spec import Property
from safeloc.language.trace import Trace
from safeloc.language.verdict import Violated
from tests.explain.pump import AT_FIRST, COMES, FALLS, FEW_LEFT, LATE, TOO_MANY, target

GO: dict[str, Value] = {"go": True}
WAIT: dict[str, Value] = {"go": False}


def broken(prop: Property, *steps: dict[str, Value], label: int = 0) -> Trace:
    """The run of the pump up to the step that breaks the property."""
    verdict = check(run(target().system, steps, first={"label": label}), prop)
    assert isinstance(verdict, Violated)
    assert verdict.trace is not None
    return verdict.trace


def told(parts: list[Part]) -> list[tuple[int, bool, str, dict[str, str]]]:
    """Depth, truth, text and values of each part."""
    return [(one.depth, one.holds, one.text, dict(one.values)) for one in parts]


def test_each_part_of_a_conjunction_that_must_not_hold() -> None:
    """All of them hold, and a computed side has its value beside those of its variables."""
    parts = failing_parts(broken(TOO_MANY, GO, *[WAIT] * 4), TOO_MANY)
    assert [(one.depth, one.holds) for one in parts] == [(0, True), (1, True), (1, True), (1, True)]
    assert [dict(one.values) for one in parts] == [
        {},
        {"strokes": "4"},
        {"max(strokes, counted)": "4", "strokes": "4", "counted": "4"},
        {},
    ]
    assert parts[3].text == "hot"


def test_only_the_parts_that_fail_of_a_conjunction_that_must_hold() -> None:
    """The other conjunct holds and is not shown; values before the step are told apart from those after it."""
    system_steps = [GO, *[WAIT] * 10]
    parts = failing_parts(broken(FALLS, *system_steps), FALLS)
    assert [one.holds for one in parts if one.depth == 0] == [False]
    assert not any("strokes" in one.text for one in parts if one.depth > 0)
    assert {"mode": "COOL"} in [dict(one.values) for one in parts]


def test_an_implication_shows_condition_and_conclusion() -> None:
    """Both are parts of the disjunction that fails."""
    again = [GO, *[WAIT] * 10, {"go": True, "extra": 1}, GO]
    only = Property("falls", "always", FALLS.term.parts[0])  # type: ignore[attr-defined] # a conjunction
    parts = told(failing_parts(broken(only, *again), only))
    assert parts[0][:2] == (0, False)
    values = [one[3] for one in parts[1:]]
    assert {"mode": "ON"} in values
    assert {"strokes": "0", "before.strokes": "9"} in [
        {name: value for name, value in one.items() if name in ("strokes", "before.strokes")} for one in values
    ]


def test_the_response_that_did_not_come() -> None:
    """Of `within`, its response in the last step in time."""
    assert told(failing_parts(broken(LATE, GO, *[WAIT] * 5), LATE)) == [(0, False, "mode = OFF", {"mode": "ON"})]


def test_an_output_is_shown_by_its_name() -> None:
    """Its computation is left out: the reader knows what it is."""
    again = [GO, *[WAIT] * 5]
    trace = run(target().system, again)
    verdict = check(trace, FEW_LEFT)
    assert isinstance(verdict, Violated)
    assert verdict.trace is not None
    assert told(failing_parts(verdict.trace, FEW_LEFT)) == [(0, False, "6 count ≤ left", {"left": "0"})]
    later = Trace(trace.system, trace.initial, trace.steps[:5])
    assert [one[3] for one in told(failing_parts(later, FEW_LEFT))] == [{"left": "5"}]


def test_a_first_state_that_violates() -> None:
    """Its values are those of the first state."""
    trace = broken(AT_FIRST, label=7)
    assert not trace.steps
    assert told(failing_parts(trace, AT_FIRST)) == [(0, True, "label = 7 count", {"label": "7"})]


def test_reachable_is_refused() -> None:
    """No run violates it."""
    with pytest.raises(PropertyError, match="'cools' is reachable in some run; no run violates it"):
        failing_parts(run(target().system, [WAIT]), COMES)
