"""Terms under facts keep their value, and lose what the facts decide."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.codegen.simplify_under_facts import Known, implied
from safeloc.language.expr import abs_, boolean, choice, enumeration, floor_div, ite, maximum, members, minimum, number
from safeloc.language.interpret import evaluate, read_inputs, start
from safeloc.language.nodes import FALSE, TRUE, Bool, ChooseBool, Compare, Expr, Lit, Num, Value, Var
from safeloc.language.system import lower
from safeloc.language.terms import in_order
from safeloc.language.units import COUNT
from tests.random_machines import first_states, machines, records

RED, GREEN, BLUE = COLOURS = members("colour", "RED", "GREEN", "BLUE")
X, Y = number("x", COUNT, -9, 9), number("y", COUNT, -9, 9)
A, B = boolean("a"), boolean("b")
COLOUR = ite(A, RED, ite(B, GREEN, RED))


def drawn(data: st.DataObject) -> tuple[list[Expr], dict[Var, Value]]:
    """The terms of any machine, and values of what they read."""
    system = lower(data.draw(machines()))
    terms = [*system.next.values(), *system.fired.values(), *system.outputs.values()]
    return terms, {**start(system, data.draw(first_states(system))), **read_inputs(system, data.draw(records(system)))}


def true_facts(data: st.DataObject, terms: Sequence[Expr], known: Mapping[Var, Value]) -> dict[Expr, Expr]:
    """What some variables and conditions are."""
    candidates: list[Expr] = [*known, *(term for term in in_order(terms) if isinstance(term, Bool))]
    facts: dict[Expr, Expr] = {}
    for term in data.draw(st.lists(st.sampled_from(candidates), max_size=4)):
        (value,) = evaluate([term], known)
        facts[term] = Lit(value, term.unit) if isinstance(term, Num) else TRUE if value else FALSE
    return facts


@given(st.data())
def test_terms_under_true_facts_keep_their_value(data: st.DataObject) -> None:
    """On any machine and any inputs, folding under the values of some variables or conditions changes no value."""
    terms, known = drawn(data)
    facts = true_facts(data, terms, known)
    assert evaluate(terms, known) == evaluate(list(map(Known(facts), terms)), known)


@given(st.data())
def test_where_more_is_known_only_what_is_made_of_it_is_folded(data: st.DataObject) -> None:
    """And the same is left as where everything is folded anew, again and again."""
    terms, known = drawn(data)
    for _ in range(3):
        before = Known({})
        terms = list(map(before, terms))
        facts = true_facts(data, terms, known)
        anew, further = list(map(Known(facts), terms)), list(map(before.under(facts), terms))
        assert list(map(repr, anew)) == list(map(repr, further))
        assert evaluate(terms, known) == evaluate(further, known)
        terms = further


def test_facts_of_a_condition_are_those_of_its_parts() -> None:
    """Of a conjunction that holds and of a disjunction that fails, and of what is negated; not the other way round."""
    both, either = A & ~B, A | ~B
    assert (TRUE, FALSE) == (implied(both, True)[A], implied(both, True)[B])
    assert (FALSE, TRUE) == (implied(either, False)[A], implied(either, False)[B])
    assert [both] == list(implied(both, False))
    assert [either] == list(implied(either, True))
    assert Known(implied(either, False))(ite(A, X, ite(B, Y, X))) is Y


@pytest.mark.parametrize(
    ("left", "term"),
    [
        ("y", ite(A, X, Y)),
        ("y", ite(A & B, X, Y)),
        ("b", A | B),
        ("true", ~A),
        ("x", X + ite(A, X, 0)),
        ("x", X - ite(A, X, 0)),
        ("(+ x 7)", X + minimum(ite(A, X, 7), 9)),
        ("3", maximum(ite(A, X, 3), -3)),
        ("3", abs_(ite(A, X, -3))),
        ("-2", floor_div(ite(A, X, -3), 2)),
        ("6", ite(A, X, 3) * 2),
        ("x", maximum(ite(A, Y, X), X)),
        ("true", ite(A, X, 3) <= 3),
        ("false", ite(A, Y, X) < X),
        ("true", ite(A, Y, X).eq(X)),
        ("x", ite(B, X, ite(A, Y, X))),
        ("7", ite(B, 7, ite(A, Y, 7))),
        ("b", ChooseBool(A, ~B, B)),
        ("false", COLOUR.eq(BLUE)),
        ("(== (ite b GREEN RED) GREEN)", COLOUR.eq(GREEN)),
    ],
    ids=repr,
)
def test_what_a_fact_decides_is_gone(left: str, term: Expr) -> None:
    """What is left where `a` is known to be false."""
    assert left == repr(Known({A: FALSE})(term))
    before = Known({})
    folded = before(term)
    assert left == repr(before.under({A: FALSE})(folded))


def test_terms_that_no_fact_touches_stay_the_same_node() -> None:
    """Shared parts stay shared, and nothing is rebuilt without need."""
    term = ite(B, X + Y, X - Y)
    known = Known({A: TRUE})
    assert known(term) is term
    assert known(ite(A, term, 0)) is term


def test_sums_and_distances_are_the_same_from_either_side() -> None:
    """x + y and y + x become one node, |x - y| and |y - x| as well."""
    known = Known({})
    assert known(abs_(X - Y)) is known(abs_(Y - X)) is known(abs_(X - Y))
    assert known(X - Y) is not known(Y - X)
    assert known(X + Y) is known(Y + X)


def test_a_condition_can_be_known_as_well() -> None:
    """A fact may be about any term, such as a comparison."""
    colour = choice("colour", enumeration(COLOURS))
    red = colour.eq(RED)
    assert isinstance(red, Compare)
    assert Known({red: TRUE})(ite(red, X, Y)) is X
