"""Parts of a condition: their conjunction is the condition, and each is smaller."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.language.expr import TRUE, Bool, abs_, all_of, any_of, between, boolean, maximum, minimum, number
from safeloc.language.interpret import evaluate
from safeloc.language.nodes import ChooseBool
from safeloc.language.units import MM
from safeloc.proof.drawn_runs.parts import falsifiable

X, Y, FLAG, OTHER = number("x", MM, -9, 9), number("y", MM, -9, 9), boolean("flag"), boolean("other")
NEAR, SLOW = between(-3, X, 3), between(-2, Y, 2)
CONDITIONS: list[tuple[Bool, int]] = [
    (TRUE, 0),
    (~TRUE, 1),
    (all_of([X <= 3, (Y <= 3) & FLAG]), 3),
    (FLAG.implies(NEAR & SLOW), 4),
    (ChooseBool(FLAG, NEAR, SLOW), 4),
    (~ChooseBool(FLAG, X < 3, Y < 3), 2),
    (abs_(X) <= 4, 2),
    (maximum(X, Y) < minimum(X + 3, Y + 4), 4),
    (~(NEAR & SLOW), 1),
    (~(FLAG | (X < 2)), 2),
    (any_of([NEAR & SLOW, between(-1, X - Y, 1), OTHER & FLAG]), 16),
    (any_of([NEAR & SLOW & OTHER, between(-1, X - Y, 1) & FLAG, between(4, X, 8) & between(3, Y, 7)]), 20),
]


@pytest.mark.parametrize(("term", "count"), CONDITIONS, ids=range(len(CONDITIONS)))
def test_a_condition_has_so_many_parts(term: Bool, count: int) -> None:
    assert len(falsifiable(term)) == count


@pytest.mark.parametrize("term", [term for term, _ in CONDITIONS], ids=range(len(CONDITIONS)))
@given(x=st.integers(-9, 9), y=st.integers(-9, 9), flag=st.booleans(), other=st.booleans())
def test_the_parts_together_are_the_condition(term: Bool, x: int, y: int, flag: bool, other: bool) -> None:
    values = {X: x, Y: y, FLAG: flag, OTHER: other}
    assert all(evaluate(falsifiable(term), values)) == bool(evaluate([term], values)[0])
