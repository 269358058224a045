"""z3 terms translated back keep their meaning."""

from __future__ import annotations

import pytest
import z3
from hypothesis import given
from hypothesis import strategies as st

from safeloc.language.expr import BoolVar, NumVar, Var
from safeloc.language.interpret import holds
from safeloc.language.units import ONE
from safeloc.proof.provers.z3_to_terms import UnreadableError, read_bool

X, Y, P = NumVar("x", ONE, -50, 50), NumVar("y", ONE, -50, 50), BoolVar("p")
NAMES: dict[str, Var] = {"x": X, "y": Y, "p": P}
x, y, p = z3.Int("x"), z3.Int("y"), z3.Bool("p")

TERMS = [
    z3.And(x <= y, z3.Or(p, x > 3), z3.Not(y >= 4)),
    z3.Implies(p, x == y),
    p == (x < 0),
    z3.If(p, x, y) == 2 * x - y,
    z3.If(p, x < 1, y < 1),
    3 - x < y,
    0 - x <= -y,
    x / 3 == y % 4,
]


@pytest.mark.parametrize("term", TERMS, ids=str)
@given(left=st.integers(-50, 50), right=st.integers(-50, 50), flag=st.booleans())
def test_a_term_read_back_has_the_same_value(term: z3.BoolRef, left: int, right: int, flag: bool) -> None:
    """z3 and the interpreter agree on every operator that Spacer uses."""
    values = [(x, z3.IntVal(left)), (y, z3.IntVal(right)), (p, z3.BoolVal(flag))]
    expected = z3.is_true(z3.simplify(z3.substitute(term, *values)))
    assert holds(read_bool(term, NAMES), {X: left, Y: right, P: flag}) == expected


@pytest.mark.parametrize(
    "term", [x / y == 1, z3.ToReal(x) > 0, z3.Int("unknown") == 0, z3.Exists([y], y == x)], ids=str
)
def test_what_the_language_does_not_have_is_refused(term: z3.BoolRef) -> None:
    """Division by a variable, reals, unknown names and quantifiers are refused, not guessed."""
    with pytest.raises(UnreadableError):
        read_bool(term, NAMES)
