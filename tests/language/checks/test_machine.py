"""Declaration rules: every wrong declaration is refused, with what, where and what to do."""

from __future__ import annotations

from collections.abc import Mapping

import pytest

from safeloc.errors import ModelError
from safeloc.language.expr import TRUE, before, boolean, choice, enumeration, members, number, optional
from safeloc.language.machine import Machine, Transition, current_mode, modes
from safeloc.language.nodes import FloorDiv, NumVar
from safeloc.language.spec import once
from safeloc.language.units import MM, MS
from safeloc.language.world import World
from tests.declaring import OF_THE_WORLD

A, B = modes("A", "B")
STRANGE, _ = modes("A", "B")
X, N = number("x", MM, 0, 10), number("n", MM, 0, 10)
T, P, Q = number("t", MS, 0, 10), boolean("p"), boolean("q")
HUE = choice("hue", enumeration(members("colour", "RED", "GREEN")))
GHOST, PUSH = number("g", MM, 0, 10), number("push", MM, 0, 10)


def declare(**changes: object) -> Machine:
    """A sound machine with something changed."""
    fields: dict[str, object] = {
        "name": "m",
        "modes": (A, B),
        "inputs": [X, P],
        "state": {N: 0},
        "outputs": {"n": N},
        "transitions": [Transition("go", A, B, P, {N: X})],
        "ghosts": {GHOST: 0},
        "choices": [PUSH],
        "moves": {GHOST: PUSH},
    }
    given = {**fields, **changes}
    world = World(**{name: given.pop(name) for name in OF_THE_WORLD & set(given)})  # type: ignore[arg-type]
    return Machine(**given, world=world)  # type: ignore[arg-type]


def test_the_sound_machine_is_accepted() -> None:
    """The machine that the other tests spoil is itself fine."""
    assert declare().mode.high == 1


