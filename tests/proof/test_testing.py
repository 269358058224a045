"""Property tests for any machine: false properties are violated by a run that replays, true ones are held, also after
faults.
"""

from __future__ import annotations

import unittest

import hypothesis
import pytest

from benchmarks.deep_bugs import DEEP_BUGS
from safeloc.language.spec import observe
from safeloc.language.system import lower
from safeloc.language.verdict import Held, Violated
from safeloc.proof.provers.replayed_evidence import replayed
from safeloc.proof.testing import PHASES, PropertyBroken, run_tests, state_machine_test
from tests.examples import EXAMPLES, Example

BRIEF = hypothesis.settings(
    max_examples=60, stateful_step_count=8, deadline=None, database=None, derandomize=True, phases=PHASES
)


@pytest.mark.thorough(ordinary=2)
@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example.name)
def test_what_fails_is_found_and_what_holds_is_held(example: Example) -> None:
    """Of two properties tested together, the false one is violated by a run that replays; the true one is held."""
    held, broken = run_tests(example.system, [example.holds, example.fails], examples=60, steps=40, seed=0)
    assert isinstance(held.result, Held)
    assert isinstance(broken.result, Violated)
    trace = broken.result.trace
    assert trace is not None
    assert len(trace.steps) >= example.fails_depth
    assert replayed(observe(example.system, example.fails), trace.initial, trace.stream()) is not None


def _errors(example: Example, *, fails: bool) -> list[str]:
    prop = example.fails if fails else example.holds
    result = unittest.TestResult()
    state_machine_test(example.system, [prop], settings=BRIEF)("runTest").run(result)
    assert result.testsRun == 1
    return [text for _, text in [*result.failures, *result.errors]]


def test_the_class_passes_or_fails_as_unittest_runs_it() -> None:
    """The class that pytest collects passes for a true property and shows the run for a false one."""
    assert _errors(EXAMPLES[0], fails=False) == []
    (text,) = _errors(EXAMPLES[0], fails=True)
    assert PropertyBroken.__name__ in text
    assert EXAMPLES[0].fails.statement in text


@pytest.mark.thorough
@pytest.mark.parametrize("seed", [0, *(pytest.param(n, marks=pytest.mark.slow) for n in (1, 2, 3, 4))])
def test_a_forgotten_remainder_is_found_with_every_seed(seed: int) -> None:
    """Draws lean to the ends of the error law: uniform ones find this bug in no run."""
    (bug,) = [bug for bug in DEEP_BUGS if bug.name == "a remainder is forgotten"]
    (finding,) = run_tests(lower(bug.machine), [bug.prop], examples=200, steps=120, seed=seed)
    assert isinstance(finding.result, Violated)


def test_statistics_are_reported() -> None:
    """A held property comes with the runs, steps, deepest run and fired transitions; few steps are given up."""
    example = EXAMPLES[0]
    (finding,) = run_tests(example.system, [example.holds], examples=60, steps=40, seed=0)
    assert isinstance(finding.result, Held)
    notes = finding.result.notes
    assert int(notes["steps"]) >= int(notes["deepest run"]) > 40
    assert int(notes["steps given up"]) < 0.05 * int(notes["steps"])
    assert "run on" in notes["transitions fired"]
