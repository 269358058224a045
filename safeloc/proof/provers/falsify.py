"""Search for deep bugs: long lawful runs with extreme inputs, then exact search from the states nearest to a violation.

Plain bounded search ends after a few dozen steps. Here a run of hundreds of steps follows one simple habit (inputs
held, the environment always on the same side), so that errors add up. From the states where the property is nearest to
failing, bounded search then looks a few steps further with exact numbers. Every other run continues from a point where
an earlier one reached a new combination of modes and flags. A stream counts only after exact replay, and is shortened
before it is reported.
"""

from __future__ import annotations

import random
from collections.abc import Mapping
from dataclasses import dataclass, replace

import z3

from safeloc.codegen.compiled import Compiled, Row, compile_system
from safeloc.codegen.smt import Unrolling
from safeloc.errors import InputError
from safeloc.language.expr import NumVar, Var
from safeloc.language.machine import Any_
from safeloc.language.nodes import Value
from safeloc.language.spec import Goal
from safeloc.language.units import Enumeration
from safeloc.language.verdict import Unknown, Verdict, Violated
from safeloc.proof.drawn_runs.lawful import Repair, first_state
from safeloc.proof.drawn_runs.profiles import Profile
from safeloc.proof.drawn_runs.slack import Slack
from safeloc.proof.provers.asking import ask, new_solver
from safeloc.proof.provers.limits import Deadline, Limits, deadline, spend
from safeloc.proof.provers.shorten import shortened

LONGEST = 250
_FINISH_STEPS = 6
_FINISH_SECONDS = 1.5
_STARTS = 4
KINDS = ("steady", "steady", "steady", "ends", "standstill", "ramp", "random")
_REPLACED = 0.05
_DRAWN_A_SECOND = 1_000  # steps, drawn and repaired, in a second of effort
Record = dict[str, Value]


def falsify(goal: Goal, limits: Limits, seed: int = 0) -> Verdict:
    """Return Violated with a replayed, shortened trace, or Unknown."""
    if goal.prop.kind == "reachable":
        return Unknown("falsify: looks for violations only")
    ends, search = deadline(limits.seconds), _Search(goal, limits.seed + seed)
    if not search.begins(ends):
        return Unknown("falsify: no first state found that satisfies `initially`")
    runs = 0
    while not ends.passed:
        runs += 1
        found = search.run() or search.finish(ends)
        spend(search.drawn / _DRAWN_A_SECOND)
        if found is not None:
            return Violated(shortened(goal, search.first, found), "falsifier")
    return Unknown(f"falsify: no violation in {runs} runs of up to {LONGEST} steps")


@dataclass(frozen=True)
class _Near:
    """A state of a run, its distance to a violation (`slack`), and the number of steps that led to it."""

    slack: float
    state: Row
    steps: int


@dataclass(frozen=True)
class _Reached:
    """The point of a run at which a combination of modes and flags first occurred."""

    first: Mapping[str, Value]
    stream: tuple[Record, ...]
    state: Row


def _is_quantity(var: Var) -> bool:
    return isinstance(var, NumVar) and not isinstance(var.unit, Enumeration)


