"""Searches for runs: hard goals do not keep the solver from others, and a mode that was reached leads to the next one."""

from __future__ import annotations

from typing import Any

import pytest
import z3

from safeloc.language.expr import number
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.spec import Goal, observe, reachable
from safeloc.language.system import lower
from safeloc.language.trace import Trace
from safeloc.language.units import COUNT
from safeloc.language.verdict import Proved
from safeloc.proof.provers import reachability
from safeloc.proof.provers.deepening import Deepening
from safeloc.proof.provers.leaping import leaping
from safeloc.proof.provers.limits import Deadline, Limits
from safeloc.proof.provers.reachability import reached
from safeloc.proof.provers.reachable_targets import without_assumption
from safeloc.proof.provers.searches import TRIES, sparing_runs
from tests.proof.provers.small import LEVEL, counter, system

COUNTER = system(counter())
TWO, FIVE, NEVER = (observe(COUNTER, reachable(f"level {n}", LEVEL.eq(n))) for n in (2, 5, 11))


def test_a_goal_that_is_too_hard_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    """The solver gets lost with one goal: the others are found one by one, and no length counts as complete from then on."""
    alone = Deepening.run_anew

    def lost(self: Deepening, *_: Any) -> z3.ModelRef | None:
        self.stuck = "limit reached"
        return None

    def lost_with_one(self: Deepening, condition: z3.BoolRef, ends: Deadline, solver: z3.Solver) -> z3.ModelRef | None:
        hard = "11" in str(condition)
        return lost(self) if hard else alone(self, condition, ends, solver)

    monkeypatch.setattr(Deepening, "run", lost)
    monkeypatch.setattr(Deepening, "run_anew", lost_with_one)
    runs = sparing_runs([TWO, FIVE, NEVER], Limits(depth=8))
    assert {TWO: 2, FIVE: 5} == {goal: len(trace.steps) for goal, trace in runs.found.items()}
    assert -1 == runs.depth


def test_a_search_ends_when_every_goal_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing is left to ask after some lengths: no longer runs are made."""

    def lost(self: Deepening, *_: Any) -> z3.ModelRef | None:
        self.stuck = "limit reached"
        return None

    longer: list[int] = []
    monkeypatch.setattr(Deepening, "run", lost)
    monkeypatch.setattr(Deepening, "run_anew", lost)
    monkeypatch.setattr(Deepening, "deeper", lambda self: longer.append(self.depth))
    runs = sparing_runs([TWO, FIVE], Limits(depth=8))
    assert ({}, -1, TRIES - 1) == (dict(runs.found), runs.depth, len(longer))


def test_one_run_shows_several_goals(monkeypatch: pytest.MonkeyPatch) -> None:
    """A goal that the run of another one reaches is not asked for again."""
    again = observe(COUNTER, reachable("level 2 once more", LEVEL.eq(2)))

    def lost(self: Deepening, *_: Any) -> z3.ModelRef | None:
        self.stuck = "limit reached"
        return None

    monkeypatch.setattr(Deepening, "run", lost)
    runs = sparing_runs([TWO, again], Limits(depth=3))
    assert {TWO: 2, again: 2} == {goal: len(trace.steps) for goal, trace in runs.found.items()}


A, B, C, D = modes("A", "B", "C", "D")
KEY, N = number("key", COUNT, 0, 1_000_000), number("n", COUNT, 0, 5)
LOCKS = lower(
    Machine(
        "locks", (A, B, C, D), [KEY], {N: 0}, {},
        [
            Transition("first", A, B, KEY.eq(12_345) & (N >= 2), {N: 0}),
            Transition("second", B, C, KEY.eq(54_321) & (N >= 2), {N: 0}),
            Transition("third", C, D, KEY.eq(33_333) & (N >= 4), {N: 0}),
            Transition("wait", (A, B, C), A, KEY.eq(7), {N: 0}, rank=1),
            Transition("stay in A", A, A, N < 5, {N: N + 1}, rank=2),
            Transition("stay in B", B, B, N < 5, {N: N + 1}, rank=2),
            Transition("stay in C", C, C, N < 5, {N: N + 1}, rank=2),
        ],
    )
)  # fmt: skip


def _goal(label: str) -> Goal:
    mode = LOCKS.machines[0].mode
    term = mode.eq({"B": B, "C": C, "D": D}[label])
    return without_assumption(observe(LOCKS, reachable(label, term)))


def test_a_search_leaps_from_mode_to_mode() -> None:
    """Eleven steps lead to the last mode; a search from the start goes three, and each leap three or six more."""
    last, between = _goal("D"), [_goal("B"), _goal("C")]
    found = leaping([last], Limits(), [], between)
    assert [last] == list(found)
    assert len(found[last].steps) == 11
    assert leaping([last], Limits(), [], []) == {}


def test_a_deep_mode_is_reached_without_a_long_search(monkeypatch: pytest.MonkeyPatch) -> None:
    """The obligation of the last mode is met although no search from the start is so long."""

    def none_drawn(*_: Any) -> dict[Goal, Trace]:
        return {}

    monkeypatch.setattr(reachability, "drawn", none_drawn)
    by_name = {one.name: one for one in reached(LOCKS, Limits(depth=4))}
    verdict = by_name["mode locks D"].verdict
    assert isinstance(verdict, Proved)
    assert verdict.depth == 11
