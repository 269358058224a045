"""The normal form of the checker's terms: what it decides without a solver, it decides rightly."""

from __future__ import annotations

from itertools import product
from operator import eq, ge, le, lt

import pytest

from safeloc.checker.dag import BOOL, INT, Dag

VALUES = (-(10**30), -1, 0, 1, 2, 10**30)


@pytest.mark.parametrize(("operator", "right"), [("<", lt), ("<=", le), (">=", ge), ("=", eq)])
def test_two_numbers_are_compared(operator: str, right: object) -> None:
    """Whatever their size; the result is the truth value itself."""
    assert callable(right)
    dag = Dag()
    for one, other in product(VALUES, VALUES):
        assert dag.truth[right(one, other)] == dag.make(operator, [dag.number(one), dag.number(other)])


@pytest.mark.parametrize("operator", ["<", "<=", ">=", "="])
def test_a_comparison_of_a_variable_stays(operator: str) -> None:
    """Also with itself, and of two truth values: nothing is decided that was not looked at."""
    dag = Dag()
    level, flag = dag.variable("level", INT), dag.variable("flag", BOOL)
    for pair in ([level, dag.number(3)], [dag.number(3), level], [level, level], [flag, dag.truth[True]]):
        assert operator == dag.nodes[dag.make(operator, pair)][0]


def test_what_is_compared_decides_a_choice() -> None:
    """As in the prover: a verdict that is chosen first and compared later."""
    dag = Dag()
    level = dag.variable("level", INT)
    missing = dag.make("=", [dag.number(0), dag.number(1)])
    assert dag.number(7) == dag.make("ite", [missing, level, dag.number(7)])
