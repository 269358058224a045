"""Every operator and folding rule, and every node kind rewritten: each means the same as plain Python."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product as pairs
from typing import get_args

import pytest

from safeloc.errors import PropertyError, UnitError
from safeloc.language.expr import (
    FALSE,
    TRUE,
    Bool,
    Expr,
    Var,
    before,
    boolean,
    floor_div,
    ite,
    maximum,
    minimum,
    number,
    optional,
    product,
    was,
)
from safeloc.language.interpret import evaluate, holds
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.nodes import BoolNode, NumNode
from safeloc.language.spec import always, earlier_bool, earlier_num, observe
from safeloc.language.system import lower
from safeloc.language.terms import CHILDREN, Substitution, variables
from safeloc.language.units import MM

X, Y, P, Q = number("x", MM, -9, 9), number("y", MM, -9, 9), boolean("p"), boolean("q")
U, V, R, S = number("u", MM, -9, 9), number("v", MM, -9, 9), boolean("r"), boolean("s")
FORMS: dict[str, tuple[Expr, str]] = {
    "reflected sum": (3 + X, "3 + x"),
    "reflected difference": (3 - X, "3 - x"),
    "negation": (-X, "-x"),
    "reflected product": (3 * X, "3 * x"),
    "product of variables": (product(X, Y), "x * y"),
    "adding nothing": (0 + X + 0 - 0, "x"),
    "division": (floor_div(X, 4), "x // 4"),
    "division by one": (floor_div(X, 1), "x"),
    "smaller": (minimum(X, Y), "min(x, y)"),
    "greater": (maximum(X, 2), "max(x, 2)"),
    "at least": (X >= Y, "x >= y"),
    "more than": (X > 2, "x > 2"),
    "different": (X.ne(Y), "x != y"),
    "one of": (X.one_of(1, Y, 5), "x in (1, y, 5)"),
    "reflected and": (True & P, "p"),
    "reflected or": (False | P, "p"),
    "and false": (P & False, "False"),
    "or true": (P | True, "True"),
    "not not": (~~P, "p"),
    "implies": (P.implies(Q), "(not p) or q"),
    "same truth": (P.iff(Q), "p == q"),
    "choice": (ite(P, X, Y), "x if p else y"),
    "choice of truth": (ite(P, Q, X > 0), "q if p else x > 0"),
    "choice with true": (ite(P, True, Q), "True if p else q"),
    "choice with false": (ite(P, False, Q), "False if p else q"),
    "choice or true": (ite(P, Q, True), "q if p else True"),
    "choice or false": (ite(P, Q, False), "q if p else False"),
    "fixed choice": (ite(True, X, Y), "x"),
    "other fixed choice": (ite(FALSE, X, 4), "4"),
    "fixed choice of truth": (ite(TRUE, P, Q), "p"),
}


@pytest.mark.parametrize("name", FORMS)
def test_forms_mean_what_python_means(name: str) -> None:
    """The term and its rewriting to other variables have Python's value, at every corner."""
    term, python = FORMS[name]
    renamed = Substitution({X: U, Y: V, P: R, Q: S})(term)
    for x, y, p, q in pairs((-9, -1, 0, 1, 3, 9), (-9, 0, 1, 9), (False, True), (False, True)):
        expected = eval(python, {"x": x, "y": y, "p": p, "q": q})
        assert evaluate([term], {X: x, Y: y, P: p, Q: q}) == [expected]
        assert evaluate([renamed], {U: x, V: y, R: p, S: q}) == [expected]


def test_absent_values_have_a_stand_in() -> None:
    """value_or reads the value only where it is present."""
    reading = optional("reading", MM, 1, 9)
    term = reading.value_or(-1)
    assert evaluate([term], {reading.present: False, reading.value: 1}) == [-1]
    assert evaluate([term], {reading.present: True, reading.value: 7}) == [7]


A, B = modes("A", "B")
N, LIT = number("n", MM, 0, 9), boolean("lit")
SYSTEM = lower(Machine("m", (A, B), [X, P], {N: 0, LIT: False}, {}, [Transition("go", A, B, P, {N: 5, LIT: True})]))


def test_earlier_reads_the_state_before() -> None:
    """earlier_* turn each variable of a term into its value before the step."""
    num, flag = earlier_num(N + 1), earlier_bool(LIT & (N > 2))
    twins: dict[str, Var] = {var.name: var for term in (num, flag) for var in variables([term])}
    assert sorted(twins) == ["before.lit", "before.n"]
    assert twins["before.n"].before is N
    assert twins["before.lit"].before is LIT


def test_only_state_has_a_value_before() -> None:
    """An input has no value before the step that a property could read."""
    with pytest.raises(PropertyError, match=r"reads 'before\.x', but before\(\) and was\(\) are for state variables"):
        observe(SYSTEM, always("strange", before(X) > 0))


def test_a_term_holds_or_not() -> None:
    """holds() is the truth value of a term as Python has it."""
    values = {X: 1}
    term: Bool = X > 0
    assert holds(term, values) is True
    assert holds(~term, values) is False


def test_every_kind_of_node_says_what_it_is_made_of() -> None:
    """The table that terms are taken apart by has the closed set of kinds, and no other."""
    assert {*get_args(NumNode), *get_args(BoolNode)} == set(CHILDREN)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (
            lambda: boolean("b") & number("n", MM, 0, 9) <= 3,
            r"bind tighter than comparisons: put the comparison in brackets",
        ),
        (
            lambda: number("n", MM, 0, 9) & boolean("b"),
            "got NumVar n. & and | bind tighter than comparisons: put the comparison in brackets",
        ),
        (lambda: 3 & number("n", MM, 0, 9), "expected a truth value or a Bool term, got NumVar n. & and | bind"),
        (lambda: number("n", MM, 0, 9) | 3, "expected a truth value or a Bool term, got NumVar n. & and | bind"),
        (lambda: ~number("n", MM, 0, 9), "expected a truth value or a Bool term, got NumVar n"),
        (lambda: was(number("n", MM, 0, 9)), r"was\(\.\.\.\) is for truth values; write before\(n\) for a number"),
        (lambda: before(boolean("b")), r"before\(\.\.\.\) is for numbers; write was\(b\) for a truth value"),
        (lambda: before(3), r"write was\(x\) for a truth value"),
    ],
)
def test_common_mistakes_are_told_with_the_remedy(wrong: Callable[[], object], message: str) -> None:
    """With file and line of the user's own code."""
    with pytest.raises(UnitError, match=rf"test_expr_forms\.py:\d+: .*{message}"):
        wrong()