class _Search:
    def __init__(self, goal: Goal, seed: int) -> None:
        self.goal, self._draw = goal, random.Random(seed)
        judged = replace(goal.system, outputs={"good": goal.good})
        self._code: Compiled = compile_system(judged)
        self._repair = Repair(goal.system)
        self._unrolling = Unrolling(goal.system)
        self.first: Mapping[str, Value] = {}
        self._stream: list[Record] = []
        self.drawn = 0
        self._near: list[_Near] = []
        self._slack = Slack(goal.good)
        self._archive: dict[Row, _Reached] = {}
        self._known: Record = {}
        self._labels = [n for n, var in enumerate(goal.system.state) if not _is_quantity(var)]

    def begins(self, ends: Deadline) -> bool:
        """Find a first state, at random or else by the solver; return whether there is one."""
        try:
            self._known = first_state(self.goal.system, self._draw)
        except InputError:
            return self._solved(ends)
        return True

    def _solved(self, ends: Deadline) -> bool:
        solver, system = new_solver(), self.goal.system
        solver.add(self._unrolling.initially())
        if ask(solver, ends.left) != z3.sat:
            return False
        open_ = [var for var in system.state if isinstance(system.initial[var], Any_)]
        self._known = self._unrolling.values(solver.model(), 0, open_)
        return True

    def _first(self) -> Mapping[str, Value]:
        try:
            return first_state(self.goal.system, self._draw, adventurous=self._draw.choice((0.0, 0.0, 0.3)))
        except InputError:  # `initially` is too narrow to be met by chance
            return self._known

    def run(self) -> list[Record] | None:
        """Make one run; return its inputs if it breaks the property."""
        habit, left = self._habit()
        state, self.drawn = self._begin(), 1
        while len(self._stream) < LONGEST:
            if not left:
                habit, left = self._habit()
            left -= 1
            inputs, self.drawn = self._lawful(state, habit), self.drawn + 1
            if inputs is None:
                break
            state = self._code.step(state, tuple(inputs[var] for var in self.goal.system.inputs))[0]
            self._stream.append({var.name: inputs[var] for var in self.goal.system.inputs})
            if not self._code.outputs(state)[0]:
                return self._stream
            self._remember(state)
        return None

    def _begin(self) -> Row:
        """Begin in a first state, or where an earlier run reached something new; return that state."""
        self._near = []
        if self._archive and self._draw.random() < 0.5:
            known = self._draw.choice(list(self._archive.values()))
            self.first, self._stream = known.first, list(known.stream)
            return known.state
        hidden = {var.name for var in self.goal.observers}
        chosen = self._first()
        self.first = {name: value for name, value in chosen.items() if name not in hidden}
        self._stream = []
        return self._code.first({**self.first})

    def _habit(self) -> tuple[Profile, int]:
        """Choose a profile of inputs, and the number of steps for which it lasts."""
        kind, length = self._draw.choice(KINDS), self._draw.choice((LONGEST, LONGEST, 60, 20, 5, 1))
        return Profile(self.goal.system, kind, self._draw, self._draw), length

    def _lawful(self, state: Row, habit: Profile) -> dict[Var, Value] | None:
        values = dict(zip(self.goal.system.state, state, strict=True))
        return self._repair.mend(values, habit.inputs(values), self._draw, habit.pick)

    def _remember(self, state: Row) -> None:
        values = dict(zip(self.goal.system.state, state, strict=True))
        distance = self._slack(values)
        self._near.append(_Near(distance, state, len(self._stream)))
        labels = tuple(state[number] for number in self._labels)
        if labels not in self._archive or self._draw.random() < _REPLACED:
            self._archive[labels] = _Reached(self.first, tuple(self._stream), state)

    def finish(self, ends: Deadline) -> list[Record] | None:
        """Search exactly, a few steps from the nearest states of the run and from some others; return a violating
        stream.
        """
        nearest = sorted(self._near, key=lambda near: near.slack)[:2]
        others = self._draw.sample(self._near, min(_STARTS - len(nearest), len(self._near)))
        tail = self._near[-1:]
        for near in dict.fromkeys([*nearest, *tail, *others]):
            if ends.passed:
                return None
            suffix = self._from(near.state, ends)
            if suffix is not None:
                return [*self._stream[: near.steps], *suffix]
        return None

    def _from(self, state: Row, ends: Deadline) -> list[Record] | None:
        solver, ends = new_solver(), deadline(min(_FINISH_SECONDS, ends.left))
        for var, value in zip(self.goal.system.state, state, strict=True):
            solver.add(self._unrolling.at(var, 0) == value)
        for depth in range(1, _FINISH_STEPS + 1):
            solver.add(self._unrolling.transition(depth - 1))
            solver.push()
            solver.add(z3.Not(self._unrolling.at(self.goal.good, depth)))
            answer = ask(solver, ends.left)
            if answer == z3.sat:
                model, inputs = solver.model(), self.goal.system.inputs
                return [self._unrolling.values(model, number, inputs) for number in range(depth)]
            if answer == z3.unknown:
                return None
            solver.pop()
        return None
