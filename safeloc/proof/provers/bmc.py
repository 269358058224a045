"""Bounded search, one step at a time in one solver: finds the shortest violation or witness, proves nothing else."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import z3

from safeloc.codegen.smt import Unrolling
from safeloc.language.spec import Goal, Watch
from safeloc.language.trace import Trace
from safeloc.language.verdict import Proved, Unknown, Verdict, Violated
from safeloc.proof.provers.asking import ask, new_solver, why_unknown
from safeloc.proof.provers.limits import Limits, deadline
from safeloc.proof.provers.replayed_evidence import confirmed

FIRST_TRY = 1 / 3


@dataclass(frozen=True)
class Exhausted:
    """Nothing found: no run of up to `depth` steps breaks `good` (-1: not even that is known)."""

    depth: int
    reason: str


def bmc(goal: Goal, limits: Limits) -> Verdict:
    """Violated with a shortest trace, Proved for `reachable` with a shortest witness, else Unknown."""
    found = search(goal, limits)
    if isinstance(found, Exhausted):
        return Unknown(found.reason, found.depth)
    if goal.prop.kind == "reachable":
        return Proved(None, "bmc", len(found.steps), ("interpreter",), witness=found)
    return Violated(found, "bmc")


def search(goal: Goal, limits: Limits) -> Trace | Exhausted:
    """Return the shortest run after which `good` fails.

    What z3 does not come to with one seed in a third of the limit, it is asked once more with another one: a question of
    half a second can take a hundred times as long with the wrong one.
    """
    first = _search(goal, replace(limits, seconds=limits.seconds * FIRST_TRY))
    if not isinstance(first, Exhausted) or first.depth == limits.depth:
        return first
    again = _search(goal, replace(limits, seconds=limits.seconds * (1 - FIRST_TRY), seed=limits.seed + 1))
    return again if not isinstance(again, Exhausted) or again.depth >= first.depth else first


def _search(goal: Goal, limits: Limits) -> Trace | Exhausted:
    unrolling, solver = Unrolling(goal.system), new_solver(limits.seed)
    ends = deadline(limits.seconds)
    solver.add(unrolling.initially())
    for depth in range(limits.depth + 1):
        if ends.passed:
            return Exhausted(depth - 1, f"time limit of {limits.seconds:g} s")
        broken = z3.Not(unrolling.at(goal.good, depth))
        solver.push()
        solver.add(broken)
        answer = ask(solver, ends.left)
        if answer == z3.sat:
            return confirmed(goal, *run_of(goal, unrolling, solver.model(), depth), "bmc")
        if answer == z3.unknown:
            return Exhausted(depth - 1, f"solver: {why_unknown(solver)}")
        solver.pop()
        solver.add(z3.Not(broken), unrolling.transition(depth))
    return Exhausted(limits.depth, f"depth limit of {limits.depth} steps")


def run_of(
    goal: Goal | Watch, unrolling: Unrolling, model: z3.ModelRef, depth: int
) -> tuple[dict[str, int | bool], list[dict[str, int | bool]]]:
    """First state and inputs of every step, read from a model."""
    hidden = set(goal.observers)
    first = unrolling.values(model, 0, [var for var in goal.system.state if var not in hidden])
    return first, list(_inputs(goal, unrolling, model, depth))


def _inputs(
    goal: Goal | Watch, unrolling: Unrolling, model: z3.ModelRef, depth: int
) -> Iterator[dict[str, int | bool]]:
    for number in range(depth):
        yield unrolling.values(model, number, goal.system.inputs)
