"""Rewritten terms keep their value, and name a value once where a chain named it again and again."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from safeloc.codegen.merge_choices import is_magnitude, merged
from safeloc.language.expr import Expr, Num, abs_, boolean, ite, maximum, number
from safeloc.language.interpret import evaluate, read_inputs, start
from safeloc.language.system import lower
from safeloc.language.units import COUNT
from tests.random_machines import first_states, machines, records

X, Y = number("x", COUNT, -9, 9), number("y", COUNT, -9, 9)
A, B, C = boolean("a"), boolean("b"), boolean("c")


@given(st.data())
def test_merged_terms_have_the_same_value(data: st.DataObject) -> None:
    """On any machine and any inputs, rewriting changes no value."""
    system = lower(data.draw(machines()))
    terms = [*system.next.values(), *system.fired.values()]
    known = {**start(system, data.draw(first_states(system))), **read_inputs(system, data.draw(records(system)))}
    assert evaluate(terms, known) == evaluate(merged(terms), known)


def test_neighbouring_choices_of_one_value_become_one() -> None:
    """A value that rows before or after name again is chosen once."""
    before: list[Expr] = [
        ite(A, X, ite(B, X, Y)),
        ite(A, X, ite(B, Y, X)),
        ite(A, C, ite(B, C, ~C)),
        ite(A, X, ite(B, Y, 0)),
    ]
    after = [
        "(ite (or a b) x y)",
        "(ite (and (not a) b) y x)",
        "(or (and (or a b) c) (and (not (or a b)) (not c)))",
        "(ite a x (ite b y 0))",
    ]
    assert after == [repr(term) for term in merged(before)]


def test_a_table_that_mostly_leaves_a_variable_alone_needs_one_choice() -> None:
    """Five rows of which one sets the variable."""
    flags = [boolean(f"f{row}") for row in range(5)]
    chain: Num = X
    for row, flag in enumerate(flags):
        chain = ite(flag, Y if row == 2 else X, chain)
    assert repr(merged([chain])[0]).count("ite") == 1


def test_magnitudes_are_recognized() -> None:
    """Only what `abs_` builds is a magnitude."""
    assert is_magnitude(abs_(X))
    assert not is_magnitude(maximum(X, -Y))
    assert not is_magnitude(maximum(-X, X))
    assert not is_magnitude(maximum(X, 1 - X))
