"""The falsifier: it finds deep bugs, every finding replays, and machines without a bug are never violated."""

from __future__ import annotations

import pytest

from benchmarks.deep_bugs import DEEP_BUGS, DeepBug
from safeloc.language.spec import observe
from safeloc.language.verdict import Unknown, Violated
from safeloc.proof.provers.falsify import falsify
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.replayed_evidence import replayed
from tests.examples import EXAMPLES, Example

QUICK = ("off by one in the tolerance", "growth is halved after 70 steps", "an answer one step late")


def _found(bug: DeepBug) -> None:
    verdict = falsify(bug.goal, Limits(seconds=30))
    assert isinstance(verdict, Violated)
    assert verdict.trace is not None
    assert len(verdict.trace.steps) >= bug.depth
    again = replayed(bug.goal, verdict.trace.initial, verdict.trace.stream())
    assert again is not None
    assert len(again.steps) == len(verdict.trace.steps)


@pytest.mark.parametrize("bug", [bug for bug in DEEP_BUGS if bug.name in QUICK], ids=lambda bug: bug.name)
def test_deep_bugs_are_found(bug: DeepBug) -> None:
    """A bug 41 to 101 steps deep is found within the time limit, and its stream replays exactly."""
    _found(bug)


@pytest.mark.slow
@pytest.mark.parametrize("bug", [bug for bug in DEEP_BUGS if bug.name not in QUICK], ids=lambda bug: bug.name)
def test_all_deep_bugs_are_found(bug: DeepBug) -> None:
    """The whole set of bugs is found, up to 201 steps deep."""
    _found(bug)


@pytest.mark.thorough(ordinary=4)
@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example.name)
def test_examples(example: Example) -> None:
    """A false property is violated; a true one never is."""
    assert isinstance(falsify(observe(example.system, example.fails), Limits(seconds=10)), Violated)
    assert isinstance(falsify(observe(example.system, example.holds), Limits(seconds=0.3)), Unknown)
