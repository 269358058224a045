"""Values of terms along runs, column by column: the interpreter's, for every kind of term and however great the number."""

from __future__ import annotations

import pytest

from safeloc.assurance.mutation.columns import Columns, Row
from safeloc.language.expr import Bool, Expr, Var, boolean, floor_div, ite, maximum, minimum, number
from safeloc.language.interpret import evaluate
from safeloc.language.nodes import ChooseBool, Truth
from safeloc.language.spec import previous
from safeloc.language.units import COUNT

X, Y, F = number("x", COUNT, -9, 9), number("y", COUNT, -9, 9), boolean("f")
STATES: tuple[Row, ...] = ((0, False), (3, True), (-4, False), (9, True))
INPUTS: tuple[Row, ...] = ((2,), (-7,), (5,))
GREAT = 2**70

NUMBERS = [
    X + Y, X - Y, X * 3, X * GREAT, floor_div(X, 2), minimum(X, Y), maximum(X, Y), ite(F, X, Y), ite(X < Y, X + 1, Y),
]  # fmt: skip
TRUTHS = [X < Y, X <= Y, X.eq(Y), ~F, F & (X < Y), F | (X < Y) | (Y < 0), ChooseBool(F, X < Y, Y < X), Truth(True)]


def _first(moves: dict[Var, Expr], goods: list[Bool]) -> list[int | None]:
    return Columns([X, F], [Y], [(STATES, INPUTS)]).first_different(moves, goods)


@pytest.mark.parametrize("term", NUMBERS, ids=str)
def test_numbers(term: Expr) -> None:
    """Moving as the term says is told in the first step in which the interpreter says that the next state is another one."""
    rows = zip(STATES[:-1], INPUTS, STATES[1:], strict=True)
    told = [evaluate([term], {X: x, F: f, Y: y})[0] != after[0] for (x, f), (y,), after in rows]
    assert [told.index(True)] == _first({X: term}, [])


@pytest.mark.parametrize("term", TRUTHS, ids=str)
def test_truth_values(term: Bool) -> None:
    """The first row in which a term does not hold is the interpreter's; a term that always holds has none."""
    rows = zip(STATES, (*INPUTS, (0,)), strict=True)
    told = [bool(evaluate([term], {X: x, F: f, Y: y})[0]) for (x, f), (y,) in rows]
    assert [told.index(False) if False in told else None] == _first({}, [term])


def test_paths_stand_apart() -> None:
    """The last state of one path does not move into the first one of the next; each path has its own answer."""
    twice = Columns([X], [Y], [(((1,), (2,), (3,)), ((0,), (0,))), (((7,), (8,), (8,)), ((0,), (0,))), (((5,),), ())])
    twice.keep([X + 1])
    assert [None, 1, None] == twice.first_different({X: X + 1}, [])
    assert [2, 0, 0] == twice.first_different({}, [X < 3])
    assert [2, 0, None] == twice.first_different({X: X + 1}, [(X < 3) | X.eq(5)])
    assert [None, 1, None] == twice.first_different({X: X + 1}, [X < 9])


def test_no_paths() -> None:
    """Without runs there is nothing to differ."""
    assert [] == Columns([X], [Y], []).first_different({X: X + 1}, [X < 3])


def test_what_looks_back() -> None:
    """A past operator has no value in a row; it is observed before."""
    with pytest.raises(KeyError, match="has no value here"):
        _first({}, [previous(F)])
