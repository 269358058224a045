"""What is known to happen, because a recorded run shows it: a witness that no solver has to look for.

Deep events of a composition (a word of five sections read, a reference that does not come for minutes) are beyond what
a bounded search reaches, and are in the streams that ship with the machine. A recording counts as far as it keeps the
assumption, replayed in the interpreter.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from safeloc.errors import InputError
from safeloc.expr import Var
from safeloc.interpret import evaluate, fired_names, holds, outputs, read_inputs, start, step
from safeloc.nodes import Value
from safeloc.spec import Goal, Watch, watch
from safeloc.system import TransitionSystem, environment
from safeloc.trace import Step, Trace

Values = Mapping[Var, Value]


@dataclass(frozen=True)
class Recording:
    """A recorded run: initial values of open state variables, and the inputs of every step; remarks are left out."""

    first: Mapping[str, Value]
    steps: Sequence[Mapping[str, object]]


def shown(goals: Sequence[Goal], recordings: Sequence[Recording]) -> dict[str, Trace]:
    """The shortest recorded run to each goal that some recording comes to; all goals are of one system."""
    found: dict[str, Trace] = {}
    if not goals:
        return found
    watched = watch(replace(goals[0].original, assume=goals[0].system.assume), goals)
    for recording in recordings:
        for name, trace in _first_times(watched, recording):
            if name not in found or len(trace.steps) < len(found[name].steps):
                found[name] = trace
    return found


def lasting(system: TransitionSystem, recordings: Sequence[Recording], steps: int) -> Trace | None:
    """The beginning of a recorded run that keeps the assumption for so many steps; None if there is none."""
    for recording in recordings:
        taken: list[Step] = []
        try:
            state = start(system, _known(system, recording.first))
            initial = _named(state, frozenset())
            for one, _ in _admissible(system, state, recording, frozenset()):
                taken.append(one)
        except InputError:
            continue
        if len(taken) >= steps:
            return Trace(system, initial, tuple(taken[:steps]))
    return None


def _first_times(watched: Watch, recording: Recording) -> Iterator[tuple[str, Trace]]:
    """Each goal with the run up to the step in which the recording first comes to it."""
    system, original, hidden = watched.system, watched.goals[0].original, frozenset(watched.observers)
    left, taken = {goal.prop.name: goal for goal in watched.goals}, list[Step]()
    try:
        state = start(system, _known(original, recording.first))
    except InputError:
        return
    initial = _named(state, hidden)
    for one, after in _admissible(system, state, recording, hidden):
        taken.append(one)
        for name in [name for name, goal in left.items() if not holds(goal.good, after)]:
            del left[name]
            yield name, Trace(original, initial, tuple(taken))


def _admissible(
    system: TransitionSystem, state: Values, recording: Recording, hidden: frozenset[Var]
) -> Iterator[tuple[Step, Values]]:
    """The steps as long as they are in range and keep the assumption, each with the state after it."""
    allowed, names = environment(system), {var.name for var in system.inputs}
    for record in recording.steps:
        try:
            inputs = read_inputs(system, {name: cell for name, cell in record.items() if name in names})
        except InputError:
            return
        if not evaluate([allowed], {**state, **inputs})[0]:
            return
        state, fired = step(system, state, inputs)
        heard = {var.name: value for var, value in inputs.items()}
        yield Step(heard, fired_names(fired), _named(state, hidden), outputs(system, state)), state


def _known(system: TransitionSystem, first: Mapping[str, Value]) -> dict[str, Value]:
    names = {var.name for var in system.state}
    return {name: value for name, value in first.items() if name in names}


def _named(state: Values, hidden: frozenset[Var]) -> dict[str, Value]:
    return {var.name: value for var, value in state.items() if var not in hidden}
