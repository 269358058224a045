"""Witnesses from recordings: goals that a recorded run reaches need no search by a solver.

Some deep events of a composition are out of reach of a bounded search (a word read over five sections, minutes without a
reference), but occur in the streams that ship with the machine. A recording counts up to the first step that breaks the
assumption; the interpreter replays it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import islice
from types import MappingProxyType

from safeloc.errors import EngineError, InputError
from safeloc.language.expr import Bool, BoolVar, Var
from safeloc.language.interpret import Values, holds, named, read_inputs, start, step, taken
from safeloc.language.nodes import Value
from safeloc.language.spec import Goal, watch
from safeloc.language.system import TransitionSystem, environment
from safeloc.language.trace import Step, Trace
from safeloc.language.units import Enumeration
from safeloc.proof.drawn_runs.allowed import compiled_terms
from safeloc.proof.drawn_runs.quick import run_again
from safeloc.proof.provers.limits import Deadline


@dataclass(frozen=True)
class Recording:
    """A recorded run: initial values of open state variables, and the inputs of every step; remarks are left out."""

    first: Mapping[str, Value]
    steps: Sequence[Mapping[str, object]]


Witnesses = Mapping[str, Sequence[Recording]]
"""Name of a system, the whole or one of its machines alone -> short runs of it that an earlier search found."""
NO_WITNESSES: Witnesses = MappingProxyType({})


def shown(goals: Sequence[Goal], recordings: Sequence[Recording]) -> dict[Goal, Trace]:
    """Return the shortest recorded run for each goal that some recording reaches; all goals are of one system.

    Generated code finds the steps and makes the runs; the interpreter makes the step that reaches each goal, and a sampled share of
    the others. EngineError if the two differ.
    """
    found: dict[Goal, Trace] = {}
    if not goals or not recordings:
        return found
    replay = Replay(goals[0].plain, dict(enumerate(goals)))
    runs = [list(replay.states(recording)) for recording in recordings]
    shortest = _shortest(replay, runs)
    for number, recording in enumerate(recordings):
        wanted = {goals[goal]: steps for goal, (steps, where) in shortest.items() if where == number}
        if wanted:
            found |= _confirmed(replay, wanted, recording, [state for state, _ in runs[number]])
    return found


def _shortest(replay: Replay, runs: Sequence[Sequence[_Reached]]) -> dict[int, tuple[int, int]]:
    """Return, for each goal that some run reaches, the fewest steps and the number of that run."""
    met = dict[int, tuple[int, int]]()
    for number, run in enumerate(runs):
        for goal, steps in replay.first_times(run).items():
            met[goal] = min(met.get(goal, (steps, number)), (steps, number))
    return met


def _confirmed(
    replay: Replay, wanted: Mapping[Goal, int], recording: Recording, states: Sequence[Sequence[Value]]
) -> dict[Goal, Trace]:
    """Run the recording, which has these states, up to each goal; EngineError if the interpreter does not come to it in the last of these
    steps.
    """
    system, most = replay.system, max(wanted.values())
    rows = list(_own_inputs(system, recording.steps[:most]))
    run = run_again(system, rows, first=known_first(system, recording))
    for goal, steps in wanted.items():
        reached = start(replay.watched, known_first(system, recording))
        if steps:
            reached = _stepped(replay, goal, states[steps - 1], rows[steps - 1])
        found = [reached.get(var) for var in replay.watched.state]
        if found != states[steps] or holds(goal.good, reached):
            raise EngineError(
                f"the interpreter does not reach {goal.prop.name!r} in the step in which generated code does."
            )
    return {goal: Trace(system, run.initial, run.steps[:steps]) for goal, steps in wanted.items()}


def _stepped(replay: Replay, goal: Goal, state: Sequence[Value], row: Mapping[str, object]) -> Values:
    """Return the state after one step in the interpreter; nothing if the step breaks the assumption of the goal."""
    before, inputs = dict(zip(replay.watched.state, state, strict=True)), read_inputs(replay.system, row)
    return step(replay.watched, before, inputs)[0] if replay.lawful(goal, {**before, **inputs}) else {}


def lasting(system: TransitionSystem, recordings: Sequence[Recording], steps: int) -> Trace | None:
    """Return the first `steps` steps of a recorded run that satisfy the assumption; None if no recording has so many."""
    for recording in recordings:
        try:
            state = start(system, _known(system, recording.first))
        except InputError:
            continue
        kept = tuple(islice(_admissible(system, state, recording), steps))
        if len(kept) == steps:
            return Trace(system, named(state), kept)
    return None


def lawful_part(system: TransitionSystem, recording: Recording) -> tuple[dict[str, Value], list[Mapping[str, Value]]]:
    """Return first state and inputs of a recorded run up to the first step that breaks the assumption."""
    try:
        state = start(system, _known(system, recording.first))
    except InputError:
        return {}, []
    stream = [one.inputs for one in _admissible(system, state, recording)]
    return named(state), stream


def _admissible(system: TransitionSystem, state: Values, recording: Recording) -> Iterator[Step]:
    """Yield the steps as long as they are in range and satisfy the assumption."""
    with suppress(InputError):
        for one, _ in taken(system, state, _own_inputs(system, recording.steps), while_=environment(system)):
            yield one


def _own_inputs(system: TransitionSystem, records: Iterable[Mapping[str, object]]) -> Iterator[dict[str, object]]:
    """Yield the inputs of each recorded step, without its remarks."""
    names = {var.name for var in system.inputs}
    for record in records:
        yield {name: cell for name, cell in record.items() if name in names}


def _known(system: TransitionSystem, first: Mapping[str, Value]) -> dict[str, Value]:
    names = {var.name for var in system.state}
    return {name: value for name, value in first.items() if name in names}


# ------------------------------------------------------------------ many goals, by generated code


def come_to(
    system: TransitionSystem, goals: Mapping[int, Goal], recordings: Sequence[Recording], ends: Deadline
) -> set[int]:
    """Return the numbers of the goals that some recording reaches while it satisfies the assumption that they rely on.

    Generated code makes the runs: it is quick for many goals, and no proof depends on the result. Goals that are not reached
    before the deadline are left out.
    """
    found = set[int]()
    if goals and recordings:
        replay = Replay(system, goals)
        for recording in recordings:
            found |= replay.found(recording, ends)
    return found


def known_first(system: TransitionSystem, recording: Recording) -> dict[str, Value]:
    """Return the first values in a recording, for variables that the system has."""
    return _known(system, recording.first)


def is_label(var: Var) -> bool:
    """Return whether a variable is a mode, a choice or a flag, not a number: such variables tell situations apart."""
    return isinstance(var, BoolVar) or isinstance(var.unit, Enumeration)


_Reached = tuple[Sequence[Value], list[bool]]
"""A state, and for each assumption whether it has held so far."""


class Replay:
    """A system with the observers of all goals, compiled for replays of recordings."""

    def __init__(self, system: TransitionSystem, goals: Mapping[int, Goal]) -> None:
        self.system, self._numbers = system, tuple(goals)
        self.watched = watch(system, list(goals.values())).system
        relied: dict[Bool, int] = {}
        self._relies = [relied.setdefault(goal.system.assume, len(relied)) for goal in goals.values()]
        admissible = environment(system, assume=False)
        moves = [self.watched.next[var] for var in self.watched.state]
        self._step = compiled_terms((*self.watched.state, *system.inputs), [admissible, *relied, *moves])
        self._goods = compiled_terms(self.watched.state, [goal.good for goal in goals.values()])
        self._relied = len(relied)
        self._environments: dict[Bool, Bool] = {}

    def lawful(self, goal: Goal, values: Values) -> bool:
        """Return whether the interpreter finds the inputs in range and the assumption of the goal satisfied."""
        relied = goal.plain.assume
        if relied not in self._environments:  # one term for all goals, so that the interpreter reads it once
            self._environments[relied] = environment(goal.plain)
        return holds(self._environments[relied], values)

    def first_times(self, run: Sequence[_Reached]) -> dict[int, int]:
        """Return the goals that a run with these states reaches, by number, each with the steps until then."""
        met: dict[int, int] = {}
        for steps, (state, kept) in enumerate(run):
            if not any(kept):
                break
            judged = zip(self._numbers, self._goods(state), self._relies, strict=True)
            met |= {number: steps for number, good, relies in judged if not good and kept[relies] and number not in met}
        return met

    def found(self, recording: Recording, ends: Deadline) -> set[int]:
        """Return the numbers of the goals that the recording reaches before the deadline."""
        found = set[int]()
        for state, kept in self.states(recording):
            if ends.passed or not any(kept):
                break
            judged = zip(self._numbers, self._goods(state), self._relies, strict=True)
            found |= {number for number, good, relies in judged if not good and kept[relies]}
        return found

    def states(self, recording: Recording) -> Iterator[_Reached]:
        """Yield each state, and for each assumption whether it has held so far.

        An input that the machine cannot take ends the recording.
        """
        kept = [True] * self._relied
        with suppress(InputError):
            for state, now in self._each(recording):
                kept = [was and one for was, one in zip(kept, now, strict=True)]
                yield state, kept

    def _each(self, recording: Recording) -> Iterator[_Reached]:
        """Yield each state, and for each assumption whether the step to it satisfies it, as long as steps are in range."""
        state: Sequence[Value] = list(start(self.watched, _known(self.system, recording.first)).values())
        yield state, [True] * self._relied
        for record in _own_inputs(self.system, recording.steps):
            inputs = read_inputs(self.system, record)
            admissible, *rest = self._step([*state, *(inputs[var] for var in self.system.inputs)])
            if not admissible:
                return
            state = rest[self._relied :]
            yield state, [bool(one) for one in rest[: self._relied]]
