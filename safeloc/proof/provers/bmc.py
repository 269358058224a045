"""Bounded search, one step at a time in one solver: it finds the shortest violation or witness, and proves nothing
else.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from safeloc.codegen.smt import Unrolling
from safeloc.language.expr import Var
from safeloc.language.spec import Goal, Watch
from safeloc.language.trace import Trace
from safeloc.language.verdict import Proved, Unknown, Verdict, Violated
from safeloc.proof.provers.asking import new_solver
from safeloc.proof.provers.deepening import Deepening
from safeloc.proof.provers.limits import Limits, deadline
from safeloc.proof.provers.replayed_evidence import confirmed

_FIRST_TRY = 1 / 3


@dataclass(frozen=True)
class Exhausted:
    """No violation found: no run of up to `depth` steps breaks `good`; -1 if not even the first states were searched."""

    depth: int
    reason: str


def bmc(goal: Goal, limits: Limits) -> Verdict:
    """Return Violated with a shortest trace, Proved with a shortest witness (for `reachable`), or Unknown."""
    found = search(goal, limits)
    if isinstance(found, Exhausted):
        return Unknown(found.reason, found.depth)
    if goal.prop.kind == "reachable":
        return Proved(None, "bmc", len(found.steps), ("interpreter",), witness=found)
    return Violated(found, "bmc")


def search(goal: Goal, limits: Limits) -> Trace | Exhausted:
    """Return the shortest run after which `good` fails.

    If z3 does not finish within a third of the limit, it is asked again with another seed: with an unlucky seed a
    question of half a second can take a hundred times as long.

    Of a composition, a run that `reachable` asks for is searched machine by machine before; it may be longer than the shortest one.
    """
    if goal.prop.kind == "reachable" and goal.system.parts:
        found = _by_machines(goal, replace(limits, seconds=limits.seconds * _FIRST_TRY))
        if found is not None:
            return found
    first = _search(goal, replace(limits, seconds=limits.seconds * _FIRST_TRY))
    if not isinstance(first, Exhausted) or first.depth == limits.depth:
        return first
    again = _search(goal, replace(limits, seconds=limits.seconds * (1 - _FIRST_TRY), seed=limits.seed + 1))
    return again if not isinstance(again, Exhausted) or again.depth >= first.depth else first


def _search(goal: Goal, limits: Limits) -> Trace | Exhausted:
    runs, ends = Deepening(Unrolling(goal.system), new_solver(limits.seed)), deadline(limits.seconds)
    while runs.depth < limits.depth:
        if ends.passed:
            return Exhausted(runs.depth, f"time limit of {limits.seconds:g} s")
        model = runs.run(runs.fails(goal.good), ends)
        if model is not None:
            return confirmed(goal, runs.first(model, declared_state(goal)), runs.stream(model), "bmc")
        if runs.stuck:
            return Exhausted(runs.depth, f"solver: {runs.stuck}")
        runs.deeper(goal.good)
    return Exhausted(limits.depth, f"depth limit of {limits.depth} steps")


def _by_machines(goal: Goal, limits: Limits) -> Trace | Exhausted | None:
    """Return a run, or Exhausted if there is none of any length; None if the search left some length open.

    A length that it does not decide is passed over: what is asked there is whether a run of that length is the shortest one.
    """
    runs, ends = Deepening(Unrolling(goal.system), new_solver(limits.seed)), deadline(limits.seconds)
    open_ = False
    while runs.depth < limits.depth:
        if ends.passed:
            return None
        model = runs.run_by_machines(runs.fails(goal.good), ends, limits.seed)
        if model is not None:
            return confirmed(goal, runs.first(model, declared_state(goal)), runs.stream(model), "bmc")
        open_ = open_ or bool(runs.stuck)
        runs.deeper(goal.good)
    return None if open_ else Exhausted(limits.depth, f"depth limit of {limits.depth} steps")


def declared_state(goal: Goal | Watch) -> list[Var]:
    """Return the state variables without the observers of properties."""
    hidden = set(goal.observers)
    return [var for var in goal.system.state if var not in hidden]
