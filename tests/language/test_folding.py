"""Simplification of terms in which constants decide parts."""

from __future__ import annotations

import pytest

from safeloc.language.expr import FALSE, TRUE, Bool, Expr, Lit, Var, as_num, boolean, ceil_div, ite, maximum, number
from safeloc.language.folding import Folding, settled
from safeloc.language.spec import once
from safeloc.language.terms import Substitution, in_order
from safeloc.language.units import COUNT

P, Q, TOLD, SAID = (boolean(name) for name in ("p", "q", "told", "said"))
X, HEARD = number("x", COUNT, 0, 10), number("heard", COUNT, 0, 10)
WIRES: dict[Var, Expr] = {HEARD: as_num(3, COUNT), TOLD: TRUE, SAID: FALSE}


def left(term: Bool) -> Bool:
    """Return the rest of a term after wires replace its variables by 3, true and false."""
    return settled(Substitution(WIRES).bool(term))


@pytest.mark.parametrize(
    ("term", "expected"),
    [
        (HEARD.eq(3), "true"),
        (ceil_div(HEARD, 2) - HEARD > 2, "false"),
        (P | (maximum(HEARD, 5) < 5), "p"),
        (ite(P, HEARD.eq(3), Q), "(or p q)"),
        (ite(P, Q, HEARD.ne(3)), "(and p q)"),
        (ite(HEARD.eq(3), P, Q), "p"),
        (ite(HEARD.eq(2), X, HEARD).eq(3), "true"),
        (ite(P, X, HEARD).eq(3), "(== (ite p x 3) 3)"),
        (TOLD.implies(P) & SAID.implies(Q), "p"),
        (TOLD.iff(P), "p"),
        (SAID.iff(P), "(not p)"),
        (HEARD + X < 5, "(< (+ 3 x) 5)"),
        (once(SAID) | P, "(or (once false) p)"),
    ],
)
def test_what_no_variable_decides_is_worked_out(term: Bool, expected: str) -> None:
    """Comparisons of constants, choices by them and between them, and connectives; the past is left as it is."""
    assert expected == repr(left(term))


@pytest.mark.parametrize(
    ("term", "expected"),
    [
        (ite(P, X, as_num(3, COUNT)).eq(4), "false"),
        (ite(ite(P, X, as_num(3, COUNT)) <= 3, Q, P), "q"),
        (ite(P, X, as_num(3, COUNT)) < X, "(< 3 x)"),
        (ite(Q, X, as_num(3, COUNT)).eq(4), "(== (ite q x 3) 4)"),
    ],
)
def test_a_known_truth_value_decides_what_is_compared(term: Bool, expected: str) -> None:
    """A choice that it decides may leave two constants to be compared, and the result decides further choices."""
    assert expected == repr(Folding({P: FALSE})(term))


def test_what_variables_decide_stays_the_same_node() -> None:
    """So that terms stay shared."""
    term = ite(P, X, as_num(3, COUNT)).eq(4) | (X < 5)
    assert term is settled(term)


def test_constants_keep_their_unit() -> None:
    """Evaluated numbers keep their units, so that they can still be compared."""
    term = left(X < HEARD + HEARD)
    assert "(< x 6)" == repr(term)
    assert [COUNT] == [node.unit for node in in_order([term]) if isinstance(node, Lit)]
