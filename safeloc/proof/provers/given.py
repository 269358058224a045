"""That a proof under a further assumption is a proof of something: the first thing to look at, for every engine by itself."""

from __future__ import annotations

import z3

from safeloc.codegen.smt import Unrolling
from safeloc.language.expr import TRUE
from safeloc.language.spec import Goal
from safeloc.language.verdict import Unknown, Vacuous
from safeloc.proof.provers.limits import milliseconds

EMPTY = "empty: no run keeps what the property is given, so that nothing is said by its proof"


def nothing_given(goal: Goal, seconds: float) -> Vacuous | Unknown | None:
    """Vacuous where no run begins under what the property is given, Unknown where that is not decided, else None.

    Whether such a run can go on is another question (safeloc.proof.provers.dead_ends).
    """
    if goal.prop.given is TRUE:
        return None
    unrolling, solver = Unrolling(goal.system), z3.Solver()
    solver.set("timeout", milliseconds(seconds))
    solver.add(unrolling.initially(), unrolling.transition(0))
    answer = solver.check()
    if answer == z3.unsat:
        return Vacuous(EMPTY)
    if answer == z3.unknown:
        return Unknown(f"whether any run keeps what the property is given: solver: {solver.reason_unknown()}")
    return None
