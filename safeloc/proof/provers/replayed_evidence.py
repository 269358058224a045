"""Counterexamples and witnesses: what a solver found counts only after exact replay in the interpreter."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from safeloc.errors import EngineError, InputError
from safeloc.language.expr import Var
from safeloc.language.interpret import fired_names, holds, outputs, read_inputs, run, start, step
from safeloc.language.nodes import Value
from safeloc.language.spec import Goal
from safeloc.language.system import TransitionSystem, environment
from safeloc.language.trace import Step, Trace


def replayed(goal: Goal, first: Mapping[str, Value], stream: Iterable[Mapping[str, object]]) -> Trace | None:
    """The run up to the first step in which `good` fails; None if it never does or the assumption is broken before."""
    system, allowed = goal.system, environment(goal.system)
    state = start(system, first)
    initial = _shown(goal, state)
    steps: list[Step] = []
    if not holds(goal.good, state):
        return Trace(goal.plain, initial, ())
    for record in stream:
        inputs = read_inputs(system, record)
        if not holds(allowed, {**state, **inputs}):
            return None
        state, fired = step(system, state, inputs)
        named = {var.name: value for var, value in inputs.items()}
        steps.append(Step(named, fired_names(fired), _shown(goal, state), outputs(system, state)))
        if not holds(goal.good, state):
            return Trace(goal.plain, initial, tuple(steps))
    return None


def admissible_run(
    system: TransitionSystem, first: Mapping[str, Value], stream: Sequence[Mapping[str, object]]
) -> Trace:
    """The run; EngineError if it breaks the assumption or a range."""
    try:
        trace = run(system, stream, first=first)
    except InputError as error:
        raise EngineError(f"a run of {system.name} that a solver found is not admissible: {error}") from error
    state, allowed = start(system, first), environment(system)
    for number, record in enumerate(stream, 1):
        inputs = read_inputs(system, record)
        if not holds(allowed, {**state, **inputs}):
            raise EngineError(f"a run of {system.name} that a solver found breaks the assumption in step {number}.")
        state, _ = step(system, state, inputs)
    return trace


def confirmed(goal: Goal, first: Mapping[str, Value], stream: Iterable[Mapping[str, object]], engine: str) -> Trace:
    """The replayed run; EngineError if the interpreter does not confirm what the engine claims."""
    try:
        trace = replayed(goal, first, stream)
    except InputError as error:
        raise EngineError(f"{engine}: its stream for {goal.prop.name!r} is not admissible: {error}") from error
    if trace is None:
        raise EngineError(
            f"{engine}: its stream for {goal.prop.name!r} does not break the property in the interpreter."
        )
    return trace


def _shown(goal: Goal, state: Mapping[Var, Value]) -> dict[str, Value]:
    hidden = set(goal.observers)
    return {var.name: value for var, value in state.items() if var not in hidden}
