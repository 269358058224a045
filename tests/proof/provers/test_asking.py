"""Limits are counted by solvers, not by the clock: a busy machine decides what an idle one does."""

import time

import pytest
import z3

from safeloc.codegen.smtlib import Query
from safeloc.language.expr import NumVar
from safeloc.language.units import ONE
from safeloc.proof.provers import asking, limits
from safeloc.proof.provers.asking import UNITS_PER_SECOND, ask, new_solver, units, why_unknown
from safeloc.proof.provers.limits import CLOCK, clock_after, deadline, spend
from safeloc.proof.provers.recheck import certify, decide

PIGEONS = 9


def pigeons() -> list[z3.BoolRef]:
    """More pigeons than holes: hard for any search without counting."""
    at = [[z3.Bool(f"pigeon {one} in {hole}") for hole in range(PIGEONS - 1)] for one in range(PIGEONS)]
    alone = [
        z3.Not(z3.And(at[one][hole], at[other][hole]))
        for hole in range(PIGEONS - 1)
        for one in range(PIGEONS)
        for other in range(one)
    ]
    return [*(z3.Or(*row) for row in at), *alone]


def test_the_same_limit_ends_at_the_same_place() -> None:
    """Three tries within the same limit count the same, whatever the clock shows."""
    counts = set()
    for _ in range(3):
        solver, before = new_solver(), limits.effort()
        solver.add(*pigeons())
        with clock_after(1_000):  # the test may have hardly any of a processor
            assert ask(solver, 0.01) == z3.unknown
        counts.add(round(limits.effort() - before, 6))
        assert why_unknown(solver) == "limit reached"
    assert len(counts) == 1


def test_a_slow_clock_changes_no_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    """A machine five times as slow gives the same answers."""
    now = time.monotonic
    monkeypatch.setattr(time, "monotonic", lambda: 5 * now())
    ends, solver = deadline(1.0), new_solver()
    solver.add(z3.Int("x") > 3)
    time.sleep(0.3)  # 1.5 s by that clock
    assert ask(solver, ends.left) == z3.sat
    assert not ends.passed


def test_the_clock_is_the_last_resort(monkeypatch: pytest.MonkeyPatch) -> None:
    """A solver that hangs counts no effort; the clock ends it after several times the limit."""
    now, ends = time.monotonic(), deadline(1.0)
    monkeypatch.setattr(time, "monotonic", lambda: now + CLOCK + 1)
    assert ends.passed


def test_effort_of_a_part_is_effort_of_the_whole() -> None:
    """The effort of a part is no longer there for the parts after it."""
    whole, part = deadline(2.0), deadline(1.0)
    spend(1.5)
    assert part.passed
    assert whole.left == pytest.approx(0.5)


def test_nothing_is_asked_where_nothing_is_left() -> None:
    """z3 never gets a limit of 0, which means `no limit` to it."""
    solver = new_solver()
    assert ask(solver, 0.0) == z3.unknown
    assert units(1e-9) == 1
    assert units(1e9) == asking.MOST_UNITS
    assert units(2.0) == 2 * UNITS_PER_SECOND


def test_cvc5_counts_as_well() -> None:
    """The work of cvc5 counts as effort of this process, and its limit is one of its own resources."""
    level, before = NumVar("level", ONE, 0, 10), limits.effort()
    assert certify(Query("q", [level > 1], {"above 0": level > 0}), seconds=5.0).undecided == ()
    assert limits.effort() > before
    text = new_solver()
    text.add(*pigeons())
    assert decide("pigeons", f"(set-logic ALL)\n{text.to_smt2()}", seconds=0.001, options={}) == ["unknown"]
