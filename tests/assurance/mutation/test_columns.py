"""Values of terms along runs, column by column: the interpreter's, for every kind of term and however great the number."""

from __future__ import annotations

import pytest

from safeloc.assurance.mutation.columns import Along, Columns, Pair, Row
from safeloc.language.expr import Bool, Expr, Num, boolean, floor_div, ite, maximum, minimum, number
from safeloc.language.interpret import evaluate
from safeloc.language.nodes import TRUE, ChooseBool
from safeloc.language.spec import previous
from safeloc.language.units import COUNT

X, Y, F = number("x", COUNT, -9, 9), number("y", COUNT, -9, 9), boolean("f")
STATES: tuple[Row, ...] = ((0, False), (3, True), (-4, False), (9, True), (9, True))
INPUTS: tuple[Row, ...] = ((2,), (-7,), (5,), (5,))
GREAT = 2**70
THREE: list[Along] = [
    (((1,), (2,), (3,)), ((0,), (0,))),
    (((7,), (8,), (8,)), ((0,), (0,))),
    (((5,),), ()),
]


def _where(now: Expr, was: Expr) -> list[bool]:
    """By row, whether the interpreter has another value."""
    rows = zip(STATES, (*INPUTS, (0,)), strict=True)
    return [a != b for (x, f), (y,) in rows for a, b in [evaluate([now, was], {X: x, F: f, Y: y})]]


def _first(moves: list[Pair], goods: list[Pair]) -> list[int | None]:
    known = Columns([X, F], [Y], [(STATES, INPUTS)])
    known.keep(was for _, was in (*moves, *goods))
    return known.first_different(moves, goods)


def _expected(found: list[bool]) -> list[int | None]:
    return [found.index(True) if True in found else None]


def _whole(kind: str, part: Num) -> Num:
    return {
        "sum": part + Y, "difference": Y - part, "product": part * 3, "great": part * GREAT, "quotient": floor_div(part, 2),
        "min": minimum(part, Y), "max": maximum(Y, part), "choice": ite(F, part, Y), "chosen by": ite(part < Y, X, Y),
    }[kind]  # fmt: skip


KINDS = ["sum", "difference", "product", "great", "quotient", "min", "max", "choice", "chosen by"]


@pytest.mark.parametrize("kind", KINDS)
def test_numbers(kind: str) -> None:
    """A wrong part below each kind of term: the first step in which the interpreter has another value, and none if it has none."""
    was, now = _whole(kind, X), _whole(kind, ite(X > 2, X + 1, X))
    expected = _expected(_where(now, was)[:-1])
    assert expected == _first([(now, was)], [])
    assert [None] == _first([(_whole(kind, X), was)], [])
    other = X + Y + 1  # of another form
    assert _expected(_where(other, was)[:-1]) == _first([(other, was)], [])


@pytest.mark.parametrize(
    ("now", "was"),
    [
        (X < Y, X <= Y), (X.eq(Y), X < Y), (~(X < 1), ~(X < 4)), (F & (X < 4), F & (X < 9)), (F & (X < Y), F),
        (F | (X < Y) | (Y < 0), F | (X < Y) | (Y < 9)), (ChooseBool(F, X < Y, Y < X), ChooseBool(F, X < Y, Y < 3)),
        (F, TRUE), (floor_div(X, 2) < 2, floor_div(X, 3) < 2), (~F, F),
    ],
)  # fmt: skip
def test_truth_values(now: Bool, was: Bool) -> None:
    """The first row, the last one included, in which the interpreter has another value."""
    assert _expected(_where(now, was)) == _first([], [(now, was)])


def test_paths_stand_apart() -> None:
    """The last state of one path does not move into the first one of the next; each path has its own answer."""
    known = Columns([X], [Y], THREE)
    known.keep([X, TRUE])
    assert [None, 0, None] == known.first_different([(ite(X > 6, X + 1, X), X)], [])
    assert [None, None, None] == known.first_different([(ite(X.eq(3), X + 1, X), X)], [])
    assert [2, 0, 0] == known.first_different([], [(X < 3, TRUE)])
    assert [2, 0, None] == known.first_different([(ite(X > 6, X + 1, X), X)], [((X < 3) | (X > 4), TRUE)])


def test_no_paths() -> None:
    """Without runs there is nothing to differ."""
    assert [] == Columns([X], [Y], []).first_different([(X + 1, X)], [(X < 3, TRUE)])


def test_what_looks_back() -> None:
    """A past operator has no value in a row; it is observed before."""
    with pytest.raises(KeyError, match="has no value here"):
        _first([], [(previous(F), F)])
