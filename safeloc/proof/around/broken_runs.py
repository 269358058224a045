"""Runs that break a claim, replayed by the reference interpreter, and the values with which runs and observers begin."""

from __future__ import annotations

from collections.abc import Mapping

from safeloc.errors import EngineError
from safeloc.language.expr import Var
from safeloc.language.first_values import Any_
from safeloc.language.interpret import holds, named, start, taken
from safeloc.language.nodes import Value
from safeloc.language.spec import Goal
from safeloc.language.system import TransitionSystem, environment
from safeloc.language.trace import Trace
from safeloc.proof.around.claims import Asked
from safeloc.proof.around.windows import Breaks


def broken_run(goal: Goal, asked: Asked, system: TransitionSystem, found: Breaks) -> Trace:
    """Return the run that breaks a claim in its last cycle; EngineError if the interpreter does not agree."""
    hidden = frozenset(goal.observers)
    state = start(goal.system, open_first(goal.system, {**found.first, **first_of(goal)}))
    first, steps = named(state, hidden), []
    broken = asked.first == 0 and not holds(goal.good, state)
    rows = [{var.name: row[var] for var in goal.system.inputs} for row in found.stream]
    condition = environment(goal.system)
    for cycle, row in enumerate(rows, 1):
        if broken:
            raise EngineError(f"{asked.prop.name!r} is broken before cycle {cycle} already; report this.")
        made = list(taken(goal.system, state, [row], while_=condition, hidden=hidden))
        if not made:
            raise EngineError(f"a stream that breaks {asked.prop.name!r} breaks a law in cycle {cycle}; report this.")
        [(one, state)] = made
        steps.append(one)
        if cycle == asked.first - 1:
            state = {**state, **first_of(goal)}
        broken = asked.first <= cycle and not holds(goal.good, state)
    if not broken:
        raise EngineError(f"the stream that is to break {asked.prop.name!r} does not; report this.")
    return Trace(system, first, tuple(steps))


def first_of(goal: Goal) -> dict[Var, Value]:
    """Return the observers of a goal with their first values."""
    values = {var: goal.system.initial[var] for var in goal.observers}
    return {var: value for var, value in values.items() if isinstance(value, (bool, int))}


def open_first(system: TransitionSystem, values: Mapping[Var, Value]) -> dict[str, Value]:
    """Return the values of variables whose first value is open, by name."""
    return {var.name: values[var] for var in system.state if isinstance(system.initial[var], Any_) and var in values}
