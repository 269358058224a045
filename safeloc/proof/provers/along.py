"""A run along the way of another one: as many steps, the same transitions and flags, and other numbers.

With the way given, what is left to the solver are numbers that meet a conjunction; a search that has to find the way as well can
take a hundred times as long. That there is no run along a way does not say that there is none.
"""

from __future__ import annotations

from collections.abc import Iterator

import z3

from safeloc.codegen.smt import Unrolling
from safeloc.language.expr import BoolVar
from safeloc.language.spec import Goal
from safeloc.language.trace import Step, Trace
from safeloc.language.units import Enumeration
from safeloc.proof.provers.asking import ask, new_solver
from safeloc.proof.provers.bmc import declared_state
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.recorded_witnesses import is_label
from safeloc.proof.provers.replayed_evidence import confirmed


def along(goal: Goal, way: Trace, limits: Limits) -> Trace | None:
    """Return a run that breaks the goal along the way of the given one, if the solver finds one within the limits.

    way  a run of a system with inputs and transitions of the same names, perhaps in another world
    """
    if not _has_its_names(goal, way):
        return None
    length, runs, solver = len(way.steps), Unrolling(goal.system), new_solver(limits.seed)
    solver.add(runs.initially())
    for number, step in enumerate(way.steps):
        solver.add(runs.transition(number), *_same_way(goal, runs, number, step))
    solver.add(z3.Not(runs.at(goal.good, length)))
    if ask(solver, limits.seconds) != z3.sat:
        return None
    model = solver.model()
    stream = [runs.values(model, number, goal.system.inputs) for number in range(length)]
    return confirmed(goal, runs.values(model, 0, declared_state(goal)), stream, "bounded search along a run")


def _has_its_names(goal: Goal, way: Trace) -> bool:
    """Return whether inputs and transitions of the way have the names of those of the goal's system."""
    inputs, tables = {var.name for var in goal.system.inputs}, {one.name: one.unit for one in goal.original.fired}
    return inputs == {var.name for var in way.system.inputs} and all(
        table.name in tables and table.unit == tables[table.name] for table in way.system.fired
    )


def _same_way(goal: Goal, runs: Unrolling, number: int, step: Step) -> Iterator[z3.BoolRef | bool]:
    """Yield that flags and labels of the inputs, and the transitions that fire, are those of the given step."""
    for var in goal.system.inputs:
        if is_label(var):
            given = step.inputs[var.name]
            yield runs.at(var, number) == (bool(given) if isinstance(var, BoolVar) else int(given))
    for table, term in goal.original.fired.items():
        assert isinstance(table.unit, Enumeration)
        yield runs.at(term, number) == table.unit.index(step.fired[table.name])
