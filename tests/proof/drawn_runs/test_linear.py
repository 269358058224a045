"""Values that a linear disjunction allows: exact, whatever slopes the other values give."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from safeloc.language.expr import Bool, Var, any_of, boolean, ite, maximum, number
from safeloc.language.interpret import evaluate
from safeloc.language.nodes import Expr
from safeloc.language.terms import children, in_order
from safeloc.language.units import MM
from safeloc.proof.drawn_runs.linear import straight_of

X, Y, FLAG = number("x", MM, -40, 40), number("y", MM, -40, 40), boolean("flag")


def _below(term: Bool) -> dict[Expr, frozenset[Var]]:
    found: dict[Expr, frozenset[Var]] = {}
    for node in in_order([term]):
        found[node] = (frozenset([node]) if isinstance(node, Var) else frozenset[Var]()).union(
            *(found[part] for part in children(node))
        )
    return found


@given(
    slope=st.integers(-4, 4),
    offset=st.integers(-40, 40),
    kind=st.sampled_from(["<", "<=", "==", "!="]),
    y=st.integers(-40, 40),
    flag=st.booleans(),
)
def test_every_comparison_is_exact(slope: int, offset: int, kind: str, y: int, flag: bool) -> None:
    """Also with a slope of 0 and where the condition of a choice decides on it."""
    left = ite(FLAG, slope * X, 2 * X) + Y
    compared = {"<": left < offset, "<=": left <= offset, "==": left.eq(offset), "!=": left.ne(offset)}[kind]
    term = any_of([compared, X > 35, (Y < -30) & FLAG])
    straight = straight_of(X, term, _below(term))
    assert straight is not None
    values = {X: 7, Y: y, FLAG: flag}
    found = straight.segments(evaluate(straight.parts, values), 0, 7, (X.low, X.high))
    assert [n for low, high in found for n in range(low, high + 1)] == [
        n for n in range(-40, 41) if evaluate([term], {**values, X: n})[0]
    ]


def test_what_turns_along_the_variable_is_not_linear() -> None:
    for term in (maximum(X, Y) < 3, ite(X < 2, X, Y) < 3, ~((X < 2) & FLAG)):
        assert straight_of(X, term, _below(term)) is None
