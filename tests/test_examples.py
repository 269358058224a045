"""What every other test relies on: each example's properties hold and fail as its entry says."""

from __future__ import annotations

import typing

import pytest

from safeloc.language.machine import ANY
from safeloc.language.nodes import Node
from safeloc.language.spec import observe
from safeloc.language.terms import in_order
from safeloc.language.verdict import Proved, Violated
from safeloc.proof.provers.bmc import bmc
from safeloc.proof.provers.kinduction import kinduction
from safeloc.proof.provers.limits import Limits
from tests.examples import EXAMPLES, Example

LIMITS = Limits(depth=12, seconds=20)
every_example = pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example.name)


@every_example
def test_what_holds_is_proved(example: Example) -> None:
    """The first property is proved for all streams."""
    assert isinstance(kinduction(observe(example.system, example.holds), LIMITS), Proved)


@every_example
def test_what_fails_fails_after_that_many_steps(example: Example) -> None:
    """The second property has a shortest violation of the given length."""
    verdict = bmc(observe(example.system, example.fails), LIMITS)
    assert isinstance(verdict, Violated)
    assert verdict.trace is not None
    assert example.fails_depth == len(verdict.trace.steps)


def test_the_list_uses_the_whole_language() -> None:
    """Every kind of node, optional inputs, ghosts, an assumption, an open first value and a composition appear."""
    systems = [example.system for example in EXAMPLES]
    terms = [term for system in systems for term in (*system.next.values(), *system.outputs.values(), system.assume)]
    terms += [term for example in EXAMPLES for term in (example.holds.term, example.fails.term)]
    assert set(typing.get_args(Node)) == {type(node) for node in in_order(terms)}
    assert any(system.optionals for system in systems)
    assert any(system.ghosts for system in systems)
    assert any(first is ANY for system in systems for first in system.initial.values())
    assert any(len(example.machines) > 1 for example in EXAMPLES)
    assert {"always", "within"} == {prop.kind for example in EXAMPLES for prop in (example.holds, example.fails)}


def test_names_are_distinct() -> None:
    """Examples are told apart by name."""
    assert len(EXAMPLES) == len({example.name for example in EXAMPLES})
