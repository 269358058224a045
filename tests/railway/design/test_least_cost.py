"""Selections of least cost, and their lower bounds, against all selections there are."""

from __future__ import annotations

import random
from fractions import Fraction
from itertools import chain, combinations

import pytest

from safeloc.railway.design.least_cost import Demand, bound, least, none_cheaper, weights

COSTS = (3, 5, 2, 7, 4, 4)


def demands(seed: int) -> list[Demand]:
    """Some demands on six options."""
    draw = random.Random(seed)
    options = range(len(COSTS))
    return [
        Demand(frozenset(draw.sample(options, draw.randint(1, 3))), frozenset(draw.sample(options, draw.randint(0, 2))))
        for _ in range(draw.randint(3, 9))
    ]


def every_selection() -> list[frozenset[int]]:
    """All selections of six options."""
    options = range(len(COSTS))
    return [frozenset(one) for one in chain.from_iterable(combinations(options, n) for n in range(len(COSTS) + 1))]


def cost(selection: frozenset[int]) -> int:
    """The cost of a selection."""
    return sum(COSTS[number] for number in selection)


@pytest.mark.parametrize("seed", range(12))
def test_no_selection_is_cheaper(seed: int) -> None:
    """The selection satisfies the demands, and none of all 64 that do costs less; the weights never promise more than it costs."""
    asked = demands(seed)
    fitting = [one for one in every_selection() if all(each.holds(one) for each in asked)]
    found = least(COSTS, asked)
    assert found is not None
    assert found in fitting
    assert min(map(cost, fitting)) == cost(found)
    weighted = weights(COSTS, asked)
    assert bound(COSTS, weighted) <= cost(found)


def test_what_no_selection_meets() -> None:
    """An option that is asked for and forbidden."""
    assert least(COSTS, [Demand(frozenset([0])), Demand(frozenset(), frozenset([0]))]) is None


def test_weights_add_up_to_the_cost_of_two_separate_demands() -> None:
    """Two demands without a common option cost their cheapest options, and the weights show it."""
    asked = [Demand(frozenset([0, 1])), Demand(frozenset([2, 3]))]
    assert bound(COSTS, weights(COSTS, asked)) == 5 == cost(least(COSTS, asked) or frozenset())


def test_weights_may_be_wrong_but_no_bound_is() -> None:
    """Any weights give a bound; weights that ask for more than options cost only make it less. Negative ones are refused."""
    asked = [Demand(frozenset([0])), Demand(frozenset([1]), frozenset([0]))]
    for heavy in (Fraction(1), Fraction(4), Fraction(100)):
        assert bound(COSTS, dict.fromkeys(asked, heavy)) <= 8
    with pytest.raises(ValueError, match="negative"):
        bound(COSTS, {asked[0]: Fraction(-1)})


def test_a_gap_is_closed_by_proof() -> None:
    """Three options of which any two demands share one: the weights reach one and a half options, the provers two."""
    pairs = [Demand(frozenset(pair)) for pair in ((0, 1), (1, 2), (0, 2))]
    alike = (2, 2, 2)
    assert bound(alike, weights(alike, pairs)) == 3
    assert none_cheaper(alike, pairs, 4, 10.0)
    assert not none_cheaper(alike, pairs, 5, 10.0)


def test_without_options_there_is_one_selection() -> None:
    """The empty one: it satisfies a demand that holds unless an option is chosen, and none for an option."""
    idle, asked = Demand(frozenset(), frozenset({0})), Demand(frozenset({0}), frozenset())
    assert least([], []) == frozenset()
    assert least([], [idle]) == frozenset()
    assert least([], [idle, asked]) is None
    assert weights([], [asked]) == {}
