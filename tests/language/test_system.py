"""Lowering: the table becomes one next-state map; initial states, ranges and the environment are terms."""

from __future__ import annotations

import pytest

from safeloc.language.expr import TRUE, boolean, number, optional
from safeloc.language.interpret import holds
from safeloc.language.machine import ANY, Machine, Transition, modes
from safeloc.language.system import canonical, environment, in_range, lower, without_ghosts
from safeloc.language.units import MM
from safeloc.language.world import World

A, B = modes("A", "B")
X, READING, LIT = number("x", MM, -5, 10), optional("r", MM, 3, 9), boolean("lit")
N, GHOST, PUSH = number("n", MM, 0, 50), number("g", MM, 0, 9), number("push", MM, 0, 9)
MACHINE = Machine(
    name="small",
    modes=(A, B),
    inputs=[X, READING],
    state={N: ANY, LIT: True},
    outputs={"n": N},
    transitions=[Transition("go", A, B, X > 3, {LIT: False})],
    world=World(ghosts={GHOST: 1}, choices=[PUSH], moves={GHOST: PUSH}, clauses={"assumption": X <= PUSH}),
    initially=(N < 6) & GHOST.eq(1),
    lemmas={"low": N <= 50},
)
SYSTEM = lower(MACHINE)
FIRST = {SYSTEM.state[0]: 0, N: 3, LIT: True, GHOST: 1}


def test_every_state_variable_has_one_next_value() -> None:
    """The map is total: mode, state and ghosts, in this order."""
    assert [var.name for var in SYSTEM.next] == [var.name for var in SYSTEM.state] == ["mode", "n", "lit", "g"]
    assert SYSTEM.ghosts == {GHOST, PUSH}


@pytest.mark.parametrize(
    ("changes", "expected"),
    [({}, True), ({N: 6}, False), ({LIT: False}, False), ({GHOST: 2}, False), ({SYSTEM.state[0]: 1}, False)],
)
def test_first_states(changes: dict[object, object], expected: bool) -> None:
    """Declared values and `initially` both hold of the first state; ANY leaves a variable open."""
    assert holds(SYSTEM.init, {**FIRST, **changes}) is expected  # type: ignore[dict-item]


def test_on_board_nothing_is_assumed() -> None:
    """Without ghosts there is no assumption and no lemma; of `initially`, what reads no ghost stays."""
    board = without_ghosts(SYSTEM)
    assert {var.name for var in board.inputs} == {"x", "r", "r.present"}
    assert board.assume is TRUE
    assert (board.lemmas, board.ghosts) == ({}, frozenset())
    mode = board.state[0]
    assert holds(board.init, {mode: 0, N: 5, LIT: True})
    assert not holds(board.init, {mode: 0, N: 6, LIT: True})


@pytest.mark.parametrize(
    ("low", "high", "value"), [(3, 9, 3), (-9, -3, -3), (-5, 5, 0), (0, 0, 0)], ids=["above", "below", "around", "zero"]
)
def test_an_absent_value_stands_nearest_zero(low: int, high: int, value: int) -> None:
    """The canonical value lies in the range."""
    assert canonical(number("v", MM, low, high)) == value


@pytest.mark.parametrize(
    ("inputs", "expected"),
    [
        ({X: 2, READING.present: True, READING.value: 9, PUSH: 2}, True),
        ({X: 3, READING.present: True, READING.value: 9, PUSH: 2}, False),
        ({X: 11, READING.present: True, READING.value: 9, PUSH: 9}, False),
        ({X: 2, READING.present: False, READING.value: 3, PUSH: 2}, True),
        ({X: 2, READING.present: False, READING.value: 4, PUSH: 2}, False),
    ],
    ids=["lawful", "breaks the assumption", "out of range", "absent", "absent with a value"],
)
def test_the_environment(inputs: dict[object, object], expected: bool) -> None:
    """Ranges, one value for what is absent, and the assumption; the assumption may be left out."""
    assert holds(environment(SYSTEM), {**FIRST, **inputs}) is expected  # type: ignore[dict-item]
    lawful_but_for_assumption = expected or inputs[X] == 3
    assert holds(environment(SYSTEM, assume=False), {**FIRST, **inputs}) is lawful_but_for_assumption  # type: ignore[dict-item]


def test_ranges_of_members_are_members() -> None:
    """An enumeration's range is one of its members; truth values have no range."""
    assert holds(in_range([SYSTEM.state[0], LIT]), {SYSTEM.state[0]: 1})
    assert not holds(in_range([SYSTEM.state[0]]), {SYSTEM.state[0]: 2})
    assert in_range([LIT]) is TRUE


def test_variables_by_name() -> None:
    """A variable is found by name; an unknown one is told what there is."""
    assert SYSTEM.variable("n") is N
    with pytest.raises(KeyError, match=r"small has no variable 'gone'; it has \['mode', 'n', 'lit', 'g'"):
        SYSTEM.variable("gone")
