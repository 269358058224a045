"""The oracle: order of transitions, staying put, absent inputs, and refusals of everything it cannot take."""

from __future__ import annotations

import pytest

from safeloc.errors import InputError
from safeloc.language.expr import boolean, number, optional
from safeloc.language.interpret import evaluate, run, start, taken
from safeloc.language.machine import ANY, Machine, Transition, modes
from safeloc.language.nodes import Compare
from safeloc.language.spec import once
from safeloc.language.system import lower, without_ghosts
from safeloc.language.units import MM
from safeloc.language.world import World

A, B = modes("A", "B")
X, P, READING = number("x", MM, -5, 10), boolean("p"), optional("r", MM, 3, 9)
N, OPEN_, G = number("n", MM, 0, 50), number("open", MM, 2, 8), number("g", MM, 0, 9)
MACHINE = Machine(
    name="small",
    modes=(A, B),
    inputs=[X, P, READING],
    state={N: 0, OPEN_: ANY},
    outputs={"twice": N * 2},
    transitions=[
        Transition("read", A, B, READING.present, {N: READING.value}, rank=0),
        Transition("first", A, A, X > 3, {N: N + 1}, rank=1),
        Transition("second", A, B, X > 1, {N: 7}, rank=2),
        Transition("back", B, A, P),
    ],
    world=World(ghosts={G: 1}, moves={G: G}),
    initially=OPEN_ < 6,
)
SYSTEM = lower(MACHINE)


def fired(*stream: dict[str, object]) -> list[str]:
    """The transitions of a run."""
    return [step.fired["fired"] for step in run(SYSTEM, stream).steps]


def test_the_first_enabled_transition_is_taken() -> None:
    """Order is priority; nothing enabled means staying, with every value as it was."""
    assert fired({"x": 5, "p": False}, {"x": 2, "p": False}, {"x": 5, "p": False}, {"x": 0, "p": True}) == [
        "first",
        "second",
        "(stay)",
        "back",
    ]


def test_values_and_outputs() -> None:
    """Updates read the values before the step; outputs the state after it."""
    trace = run(SYSTEM, [{"x": 5, "p": False}, {"x": 0, "p": False, "r": 9}])
    assert [step.state["n"] for step in trace.steps] == [1, 9]
    assert [step.outputs["twice"] for step in trace.steps] == [2, 18]
    assert trace.steps[0].inputs == {"x": 5, "p": False, "r.present": False, "r": 3}
    assert trace.stream() == [{"x": 5, "p": False}, {"x": 0, "p": False, "r": 9}]


@pytest.mark.parametrize(
    ("record", "message"),
    [
        ({"p": True}, "input 'x' is missing"),
        ({"x": 1, "p": True, "z": 3}, "unknown inputs"),
        ({"x": 11, "p": True}, "x: 11 mm is outside -5..10"),
        ({"x": 1.0, "p": True}, "expected a whole number of mm, got 1.0"),
        ({"x": float("nan"), "p": True}, "expected a whole number"),
        ({"x": True, "p": True}, "expected a whole number"),
        ({"x": "1", "p": True}, "expected a whole number"),
        ({"x": 1, "p": 1}, "expected true or false, got 1"),
        ({"x": 1, "p": True, "r": 2}, "r: 2 mm is outside 3..9"),
        ({"x": 1, "p": True, "r.present": True}, "is True but r is None"),
        ({"x": 1, "p": True, "r": 5, "r.present": False}, "r.present is False but r is 5"),
        ({"x": 1, "p": True, "r": 5, "r.present": 1}, "r.present: expected true or false, got 1"),
        ({"x": 1, "p": True, "r.present": 0}, "r.present: expected true or false, got 0"),
        ({"x": 1, "p": True, "r": False}, "r: expected a whole number of mm, got False"),
        ({"x": 1, "p": True, "xx": 0}, r"unknown inputs \['xx'\]\. Did you mean 'x'\?$"),
        ({"x": 1, "p": True, "mode": 0}, r"unknown inputs \['mode'\]"),
        ({"x": 1, "p": None}, "p: expected true or false, got None"),
    ],
)
def test_what_cannot_be_taken_is_refused(record: dict[str, object], message: str) -> None:
    """Missing, unknown, out of range, of another kind: each with its name and what was expected."""
    with pytest.raises(InputError, match=message):
        run(SYSTEM, [record])


@pytest.mark.parametrize(
    ("given", "present", "value"),
    [
        ({}, False, 3),
        ({"r": None}, False, 3),
        ({"r.present": False}, False, 3),
        ({"r": 3, "r.present": False}, False, 3),
        ({"r": 3}, True, 3),
        ({"r": 9, "r.present": True}, True, 9),
    ],
)
def test_absent_is_not_the_lowest_value(given: dict[str, object], present: bool, value: int) -> None:
    """Left out, None and a false flag are absence; a value without a flag is there, even the stand-in's."""
    inputs = run(SYSTEM, [{"x": 1, "p": False, **given}]).steps[0].inputs
    assert (present, value) == (inputs["r.present"], inputs["r"])


def test_open_initial_values_may_be_chosen() -> None:
    """ANY begins near zero or as chosen, within range and `initially`; fixed ones cannot be chosen."""
    assert run(SYSTEM, []).initial["open"] == 2
    assert run(SYSTEM, [], first={"open": 5}).initial["open"] == 5
    for chosen, message in (
        ({"open": 9}, "outside 2..8"),
        ({"open": 7}, "breaks `initially`"),
        ({"open": True}, "open: expected a whole number of mm, got True"),
        ({"open": None}, "open: expected a whole number of mm, got None"),
        ({"n": 3}, "starts at 0 by declaration"),
        ({"gone": 3}, "unknown state variables"),
    ):
        with pytest.raises(InputError, match=message):
            start(SYSTEM, chosen)


def test_on_board_there_are_no_ghosts() -> None:
    """without_ghosts leaves what runs in a controller."""
    assert [var.name for var in without_ghosts(SYSTEM).state] == ["mode", "n", "open"]


def test_terms_that_no_state_gives_a_value_are_refused() -> None:
    """An operator about the past has to be observed first; an unknown comparison is a defect, not a value."""
    with pytest.raises(
        InputError, match=r"^Past reads earlier steps and cannot be evaluated; `observe` the property first\.$"
    ):
        evaluate([once(P)], {P: True})
    with pytest.raises(AssertionError):
        evaluate([Compare("<>", X, N)], {X: 1, N: 2})  # type: ignore[arg-type]


def test_a_run_is_taken_as_long_as_a_condition_holds() -> None:
    """It ends before the first step that breaks it; a hidden variable is not shown, and moves on."""
    stream, state = [{"x": 5, "p": False}] * 3, start(SYSTEM, {"open": 2})
    steps = list(taken(SYSTEM, state, stream, while_=(N < 2) & (X > 4), hidden={N}))
    assert [{"mode": 0, "open": 2, "g": 1}] * 2 == [one.state for one, _ in steps]
    assert [1, 2] == [after[N] for _, after in steps]
    assert 3 == len(list(taken(SYSTEM, state, stream)))