WRONG: Mapping[str, tuple[dict[str, object], str]] = {
    "no modes": ({"modes": (), "transitions": []}, "no modes; declare at least one"),
    "mixed modes": ({"modes": (A, STRANGE)}, "different enumerations"),
    "half the modes": ({"modes": (A,), "transitions": []}, "must be all members"),
    "same name twice": ({"inputs": [X, P, boolean("x")]}, "variable 'x' is declared twice"),
    "reserved name": ({"inputs": [X, P, boolean("mode")]}, "this name is reserved"),
    "output like an input": ({"outputs": {"x": N}}, "variable or output 'x' is declared twice"),
    "same transition twice": (
        {"transitions": [Transition("go", A, B, P), Transition("go", B, A, P)]},
        "transition 'go' is declared twice",
    ),
    "strange mode": ({"transitions": [Transition("go", A, STRANGE)]}, "'A' is not a mode of this machine"),
    "no source": ({"transitions": [Transition("go", (), B)]}, "has no source mode"),
    "sets an input": ({"transitions": [Transition("go", A, B, P, {X: 1})]}, "sets 'x', which is not a state variable"),
    "wrong unit": (
        {"inputs": [X, P, T], "transitions": [Transition("go", A, B, P, {N: T})]},
        "unit is ms, expected mm",
    ),
    "wrong kind": ({"transitions": [Transition("go", A, B, P, {N: P})]}, "is not a number"),
    "beyond the range": ({"transitions": [Transition("go", A, B, P, {N: 11})]}, "11 is outside 0..10"),
    "initial beyond": ({"state": {N: 11}}, "initial value of 'n'"),
    "reads a ghost": (
        {"transitions": [Transition("go", A, B, GHOST > 3)]},
        "reads 'g'; it may read only inputs and state",
    ),
    "output reads input": ({"outputs": {"o": X}}, "reads 'x'; it may read only state"),
    "past in a guard": ({"transitions": [Transition("go", A, B, once(P))]}, "uses a past operator"),
    "ghost without move": ({"moves": {}}, "ghost 'g'"),
    "move of no ghost": ({"moves": {GHOST: PUSH, N: PUSH}}, "move of ghost 'n', which is not a ghost"),
    "constant guard": ({"transitions": [Transition("go", A, B, X <= 10)]}, "never changes"),
    "rank out of order": (
        {"transitions": [Transition("late", A, B, P, rank=1), Transition("early", A, A, rank=0)]},
        "has rank 0 but follows 'late' of rank 1",
    ),
    "reserved transition": (
        {"transitions": [Transition("(stay)", A, B, P)]},
        "transition name '(stay)' is reserved; choose another.",
    ),
    "name of an observer": ({"inputs": [X, P, boolean("observer.x")]}, "this name is reserved; choose another."),
    "value before the step": ({"inputs": [X, P, before(N)]}, "is a value before the step; only properties may use it."),
    "name for no proof text": (
        {"inputs": [X, P, boolean("a|b")]},
        "a name has printable characters, at least one, without @",
    ),
    "empty name": ({"inputs": [X, P, boolean("")]}, "a name has printable characters, at least one, without @"),
    "truth value from a number": (
        {"state": {N: 0, Q: False}, "transitions": [Transition("go", A, B, P, {Q: 1})]},
        "1 is not a truth value.",
    ),
    "constant equality": ({"transitions": [Transition("go", A, B, X.eq(N + 0) | X.eq(11))]}, "never changes"),
    "constant order": (
        {"transitions": [Transition("go", A, B, X < 0)]},
        "the comparison x < 0 mm in its guard never changes: x lies between 0 and 10.",
    ),
    "assumption reads a stranger": (
        {"clauses": {"law": boolean("stranger")}},
        "clause 'law' reads 'stranger'; it may read only declared variables.",
    ),
    "initially reads an input": ({"initially": P}, "initially reads 'p'; it may read only state and ghosts."),
    "move of ghost another unit": ({"inputs": [X, P, T], "moves": {GHOST: T}}, "unit is ms, expected mm."),
    "member of another enumeration": (
        {"state": {N: 0, HUE: 0}, "transitions": [Transition("go", A, B, P, {HUE: A})]},
        "sets 'hue': unit is mode, expected colour.",
    ),
    "truth value for a number": ({"state": {N: True}}, "True is not a number."),
    "fraction for a number": ({"state": {N: 0.5}}, "0.5 is not a number."),
    "initial value from a term": (
        {"state": {N: N + 1}},
        "(+ n 1) is a term; give a value, or ANY with a condition in `initially`.",
    ),
    "initial truth from a term": (
        {"state": {N: 0, Q: TRUE}},
        "true is a term; give a value, or ANY with a condition in `initially`.",
    ),
    "guard from a value": ({"transitions": [Transition("go", A, B, True)]}, "True is no truth-valued term; write TRUE"),  # type: ignore[arg-type]
    "guard from a number": ({"transitions": [Transition("go", A, B, X)]}, "x is no truth-valued term; write TRUE"),  # type: ignore[arg-type]
    "clause from a value": ({"clauses": {"law": True}}, "clause 'law': True is no truth-valued term; write TRUE"),
    "clause from a number": ({"clauses": {"c": N}}, "clause 'c': n is no truth-valued term; write TRUE"),
    "lemma from a number": ({"lemmas": {"l": N}}, "lemma 'l': n is no truth-valued term; write TRUE"),
    "output from a value": ({"outputs": {"o": 3}}, "output 'o': 3 is no term; build a term over state variables."),
    "ghost move from a value": ({"moves": {GHOST: 3}}, "move of ghost 'g': 3 is no term; a ghost that keeps its value"),
    "choice in an output": ({"outputs": {"o": PUSH}}, "output 'o' reads 'push'; it may read only state"),
    "ghost in an update": (
        {"transitions": [Transition("go", A, B, P, {N: GHOST})]},
        "reads 'g'; it may read only inputs and state.",
    ),
    "past in a clause": ({"clauses": {"c": once(N > 0)}}, "clause 'c' uses a past operator; only properties may."),
    "past in a lemma": ({"lemmas": {"l": once(N > 0)}}, "lemma 'l' uses a past operator; only properties may."),
    "variable named like a ghost": ({"inputs": [X, P, number("g", MM, 0, 1)]}, "variable 'g' is declared twice"),
    "presence named twice": (
        {"inputs": [X, P, optional("r", MM, 0, 9), boolean("r.present")]},
        "variable 'r.present' is declared twice",
    ),
    "source named twice": (
        {"transitions": [Transition("go", (A, B, B), B, P)]},
        "names source mode 'B' twice; name each mode once.",
    ),
    "modes of another kind": (
        {"modes": members("mode", "A", "B"), "transitions": []},
        "mode 'A': make modes with modes(",
    ),
    "mode variable as state": ({"state": {N: 0, current_mode((A, B)): A}}, "variable 'mode' ("),
    "input that is no variable": ({"inputs": ["x"]}, "input 'x' is no variable; declare it with number"),
    "state that is no variable": ({"state": {"x": 0}}, "state 'x' is no variable; declare it with number"),
    "mode that is no mode": ({"modes": ("A",), "transitions": []}, "mode 'A': make modes with modes(...)."),
    "source that is no mode": (
        {"transitions": [Transition("go", (A, "B"), B, P)]},
        "'B' is a text; give the mode itself, as modes(...) made it.",
    ),  # type: ignore[arg-type]
    "source that is a text": (
        {"transitions": [Transition("go", "CLOSED", B, P)]},  # type: ignore[arg-type]
        "'CLOSED' is a text; give the mode itself",
    ),
    "target that is no mode": (
        {"transitions": [Transition("go", A, 3, P)]},
        "3 is no mode; make modes with modes(...).",
    ),  # type: ignore[arg-type]
    "row that is no transition": ({"transitions": ["go"]}, "transition 'go': make it with Transition(...)."),
    "divisor by hand": ({"outputs": {"o": FloorDiv(N, 0, MM)}}, "FloorDiv: divisor 0; build terms with the functions"),
    "range by hand": ({"inputs": [X, P, NumVar("e", MM, 3, 2)]}, "NumVar: range 3..2 of 'e'; it must be non-empty"),
    "name of many lines": ({"name": "m\nn"}, "its name is 'm\\nn'; use 1 to 120 printable characters"),
    "long transition name": ({"transitions": [Transition("g" * 121, A, B, P)]}, "a name has 1 to 120 printable"),
    "lemma reads input": ({"lemmas": {"l": X > 3}}, "lemma 'l' reads 'x'"),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_declaration_is_refused(name: str) -> None:
    """Each rule has a declaration that breaks it; the message names machine, offence and file."""
    changes, message = WRONG[name]
    with pytest.raises(ModelError) as caught:
        declare(**changes)
    assert message in str(caught.value)
    assert str(caught.value).startswith("machine 'm")
    assert "test_machine.py:" in str(caught.value)


def test_ranks_matter_only_out_of_one_mode() -> None:
    """Transitions out of different modes may stand in any order of rank, and a later one of equal rank is fine."""
    table = [Transition("a", A, B, P, rank=2), Transition("b", B, A, P, rank=0), Transition("c", (A,), A, ~P, rank=2)]
    assert declare(transitions=table).fired_name.high == 3


def test_an_output_may_be_a_state_variable_of_its_name() -> None:
    """The output "n" that is the state variable n is no second declaration; another term of that name is."""
    assert declare(outputs={"n": N}).output("n") is N
    with pytest.raises(ModelError, match="variable or output 'n' is declared twice"):
        declare(outputs={"n": N + 1})


def test_all_offences_are_named_at_once() -> None:
    """One run shows every mistake."""
    with pytest.raises(ModelError) as caught:
        declare(state={N: 11}, moves={})
    assert str(caught.value).count("\n  - ") == 2


def test_what_rows_share_is_told_of_each() -> None:
    """A wrong term is told of every row that has it, also where a row in order stands between them."""
    ghostly, never, past = GHOST > 3, X < 0, once(P)
    guards = {"one": P, "two": P & ghostly & never & past, "three": P & (X > 3), "four": P & ghostly & never & past}
    with pytest.raises(ModelError) as raised:
        declare(transitions=[Transition(name, A, A, guard) for name, guard in guards.items()], clauses={"law": ghostly})
    told = str(raised.value)
    for complaint in (
        "reads 'g'; it may read only inputs and state",
        "uses a past operator",
        "in its guard never changes",
    ):
        assert ["four", "two"] == sorted(
            row for row in guards for line in told.splitlines() if f"{row!r}" in line and complaint in line
        )


def test_what_an_environment_may_read_an_output_may_not() -> None:
    """A term that is allowed in one place is still refused in places where fewer variables may be read."""
    shared = GHOST + N
    with pytest.raises(ModelError, match=r"output 'o' reads 'g'; it may read only state") as raised:
        declare(outputs={"o": shared}, moves={GHOST: shared}, lemmas={"l": shared > 3})
    assert 1 == str(raised.value).count("may read only")


def test_unknown_names_are_told() -> None:
    """fired, output and flag say what there is instead."""
    machine = declare(outputs={"n": N, "some": N > 0})
    with pytest.raises(KeyError, match="has no transition"):
        machine.fired("gone")
    with pytest.raises(TypeError, match="use output"):
        machine.flag("n")
    with pytest.raises(TypeError, match="use flag"):
        machine.output("some")
