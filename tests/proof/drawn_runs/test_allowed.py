"""Segments in which a condition holds along a variable: they agree with trying every value."""

from __future__ import annotations

import random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.language.expr import TRUE, Bool, abs_, between, boolean, ite, maximum, number, product
from safeloc.language.interpret import evaluate
from safeloc.language.units import MM
from safeloc.proof.drawn_runs.allowed import Allowed, Condition, Together, common

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
    FLAG | (X < Y) | (X > 50) | X.eq(-3),
    ite(FLAG, X, -2 * X) + Y <= 7,
    ~FLAG | (ite(Y < 0, 3 * X, Y) < 5) | X.ne(Y),
    product(Y, X) <= product(Y, Y),
]


@pytest.mark.thorough(ordinary=8)
@pytest.mark.parametrize("term", CONDITIONS, ids=range(len(CONDITIONS)))
@given(x=st.integers(-60, 60), y=st.integers(-60, 60), flag=st.booleans())
def test_segments_are_exactly_where_it_holds(term: Bool, x: int, y: int, flag: bool) -> None:
    """Every value inside a segment satisfies the condition, and no other value does."""
    values = {X: x, Y: y, FLAG: flag}
    true = [n for n in range(-60, 61) if evaluate([term], {**values, X: n})[0]]
    found = Condition(term).segments(X, values)
    assert true == [n for low, high in found for n in range(low, high + 1)]


@pytest.mark.thorough(ordinary=4)
@pytest.mark.parametrize("first", range(0, len(CONDITIONS), 2))
@given(x=st.integers(-60, 60), y=st.integers(-60, 60), flag=st.booleans(), seed=st.integers(0, 99))
def test_several_conditions_are_allowed_where_all_hold(first: int, x: int, y: int, flag: bool, seed: int) -> None:
    """All their values, and some of them where a search tries few: none of these is wrong, and `Together` says the same of each."""
    terms = [CONDITIONS[first], *CONDITIONS[-4:]]
    conditions = [Condition(term) for term in terms]
    values = {X: x, Y: y, FLAG: flag}
    assert list(map(bool, Together(conditions).holds(values))) == [one.holds(values) for one in conditions]
    true = [n for n in range(-60, 61) if all(evaluate(terms, {**values, X: n}))]
    allowed = Allowed(X, conditions)
    assert true == [n for low, high in allowed.segments(values) for n in range(low, high + 1)]
    assert {n for low, high in allowed.some(values, random.Random(seed)) for n in range(low, high + 1)} <= set(true)


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
    """Constants are evaluated as they are."""
    assert Condition(TRUE).holds({})
    assert not Condition(~TRUE).holds({})
