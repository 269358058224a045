"""The work of terms is counted once for each operation and condition, by one set of terms as by many that share nodes."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from safeloc.codegen.merge_choices import chain
from safeloc.codegen.work_of_terms import Works, work
from safeloc.language.expr import boolean, ite, number
from safeloc.language.nodes import Expr
from safeloc.language.system import lower
from safeloc.language.terms import in_order
from safeloc.language.units import COUNT
from tests.random_machines import machines

X, Y = number("x", COUNT, -9, 9), number("y", COUNT, -9, 9)
A, B = boolean("a"), number("b", COUNT, 0, 9)


def test_work_counts_operations_and_conditions_once() -> None:
    """Two sums, and one condition that chooses twice."""
    moved = X + Y
    terms = [ite(A, moved, X), ite(A, moved - 1, Y)]
    assert work(terms) == Works()(terms) == 3


def test_the_usual_work_needs_no_row() -> None:
    """Of a chain of choices the conditions, here a comparison, and what is left, here a product; what a row gives is not computed."""
    works, sum_, difference = Works(), X + Y, X - Y
    assert works.usual(ite(A, X + Y, ite(B <= 3, X - Y, X * 2))).bit_count() == 2
    assert works.usual(sum_) == works.needs(sum_) != works.needs(difference)


@given(st.data())
def test_many_sets_have_the_work_of_each(data: st.DataObject) -> None:
    """In whatever order they are asked for."""
    system = lower(data.draw(machines()))
    terms: list[Expr] = [*system.next.values(), *system.fired.values(), *system.outputs.values()]
    works, nodes = Works(), in_order(terms)
    for some in data.draw(st.lists(st.lists(st.sampled_from(nodes), max_size=4), max_size=6)):
        assert works(some) == work(some)
    for term in terms:
        rows, last = chain(term)
        assert works.usual(term).bit_count() == work([last, *(condition for condition, _ in rows)])
