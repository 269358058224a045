"""Interval analysis never claims a narrower interval than what happens."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.language.expr import Num, boolean, floor_div, ite, maximum, members, minimum, number, product
from safeloc.language.interpret import evaluate, read_inputs, start, step
from safeloc.language.nodes import INT64_MAX
from safeloc.language.ranges import beyond_int64, bounds
from safeloc.language.system import lower
from safeloc.language.units import COUNT
from tests.random_machines import first_states, machines, streams

X, Y = number("x", COUNT, -3, 5), number("y", COUNT, 2, 4)


@given(st.data())
def test_values_stay_within_bounds(data: st.DataObject) -> None:
    """On any machine and any stream, every term's value lies within its bounds."""
    system = lower(data.draw(machines()))
    found = bounds([*system.next.values(), *system.fired.values()])
    terms, state = list(found), start(system, data.draw(first_states(system)))
    for record in data.draw(streams(system)):
        inputs = read_inputs(system, record)
        for term, value in zip(terms, evaluate(terms, {**state, **inputs}), strict=True):
            assert found[term][0] <= value <= found[term][1]
        state, _ = step(system, state, inputs)


@pytest.mark.parametrize(
    ("expected", "term"),
    [
        ((-1, 9), X + Y),
        ((-7, 3), X - Y),
        ((-12, 20), product(X, Y)),
        ((-10, 6), X * -2),
        ((-2, 2), floor_div(X, 2)),
        ((-3, 4), minimum(X, Y)),
        ((2, 5), maximum(X, Y)),
        ((-3, 5), ite(boolean("c"), X, Y)),
        ((1, 1), members("colour", "RED", "GREEN")[1]),
    ],
    ids=repr,
)
def test_bounds_of_each_kind_of_term(expected: tuple[int, int], term: Num) -> None:
    """Each kind of term is bounded by what its parts can be, no wider."""
    assert expected == bounds([term])[term]


def test_terms_that_may_leave_64_bits_are_named() -> None:
    """The greatest 64-bit number is still within; one more is not."""
    most = number("most", COUNT, 0, INT64_MAX)
    over = most + 1
    assert beyond_int64([most.eq(0)]) == []
    assert beyond_int64([over.eq(0)]) == [over]
