"""Terms are walked as they were written."""

from __future__ import annotations

from safeloc.language.expr import boolean
from safeloc.language.nodes import TRUE, And
from safeloc.language.terms import conjuncts

A, B, C = boolean("a"), boolean("b"), boolean("c")


def test_the_parts_of_a_conjunction_come_in_order() -> None:
    """Those of conjunctions within it too; a disjunction is a part, and so is the whole where it is no conjunction."""
    assert [A, B, C] == list(conjuncts((A & B) & C)) == list(conjuncts(And((A, And((B, C))))))
    either = A | B
    assert [either, C] == list(conjuncts(either & C))
    assert [A] == list(conjuncts(A))
    assert [TRUE] == list(conjuncts(TRUE))
