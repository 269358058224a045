"""Counterexamples and witnesses of solvers: they count only after exact replay in the interpreter."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from safeloc.errors import EngineError, InputError
from safeloc.language.interpret import Values, evaluate, holds, named, start, taken
from safeloc.language.nodes import Value
from safeloc.language.spec import Goal, Watch
from safeloc.language.system import TransitionSystem, environment
from safeloc.language.trace import Step, Trace


def replayed(goal: Goal, first: Mapping[str, Value], stream: Iterable[Mapping[str, object]]) -> Trace | None:
    """Return the run up to the first step in which `good` fails; None if it never does or the assumption is broken
    before.
    """
    system, hidden = goal.system, frozenset(goal.observers)
    state, steps = start(system, first), list[Step]()
    initial = named(state, hidden)
    if not holds(goal.good, state):
        return Trace(goal.plain, initial, ())
    for one, after in taken(system, state, stream, while_=environment(system), hidden=hidden):
        steps.append(one)
        if not holds(goal.good, after):
            return Trace(goal.plain, initial, tuple(steps))
    return None


def admissible_run(
    system: TransitionSystem, first: Mapping[str, Value], stream: Sequence[Mapping[str, object]]
) -> Trace:
    """Return the run; EngineError if it breaks the assumption or a range."""
    try:
        state = start(system, first)
        steps = tuple(one for one, _ in taken(system, state, stream, while_=environment(system)))
    except InputError as error:
        raise EngineError(f"a run of {system.name} that a solver found is not admissible: {error}") from error
    if len(steps) < len(stream):
        raise EngineError(f"a run of {system.name} that a solver found breaks the assumption in step {len(steps) + 1}.")
    return Trace(system, named(state), steps)


def confirmed(goal: Goal, first: Mapping[str, Value], stream: Iterable[Mapping[str, object]], engine: str) -> Trace:
    """Return the replayed run; EngineError if the interpreter does not confirm what the engine claims."""
    try:
        trace = replayed(goal, first, stream)
    except InputError as error:
        raise EngineError(f"{engine}: its stream for {goal.prop.name!r} is not admissible: {error}") from error
    if trace is None:
        raise _unbroken(engine, goal)
    return trace


def confirmed_together(
    watched: Watch,
    goals: Sequence[Goal],
    first: Mapping[str, Value],
    stream: Iterable[Mapping[str, object]],
    engine: str,
) -> dict[Goal, Trace]:
    """Return what `confirmed` returns for each of these goals of a Watch, of which one run breaks all: it is replayed once."""
    hidden, steps, ends = frozenset(watched.observers), list[Step](), dict[Goal, int]()
    try:
        state = start(watched.system, first)
        run = taken(watched.system, state, stream, while_=environment(watched.system), hidden=hidden)
        for number, after in enumerate(_noted(state, run, steps)):
            kept = evaluate([goal.good for goal in goals], after)
            ends |= {goal: number for goal, one in zip(goals, kept, strict=True) if not one and goal not in ends}
    except InputError as error:
        raise EngineError(f"{engine}: its stream for {watched.system.name} is not admissible: {error}") from error
    for goal in goals:
        if goal not in ends:
            raise _unbroken(engine, goal)
    return {goal: Trace(goal.plain, named(state, hidden), tuple(steps[: ends[goal]])) for goal in goals}


def _unbroken(engine: str, goal: Goal) -> EngineError:
    return EngineError(f"{engine}: its stream for {goal.prop.name!r} does not break the property in the interpreter.")


def _noted(first: Values, run: Iterable[tuple[Step, Values]], steps: list[Step]) -> Iterator[Values]:
    """Yield the first state and those after the steps of a run, which are added to `steps`."""
    yield first
    for one, after in run:
        steps.append(one)
        yield after
