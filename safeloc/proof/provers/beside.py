"""Random runs beside recordings: a run repeats a recording up to some step, and goes on with some of its inputs drawn anew.

Drawn runs from the first states seldom come to the deep modes of a composition, in which many sensors have to agree for
minutes. A recording is there already. Beside it most inputs stay as recorded, and those of one or two machines change: a
sensor falls silent, a marker is missing, a report comes late. The interpreter makes each run that reaches a new goal.
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import islice

from safeloc.errors import EngineError
from safeloc.language.expr import Var
from safeloc.language.interpret import Values, holds, named, read_inputs, start, taken
from safeloc.language.nodes import Value
from safeloc.language.spec import Goal
from safeloc.language.system import TransitionSystem, canonical, environment
from safeloc.language.trace import Step, Trace
from safeloc.proof.drawn_runs.allowed import compiled_terms
from safeloc.proof.drawn_runs.lawful import Repair
from safeloc.proof.drawn_runs.profiles import FAULTY, PLAUSIBLE, Profile
from safeloc.proof.provers.recorded_witnesses import Recording, Replay, is_label, known_first

LENGTHS = (3, 8, 20)
"""Lengths in steps of the part of a run that leaves the recording."""
CHANGED = (1, 1, 1, 2)
"""Numbers of machines (of inputs, in a system of one machine) whose inputs a run draws anew."""
SHARES = (1.0, 1.0, 0.3, 0.1)
"""Shares of the steps in which these inputs are drawn; in the others they stay as recorded."""
_IDLE_RUNS = 250
"""Runs without a new goal after which drawing stops."""


def beside(goals: Sequence[Goal], recordings: Sequence[Recording], seed: int = 0) -> dict[Goal, Trace]:
    """Return a run for each goal that some random run beside a recording reaches; all goals are of one system and one assumption."""
    found: dict[Goal, Trace] = {}
    if not goals or not recordings:
        return found
    draw, idle = _Draw(goals, recordings, seed), 0
    while draw.left and draw.starts and idle < _IDLE_RUNS:
        new = draw.run()
        found |= new
        idle = 0 if new else idle + 1
    return found


@dataclass
class _Course:
    """A recording: its inputs, the state after each number of steps, and those of its steps that the interpreter has made."""

    inputs: list[Values]
    states: list[Sequence[Value]]
    initial: dict[str, Value]
    interpreted: Iterator[tuple[Step, Values]]
    steps: list[Step] = field(default_factory=list)
    after: list[Values] = field(default_factory=list)

    def until(self, steps: int) -> tuple[list[Step], Values]:
        """Return the first steps and the state after them, made by the interpreter. EngineError if generated code differs."""
        for one, state in islice(self.interpreted, max(0, steps - len(self.steps))):
            self.steps.append(one)
            self.after.append(state)
        if len(self.steps) < steps or list(self.after[steps].values()) != list(self.states[steps]):
            raise EngineError(f"generated code and the interpreter come to different states in step {steps}.")
        return self.steps[:steps], self.after[steps]


class _Draw:
    """Drawn runs of a system with the observers of goals; `left` holds the goals not reached yet, `starts` where runs may begin.

    A start is a course and a number of its steps: where a combination of modes and flags is new.
    """

    def __init__(self, goals: Sequence[Goal], recordings: Sequence[Recording], seed: int) -> None:
        self._draw, self.left = random.Random(seed), dict(enumerate(goals))
        self._plain, self._free = goals[0].plain, goals[0].prop.unconditional
        replay = Replay(self._plain, self.left)
        self._system, self._hidden = replay.watched, frozenset(var for goal in goals for var in goal.observers)
        self._repair = Repair(goals[0].original)
        reads = (*self._system.state, *self._system.inputs)
        self._step = compiled_terms(reads, [environment(self._system), *self._system.next.values()])
        self._goods = compiled_terms(self._system.state, [goal.good for goal in goals])
        self._groups = _groups(self._plain)
        self._courses = [self._course(replay, one) for one in recordings]
        self.starts = list(self._starts())

    def run(self) -> dict[Goal, Trace]:
        """Make one more run; return the new goals that it reaches, each with its run."""
        course, begin = self._draw.choice(self.starts)
        found: dict[Goal, Trace] = {}
        stream = list[Mapping[Var, Value]]()
        for state in self._states(course, begin, stream):
            goods = self._goods(state)
            new = [place for place in self.left if not goods[place]]
            found |= {goal: self._confirmed(goal, course, begin, stream) for goal in map(self.left.pop, new)}
        return found

    def _states(self, course: _Course, begin: int, stream: list[Mapping[Var, Value]]) -> Iterator[Sequence[Value]]:
        """Yield one state after the other; `stream` collects the inputs that lead to it."""
        state = list(course.states[begin])
        faulty = self._free and self._draw.random() < 0.5
        profile = Profile(
            self._plain, self._draw.choice(FAULTY if faulty else PLAUSIBLE), random.Random(self._draw.random())
        )
        groups = self._draw.sample(self._groups, min(len(self._groups), self._draw.choice(CHANGED)))
        share = self._draw.choice(SHARES)
        for recorded in course.inputs[begin : begin + self._draw.choice(LENGTHS)]:
            values = dict(zip(self._system.state, state, strict=True))
            drawn, inputs = profile.inputs(values), dict(recorded)
            inputs |= {var: drawn[var] for group in groups for var in group if self._draw.random() < share}
            lawful = self._canonical(inputs)
            if not faulty:
                mended = self._repair.mend(values, lawful, profile.draw, profile.pick)
                if mended is None:
                    return
                lawful = mended
            allowed, *state = self._step([*state, *(lawful[var] for var in self._system.inputs)])
            if not allowed:
                return
            stream.append(lawful)
            yield state

    def _canonical(self, inputs: dict[Var, Value]) -> dict[Var, Value]:
        """Return the inputs; those that are absent hold their canonical value."""
        absent = [option.value for option in self._plain.optionals if not inputs[option.present]]
        return inputs | {var: canonical(var) for var in absent}

    def _confirmed(self, goal: Goal, course: _Course, begin: int, stream: Sequence[Mapping[Var, Value]]) -> Trace:
        """Let the interpreter make the run. EngineError if it does not reach the goal in its last step."""
        steps, state = course.until(begin)
        made, rows = list(steps), [{var.name: value for var, value in one.items()} for one in stream]
        for one, after in taken(self._system, state, rows, while_=environment(self._system), hidden=self._hidden):
            made.append(one)
            state = after
        if len(made) != len(steps) + len(rows) or holds(goal.good, state):
            raise EngineError(f"a drawn run beside a recording does not reach {goal.prop.name!r} in the interpreter.")
        return Trace(goal.plain, course.initial, tuple(made))

    def _course(self, replay: Replay, recording: Recording) -> _Course:
        known = list[Sequence[Value]]()
        for state, kept in replay.states(recording):
            if not all(kept):
                break
            known.append(state)
        names = {var.name for var in self._plain.inputs}
        rows = [{name: cell for name, cell in one.items() if name in names} for one in recording.steps]
        if not known:
            return _Course([], [], {}, iter(()))
        first = start(self._system, known_first(self._plain, recording))
        made = taken(self._system, first, rows, while_=environment(self._system), hidden=self._hidden)
        inputs = [read_inputs(self._plain, row) for row in rows[: len(known) - 1]]
        return _Course(inputs, known, named(first, self._hidden), made, after=[first])

    def _starts(self) -> Iterator[tuple[_Course, int]]:
        labels = [place for place, var in enumerate(self._system.state) if is_label(var)]
        seen = set[tuple[Value, ...]]()
        for course in self._courses:
            for steps, state in enumerate(course.states[: len(course.inputs)]):
                combination = tuple(state[place] for place in labels)
                if combination not in seen:
                    seen.add(combination)
                    yield course, steps


def _groups(system: TransitionSystem) -> list[list[Var]]:
    """Return the inputs by machine; in a system of one machine each optional input, with its presence, and each other one."""
    present: dict[Var, Var] = {option.value: option.present for option in system.optionals}
    if not system.parts:
        flags = set(present.values())
        return [[var, present[var]] if var in present else [var] for var in system.inputs if var not in flags]
    by_machine: dict[str, list[Var]] = {}
    for var in system.inputs:
        by_machine.setdefault(var.name.rpartition(".")[0], []).append(var)
    return list(by_machine.values())
