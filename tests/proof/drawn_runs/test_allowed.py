"""Segments in which a condition holds along a variable: they agree with trying every value."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.language.expr import TRUE, Bool, abs_, all_of, between, boolean, ite, maximum, number
from safeloc.language.interpret import evaluate
from safeloc.language.units import MM
from safeloc.proof.drawn_runs.allowed import Condition, Slack, common
from safeloc.proof.drawn_runs.parts import falsifiable

X, Y, FLAG = number("x", MM, -60, 60), number("y", MM, -60, 60), boolean("flag")
CONDITIONS = [
    X <= Y,
    between(-10, X - Y, 10),
    (3 * X).eq(Y),
    abs_(X) <= abs_(Y),
    (X < -20) | (X > Y),
    FLAG.implies(X.eq(Y)),
    maximum(X, Y) <= 7,
    ite(FLAG, X, -X) > Y,
    X.ne(Y),
    -3 * X < Y,
    -3 * X <= Y,
    Y < 3 * X,
    Y <= 3 * X,
    (3 - 2 * X).eq(Y),
    (5 * X <= 2 * Y).iff((X < 40).iff(-7 * X < Y)),
]


@pytest.mark.parametrize("term", CONDITIONS, ids=range(len(CONDITIONS)))
@given(x=st.integers(-60, 60), y=st.integers(-60, 60), flag=st.booleans())
def test_segments_are_exactly_where_it_holds(term: Bool, x: int, y: int, flag: bool) -> None:
    """Every value inside a segment satisfies the condition, and no other value does."""
    values = {X: x, Y: y, FLAG: flag}
    true = [n for n in range(-60, 61) if evaluate([term], {**values, X: n})[0]]
    found = Condition(term).segments(X, values)
    assert true == [n for low, high in found for n in range(low, high + 1)]


@given(st.lists(st.integers(0, 40), max_size=8), st.lists(st.integers(0, 40), max_size=8))
def test_common_is_the_intersection(first: list[int], second: list[int]) -> None:
    """The common part of two lists of segments holds exactly the values that are in both."""

    def segments(points: list[int]) -> list[tuple[int, int]]:
        ordered = sorted(set(points))
        return list(zip(ordered[::2], ordered[1::2], strict=False))

    def inside(parts: list[tuple[int, int]]) -> set[int]:
        return {n for low, high in parts for n in range(low, high + 1)}

    a, b = segments(first), segments(second)
    assert inside(a) & inside(b) == inside(common(a, b))


def test_a_condition_without_variables() -> None:
    """Constants are evaluated as they are, and a term that is always true is no part of a conjunction."""
    assert Condition(TRUE).holds({})
    assert not Condition(~TRUE).holds({})
    assert [] == falsifiable(TRUE)
    assert ["false"] == [repr(part) for part in falsifiable(~TRUE)]
    parts = falsifiable(all_of([X <= 3, (Y <= 3) & FLAG]))
    assert ["(<= x 3)", "(<= y 3)", "flag"] == [repr(part) for part in parts]


@given(st.integers(-60, 60), st.integers(-60, 60), st.booleans())
def test_slack_is_negative_exactly_where_it_fails(x: int, y: int, flag: bool) -> None:
    """The distance to failing is negative exactly if the term fails; it is infinite for purely logical terms."""
    values = {X: x, Y: y, FLAG: flag}
    for term in CONDITIONS:
        assert evaluate([term], values)[0] == (Slack(term)(values) >= 0)
    assert Slack(X <= Y)(values) == y - x
    assert Slack((X <= Y) & (X <= 5))(values) == min(y - x, 5 - x)
    assert Slack((X <= Y) | (X <= 5))(values) == max(y - x, 5 - x)
    assert Slack(FLAG)(values) == (float("inf") if flag else float("-inf"))
