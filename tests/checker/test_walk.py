"""Generated steps give what the interpreter gives."""

from __future__ import annotations

import random

import pytest

from safeloc.catalogue import load_target
from safeloc.checker.dag import Dag
from safeloc.checker.terms import Translation
from safeloc.checker.walk import computed
from safeloc.language.expr import BoolVar, Var
from safeloc.language.interpret import evaluate
from safeloc.language.nodes import Value
from safeloc.language.system import environment


@pytest.mark.parametrize("name", ["odometry", "fibre_area", "sections"])
def test_computed_terms_are_those_of_the_interpreter(name: str) -> None:
    """Of every move, output and assumption, at the ends of all ranges and between."""
    system, draw, write = load_target(name).system, random.Random(7), Translation(Dag())
    terms = [*system.next.values(), *system.fired.values(), *system.outputs.values(), environment(system)]
    known = (*system.state, *system.inputs)
    function = computed(write.dag, list(map(write, known)), list(map(write, terms)))
    for _ in range(20):
        values = {var: _value(var, draw) for var in known}
        assert evaluate(terms, values) == list(function(list(values.values())))


def _value(var: Var, draw: random.Random) -> Value:
    if isinstance(var, BoolVar):
        return draw.random() < 0.5
    return draw.choice((var.low, var.high, draw.randint(var.low, var.high)))
