"""Runs of a composition that are searched machine by machine: what is found is a run, and "none" is said only where there is none."""

from __future__ import annotations

import pytest
import z3

from benchmarks.composed_line import composed_target
from safeloc.codegen.smt import Unrolling
from safeloc.language.expr import NumVar
from safeloc.language.spec import Goal, observe, reachable
from safeloc.proof.provers import deepening
from safeloc.proof.provers.asking import new_solver
from safeloc.proof.provers.bmc import Exhausted, search
from safeloc.proof.provers.deepening import Deepening
from safeloc.proof.provers.limits import Limits, deadline
from safeloc.proof.provers.machine_by_machine import run_by_machines


@pytest.fixture(scope="module")
def line() -> Goal:
    """An occupied line of four sections is freed: every machine has its part in the run, of three steps."""
    target = composed_target(31)
    return observe(target.system, target.properties[-1])


def asked(goal: Goal, steps: int) -> z3.ModelRef | str:
    """What is found of runs of so many steps, the shorter ones being in vain."""
    runs = Deepening(Unrolling(goal.system), new_solver())
    for _ in range(steps):
        runs.deeper(goal.good)
    return run_by_machines(goal.system, [*runs._solver.assertions(), runs.fails(goal.good)], deadline(60))


def test_a_run_is_found(line: Goal) -> None:
    """Heads and sections one after the other, each given those before it: the interpreter makes the same run."""
    assert isinstance(asked(line, 3), z3.ModelRef)


@pytest.mark.parametrize("steps", [0, 1, 2])
def test_there_is_none(line: Goal, steps: int) -> None:
    """No shorter run frees the line: the conditions on all machines contradict each other, with nothing given."""
    assert asked(line, steps) == "none"


def test_none_is_said_only_of_all_machines(line: Goal, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where values of machines before were given, no answer is no proof that there is no run."""
    monkeypatch.setattr("safeloc.proof.provers.machine_by_machine._AGAIN", (0,))
    assert asked(line, 2) == "unknown"


def test_the_search_goes_on_machine_by_machine(line: Goal, monkeypatch: pytest.MonkeyPatch) -> None:
    """With no time for the whole, the same event is reached, and what no run reaches is searched to the depth limit."""
    monkeypatch.setattr(deepening, "SOON_S", 1e-6)
    found = search(line, Limits(depth=5))
    assert not isinstance(found, Exhausted)
    assert 3 == len(found.steps)
    least = next(var for var in line.original.state if var.name == "section_1.least")
    assert isinstance(least, NumVar)
    never = observe(line.original, reachable("less than nothing", least < 0))
    assert isinstance(search(never, Limits(depth=2)), Exhausted)
