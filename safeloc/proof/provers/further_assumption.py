"""Check that a run exists under a property's further assumption, so that its proof is not empty.

k-induction and Spacer call this before they report a proof.
"""

from __future__ import annotations

import z3

from safeloc.codegen.smt import Unrolling
from safeloc.language.expr import TRUE
from safeloc.language.spec import Goal
from safeloc.language.verdict import Unknown, Vacuous
from safeloc.proof.provers.asking import ask, new_solver, why_unknown

EMPTY = "no run satisfies the further assumption, so the proof would be empty"


def nothing_begins(goal: Goal, seconds: float) -> Vacuous | Unknown | None:
    """Return Vacuous if no run begins under the further assumption, Unknown if undecided, else None.

    safeloc.proof.provers.dead_ends checks that such a run can go on.
    """
    if goal.prop.further_assumption is TRUE:
        return None
    unrolling, solver = Unrolling(goal.system), new_solver()
    solver.add(unrolling.initially(), unrolling.transition(0))
    answer = ask(solver, seconds)
    if answer == z3.unsat:
        return Vacuous(EMPTY)
    if answer == z3.unknown:
        return Unknown(f"not known if any run satisfies the further assumption: solver: {why_unknown(solver)}")
    return None
