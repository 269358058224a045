"""The reason why no run satisfies an assumption: a smallest set of clauses of the world that exclude each other, in words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import z3

from safeloc.codegen.smt import Unrolling
from safeloc.language.system import TransitionSystem
from safeloc.proof.cores.clauses import ClauseId, assumed_clauses
from safeloc.proof.provers.asking import ask, plain_solver
from safeloc.proof.provers.limits import Deadline

NO_RUN = "no run satisfies the assumption: every proof under it would be empty"


def no_run(system: TransitionSystem, steps: int, ends: Deadline) -> str:
    """Return NO_RUN with the clauses that exclude each other; without them where they are not found in time.

    steps  length of the runs of which there is none
    """
    found = excluding(system, steps, ends)
    if found is None:
        return NO_RUN
    length, clauses = found
    within = "in the first step" if length == 1 else f"within {length} steps"
    match [repr(str(one)) for one in clauses]:
        case []:
            return f"{NO_RUN}. The first state and the ranges have no run, whatever the clauses ({within})"
        case [only]:
            return f"{NO_RUN}. The clause {only} excludes every run by itself, {within}"
        case names:
            return f"{NO_RUN}. These clauses exclude each other {within}: {', '.join(names)}"


def excluding(system: TransitionSystem, steps: int, ends: Deadline) -> tuple[int, list[ClauseId]] | None:
    """Return the shortest length of which there is no run, and clauses that exclude it, of which none can be left out.

    None if there is such a run, or the solver does not decide.
    """
    clauses = assumed_clauses(system)
    switches: dict[ClauseId, Any] = {one: z3.Bool(number) for number, one in enumerate(clauses)}  # no variable's name
    unrolling, solver = Unrolling(system, assume=False), plain_solver()
    solver.add(unrolling.initially())
    for step in range(steps):
        solver.add(unrolling.transition(step))
        solver.add(*(z3.Implies(switches[one], unrolling.at(term, step)) for one, term in clauses.items()))
        answer = ask(solver, ends.left, *switches.values())
        if answer == z3.unsat:
            return step + 1, _smallest(solver, switches, ends)
        if answer == z3.unknown:
            break
    return None


def _smallest(solver: z3.Solver, switches: Mapping[ClauseId, Any], ends: Deadline) -> list[ClauseId]:
    """Leave out one clause after the other without which there is no run either."""
    kept = _core(solver, list(switches), switches)
    for one in list(kept):
        others = [other for other in kept if other is not one]
        if one in kept and ask(solver, ends.left, *(switches[other] for other in others)) == z3.unsat:
            kept = _core(solver, others, switches)
    return kept


def _core(solver: z3.Solver, asked: Sequence[ClauseId], switches: Mapping[ClauseId, Any]) -> list[ClauseId]:
    """Return those of the clauses that z3 needed for its last answer."""
    used = {switch.get_id() for switch in solver.unsat_core()}  # pyright: ignore[reportAttributeAccessIssue, reportOptionalMemberAccess] # a term
    return [one for one in asked if switches[one].get_id() in used]
