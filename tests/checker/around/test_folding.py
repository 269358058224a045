"""Folded terms have the value of the term, wherever the variables are within their bounds."""

from __future__ import annotations

from hypothesis import given, settings
from hypothesis import strategies as st

from safeloc.checker.around.folding import Folding
from safeloc.checker.dag import BOOL, INT, Dag
from safeloc.checker.terms import Translation
from safeloc.checker.walk import computed
from safeloc.language.expr import BoolVar, NumVar
from safeloc.language.system import lower, without_ghosts
from tests.random_machines import machines


@given(st.data())
@settings(max_examples=30, deadline=None)
def test_a_folded_term_has_the_same_value(data: st.DataObject) -> None:
    """All next values of a random machine, with bounds drawn for each variable."""
    system = without_ghosts(lower(data.draw(machines(most_terms=12))))
    write = Translation(Dag())
    folding, replaced, values = Folding(write.dag), dict[int, int](), dict[int, int | bool]()
    for var in (*system.state, *system.inputs):
        if isinstance(var, BoolVar):
            replaced[write(var)] = made = folding.variable(f"{var.name}@0", BOOL, None)
            values[made] = data.draw(st.booleans())
        else:
            assert isinstance(var, NumVar)
            low, high = sorted(data.draw(st.tuples(*[st.integers(var.low, var.high)] * 2)))
            value = data.draw(st.integers(low, high))
            single = low == high
            made = folding.number(low) if single else folding.variable(f"{var.name}@0", INT, (low, high))
            replaced[write(var)] = made
            if not single:
                values[made] = value
    terms = list(map(write, system.next.values()))
    own = {node: values.get(replaced[node], folding.bounds.get(replaced[node], (0, 0))[0]) for node in replaced}
    expected = computed(write.dag, list(own), terms)(list(own.values()))
    replacing = folding.replacing(replaced)
    folded = [replacing(term) for term in terms]
    assert expected == computed(write.dag, list(values), folded)(list(values.values()))
    for term, value in zip(folded, expected, strict=True):
        if term in folding.bounds:
            assert folding.bounds[term][0] <= value <= folding.bounds[term][1]


def made(low: int, high: int) -> tuple[Folding, int]:
    """A variable x with bounds."""
    folding = Folding(Dag())
    return folding, folding.variable("x", INT, (low, high))


def test_comparisons_that_bounds_decide_are_gone() -> None:
    """What does not follow from the bounds stays."""
    folding, x = made(3, 5)
    truth = folding.dag.truth
    assert truth[True] == folding.make("<=", [x, folding.number(5)])
    assert truth[False] == folding.make("<", [x, folding.number(3)])
    assert folding.make("<=", [x, folding.number(4)]) not in truth.values()


def test_equal_parts_of_a_sum_cancel() -> None:
    """x + 2 is above x, however wide the bounds."""
    folding, x = made(-10_000, 10_000)
    assert folding.dag.truth[True] == folding.make("<", [x, folding.make("+", [x, folding.number(2)])])
