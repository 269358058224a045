"""Check of properties at run time and on recordings, by the same Goal that provers use.

Monitor(goal)           checks step by step, beside a running machine
check(trace, property)  checks a recorded trace afterwards
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import NoReturn, TypeAlias, assert_never

from safeloc.errors import TruthValueError
from safeloc.language.antecedents import cases, seen
from safeloc.language.expr import Expr, Var
from safeloc.language.interpret import Program, holds, read_inputs, start
from safeloc.language.nodes import Value
from safeloc.language.spec import Goal, Property, observe, watch
from safeloc.language.system import TransitionSystem, environment
from safeloc.language.trace import Trace
from safeloc.language.verdict import Held, Unknown, Violated

NEVER = "never happened"
"""Key of the note in a verdict Held that names the cases that did not occur in the recording."""


class _NoTruth:
    __slots__ = ()

    def __bool__(self) -> NoReturn:
        raise TruthValueError("a monitor's status has no truth value: match on Holds, Broken or Undecided.")


@dataclass(frozen=True)
class Holds(_NoTruth):
    """The property holds so far; for `reachable`, the state was reached."""


@dataclass(frozen=True)
class Broken(_NoTruth):
    """The property was first violated at this step (0: the first state)."""

    at: int


@dataclass(frozen=True)
class Undecided(_NoTruth):
    """No statement is possible: the assumption was broken at this step, or the wanted state is not reached yet."""

    at: int
    reason: str


Status: TypeAlias = Holds | Broken | Undecided


class Monitor:
    """Checks one property while its system runs. Broken is final, and so is Undecided after a broken assumption."""

    def __init__(self, goal: Goal, first: Mapping[str, Value] | None = None) -> None:
        self.goal, self._number = goal, 0
        self._state: dict[Var, Value] = start(goal.system, first)
        self._moves = Program([environment(goal.system), *goal.system.next.values()])
        self._wanted = goal.prop.kind == "reachable"
        self.status: Status = Undecided(0, "not reached yet") if self._wanted else Holds()
        self._look()

    def step(self, inputs: Mapping[str, object]) -> Status:
        """Check one step with these inputs by name, and return the status; InputError for inputs that the interpreter refuses."""
        self._number += 1
        values = {**self._state, **read_inputs(self.goal.system, inputs)}
        moves = self.goal.system.next
        allowed, *moved = self._moves(values)
        self._state = dict(zip(moves, moved, strict=True))
        if not allowed and not self._settled():
            self.status = Undecided(self._number, "the assumption is broken from here on")
        self._look()
        return self.status

    def _settled(self) -> bool:
        match self.status:
            case Broken():
                return True
            case Undecided(reason=reason):
                return reason.startswith("the assumption")
            case Holds():
                return self._wanted
            case _:
                assert_never(self.status)

    def _look(self) -> None:
        if self._settled() or holds(self.goal.good, self._state):
            return
        self.status = Holds() if self._wanted else Broken(self._number)


def check(trace: Trace, prop: Property) -> Held | Violated | Unknown:
    """Check the property on a recorded trace; Unknown if the trace breaks the assumption first."""
    return check_all(trace, [prop])[0]


def check_all(trace: Trace, properties: Sequence[Property]) -> list[Held | Violated | Unknown]:
    """Check every property on a recorded trace in one pass. A verdict Held names the cases that never happened."""
    return Checks(trace.system, properties)(trace)


Evaluator = Callable[[Mapping[Var, Value]], Sequence[Value]]


@dataclass(frozen=True, eq=False)
class Look:
    """The view that `Checks` has of one state of a run.

    values  whether each property holds, in order, and then whether each of their cases happens
    kept    whether the step into the state kept the assumption of each property
    """

    state: Mapping[Var, Value]
    values: Sequence[Value]
    kept: tuple[bool, ...]


class Checks:
    """Checks properties of a system on recorded traces; `program` turns terms into a function that evaluates them."""

    def __init__(
        self,
        system: TransitionSystem,
        properties: Sequence[Property],
        program: Callable[[Sequence[Expr]], Evaluator] = Program,
    ) -> None:
        self._goals = [observe(system, prop) for prop in properties]
        self._cases = [(n, one) for n, prop in enumerate(properties) for one in cases(prop)]
        observers = [seen(system, one, f"case {number}") for number, (_, one) in enumerate(self._cases)]
        self._watched = watch(system, self._goals).system
        moves = {var: term for one in observers for var, term in one.moves.items()}
        self._first: dict[Var, Value] = dict.fromkeys(moves, False)
        self._moves: dict[Var, Expr] = {**self._watched.next, **moves}
        further = [goal.prop.further_assumption for goal in self._goals]
        self._advance = program([environment(system), *further, *self._moves.values()])
        self._evaluate = program([*(goal.good for goal in self._goals), *(one.term for one in observers)])

    def first(self, initial: Mapping[str, Value]) -> Look:
        """Return the look at the first state; `initial` has its values, at least of the variables that are left open."""
        known = {var.name for var in self._watched.state}
        first = start(self._watched, {name: value for name, value in initial.items() if name in known})
        state: dict[Var, Value] = {**first, **self._first}
        return Look(state, self._evaluate(state), (True,) * len(self._goals))

    def after(self, look: Look, inputs: Mapping[str, object]) -> Look:
        """Return the look at the state after a step with these inputs by name."""
        allowed, *values = self._advance({**look.state, **read_inputs(self._watched, inputs)})
        number = len(self._goals)
        state = dict(zip(self._moves, values[number:], strict=True))
        kept = tuple(bool(values[n] and (allowed or goal.prop.unconditional)) for n, goal in enumerate(self._goals))
        return Look(state, self._evaluate(state), kept)

    def __call__(self, trace: Trace) -> list[Held | Violated | Unknown]:
        """Return one verdict per property. A verdict Held names the cases that never happened."""
        goals = self._goals
        look = self.first({var.name: trace.initial[var.name] for var in trace.system.state})
        rows: list[Sequence[Value]] = [look.values]
        broken_at = [len(trace.steps) + 1] * len(goals)
        for number, step in enumerate(trace.steps, 1):
            look = self.after(look, step.inputs)
            for n, kept in enumerate(look.kept):
                if not kept:
                    broken_at[n] = min(broken_at[n], number)
            rows.append(look.values)
        never: dict[int, list[str]] = {}
        for place, (n, one) in enumerate(self._cases, len(goals)):
            if not any(row[place] for row in rows[: broken_at[n]]):
                never.setdefault(n, []).append(one.words)
        columns = [[row[n] for row in rows] for n in range(len(goals))]
        return [_verdict(trace, goal, columns[n], broken_at[n], never.get(n, [])) for n, goal in enumerate(goals)]


def _verdict(
    trace: Trace, goal: Goal, goods: Sequence[Value], broken_at: int, never: Sequence[str]
) -> Held | Violated | Unknown:
    """Return the verdict on a property from the values of `good` in each state.

    broken_at  the first step that breaks the assumption of the property; later steps are no evidence
    never      the cases of the property that did not happen before that step
    """
    first = next((number for number, good in enumerate(goods[:broken_at]) if not good), None)
    if goal.prop.kind == "reachable":
        return Unknown("not reached in this trace", len(trace.steps)) if first is None else Held("replay", 1, first)
    if first is not None:
        return Violated(Trace(trace.system, trace.initial, trace.steps[:first]), "replay")
    if broken_at < len(goods):
        return Unknown(
            f"the assumption is broken at step {broken_at}; nothing is required from there on", broken_at - 1
        )
    return Held("replay", 1, len(trace.steps), {NEVER: "; ".join(never)} if never else {})
