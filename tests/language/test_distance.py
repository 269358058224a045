"""The distance of a condition: its sign is the condition's truth, its size the slack in the condition's own unit."""

from __future__ import annotations

from itertools import product as every

import pytest

from safeloc.errors import ModelError
from safeloc.language.distance import Distance, distance
from safeloc.language.expr import Bool, Expr, Num, boolean, choice, enumeration, ite, maximum, members, number
from safeloc.language.interpret import evaluate
from safeloc.language.nodes import Value
from safeloc.language.spec import previous
from safeloc.language.units import MM, MS, ONE, Unit

A, B, AGE, FLAG = number("a", MM, -3, 3), number("b", MM, -3, 3), number("age", MS, 0, 2), boolean("flag")
RED, GREEN = members("Light", "RED", "GREEN")
LIGHT = choice("light", enumeration((RED, GREEN)))
CONDITIONS: list[Bool] = [
    A <= B, A < B, A.eq(B), A.ne(B), ~(A <= B), ~(A < B), (A <= B) & (B <= 2), (A < B) | (B < A), ~((A <= B) & (B <= 2)),
    FLAG, ~FLAG, FLAG.implies(A <= B), LIGHT.eq(RED).implies(A <= B), (AGE <= 1).implies(A < B), ite(FLAG, A < B, B < A),
    (A <= B).iff(FLAG), (A * 5 <= B * 3), ~ite(FLAG, A <= B, AGE < 1), maximum(A, B) <= 1, AGE <= 1,
]  # fmt: skip


def at(condition: Bool, values: dict[Expr, Value], hidden: frozenset[Expr] = frozenset()) -> tuple[int | None, Unit]:
    """The distance under these values, and its unit."""
    found = distance(condition, hidden)
    return found.of_value(int(evaluate([found.term], values)[0])), found.unit  # type: ignore[arg-type] # variables


@pytest.mark.parametrize("condition", CONDITIONS, ids=repr)
def test_it_is_not_negative_exactly_where_the_condition_holds(condition: Bool) -> None:
    """For all values of all variables."""
    for scaled in (frozenset[Num](), frozenset({A})):
        found: Distance = distance(condition, scaled)
        for a, b, age, flag, light in every(range(-3, 4), range(-3, 4), range(3), (False, True), (0, 1)):
            by, holds = evaluate([found.term, condition], {A: a, B: b, AGE: age, FLAG: flag, LIGHT: light})
            assert (by >= 0) is holds, (a, b, age, flag, light)


def test_it_is_the_slack_of_the_nearest_part() -> None:
    """Of a conjunction the least, of a disjunction the greatest; a strict comparison fails a unit earlier."""
    values: dict[Expr, Value] = {A: 1, B: 3}
    assert (2, MM) == at(A <= B, values)
    assert (1, MM) == at(A < B, values)
    assert (-3, MM) == at(B < A, values)
    assert (0, MM) == at((A <= B) & (B <= 3), values)
    assert (2, MM) == at((A <= B) | (B < A), values)
    assert (-2, MM) == at(A.eq(B), values)
    assert (1, MM) == at(A.ne(B), values)


def test_truth_values_enumerations_and_other_units_have_none() -> None:
    """They decide whether something is asked, and not how near it is; the unit is that of the last comparison."""
    values: dict[Expr, Value] = {A: 1, B: 3, AGE: 2, FLAG: False, LIGHT: 0}
    assert (None, MM) == at(FLAG.implies(A <= B), values)
    assert (2, MM) == at(FLAG.implies(A <= B), {**values, FLAG: True})
    assert (None, MM) == at((AGE <= 1).implies(A <= B), values)
    assert (None, MM) == at(LIGHT.eq(GREEN).implies(A <= B), values)
    assert (None, ONE) == at(FLAG, values)
    assert (-1, MS) == at(AGE <= 1, values)


def test_the_unit_is_that_of_what_is_hidden() -> None:
    """A law compares thousandths of its truth; what is told is in the unit of the truth, rounded down."""
    values: dict[Expr, Value] = {A: 1, B: 3, AGE: 1}
    assert (1997, MM) == at(A * 1000 <= B * 999, values)
    assert (1, MM) == at(A * 1000 <= B * 999, values, frozenset({A}))
    assert (-2, MM) == at(B * 999 <= A * 1000, values, frozenset({A}))
    assert (2, MM) == at((A <= B) & (AGE <= 1), values, frozenset({A}))


def test_it_grows_with_a_maximum_of_what_is_hidden() -> None:
    """If only a part is linear in the hidden variable, that part sets the scale."""
    assert (0, MM) == at(A * 10 <= maximum(B * 4, 0), {A: 1, B: 3}, frozenset({A, B}))


def test_a_past_operator_has_none() -> None:
    """It says nothing of a single step."""
    with pytest.raises(ModelError, match=r"^.* reads earlier steps; a distance is defined for a single step only\.$"):
        distance(previous(FLAG))
