"""Shorter and simpler counterexamples: steps are left out, inputs made absent or put to rest, as long as the property
fails.

Candidates run on generated code; the result is the interpreter's exact replay.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence

from safeloc.codegen.compiled import compile_terms
from safeloc.errors import EngineError
from safeloc.language.expr import NumVar, Var
from safeloc.language.interpret import start
from safeloc.language.nodes import Value
from safeloc.language.spec import Goal
from safeloc.language.system import TransitionSystem, canonical, environment
from safeloc.language.trace import Trace
from safeloc.proof.provers.limits import Deadline, deadline, spend
from safeloc.proof.provers.replayed_evidence import replayed

SECONDS = 3.0
_TRIED_A_SECOND = 20_000  # steps of generated code in a second of effort
Record = dict[str, Value]
Breaks = Callable[[Sequence[Record]], int | None]


def shortened(
    goal: Goal, first: Mapping[str, Value], stream: Sequence[Mapping[str, Value]], seconds: float = SECONDS
) -> Trace:
    """Return the replayed run with as much left out as the time allows; EngineError if the given run does not replay.

    stream   values of all inputs in every step, presence flags included
    """
    breaks, ends = _judge(goal, first), deadline(seconds)
    kept = [dict(record) for record in stream]
    kept = kept[: breaks(kept) or 0]
    before = None
    while before != len(kept) and not ends.passed:
        before = len(kept)
        kept = _without_stretches(kept, breaks, ends)
        kept = _at_rest(goal.system, kept, breaks, ends)
    trace = replayed(goal, first, kept)
    if trace is None:
        raise EngineError(f"a run found for {goal.prop.name!r} does not break it in the interpreter.")
    return trace


def rested(
    goal: Goal, first: Mapping[str, Value], stream: Sequence[Mapping[str, Value]], seconds: float = SECONDS
) -> Trace:
    """Return the run up to the step that breaks the property, with inputs put to rest as far as the time allows; no step is left out.

    EngineError if the given run does not replay.
    """
    breaks, ends = _judge(goal, first), deadline(seconds)
    kept = [dict(record) for record in stream]
    kept = _at_rest(goal.system, kept[: breaks(kept) or 0], breaks, ends)
    trace = replayed(goal, first, kept)
    if trace is None:
        raise EngineError(f"a run found for {goal.prop.name!r} does not break it in the interpreter.")
    return trace


def _judge(goal: Goal, first: Mapping[str, Value]) -> Breaks:
    """Make a function that counts the steps until a stream breaks the property.

    It returns None if the stream never does, or if it breaks the assumption before.
    """
    system = goal.system
    move = compile_terms(
        (*system.state, *system.inputs), [environment(system), *(system.next[var] for var in system.state)]
    )
    good = compile_terms(system.state, [goal.good])
    names = [var.name for var in system.inputs]
    begin = tuple(start(system, dict(first)).values())

    def breaks(stream: Sequence[Record]) -> int | None:
        spend((len(stream) + 1) / _TRIED_A_SECOND)
        state: Sequence[Value] = begin
        if not good(state)[0]:
            return 0
        for number, record in enumerate(stream, 1):
            allowed, *state = move((*state, *(record[name] for name in names)))
            if not allowed:
                return None
            if not good(state)[0]:
                return number
        return None

    return breaks


def _without_stretches(kept: list[Record], breaks: Breaks, ends: Deadline) -> list[Record]:
    size = len(kept) // 2
    while size and not ends.passed:
        for begin in range(0, len(kept) - size + 1, size):
            trial = [*kept[:begin], *kept[begin + size :]]
            steps = breaks(trial)
            if steps is not None:
                kept = trial[:steps]
                break
        else:
            size //= 2
    return kept


def _at_rest(system: TransitionSystem, kept: list[Record], breaks: Breaks, ends: Deadline) -> list[Record]:
    """Make each input absent, false or nearest to zero: in the whole run if possible, else in parts of it."""
    for change in _changes(system):
        for begin, end in _halves(0, len(kept)):
            if ends.passed:
                return kept
            trial = [{**record, **change} if begin <= n < end else record for n, record in enumerate(kept)]
            if trial != kept and breaks(trial) == len(kept):
                kept = trial
    return kept


def _changes(system: TransitionSystem) -> Iterator[Record]:
    optional: set[Var] = set()
    for option in system.optionals:
        optional |= {option.value, option.present}
        yield {option.present.name: False, option.value.name: canonical(option.value)}
    for var in system.inputs:
        if var not in optional:
            yield {var.name: canonical(var) if isinstance(var, NumVar) else False}


def _halves(begin: int, end: int) -> Iterator[tuple[int, int]]:
    """Yield the whole interval, then its halves, quarters and eighths."""
    pieces = [(begin, end)]
    for _ in range(4):
        yield from pieces
        middle = [(low, (low + high) // 2, high) for low, high in pieces if high - low > 1]
        pieces = [piece for low, mid, high in middle for piece in ((low, mid), (mid, high))]
