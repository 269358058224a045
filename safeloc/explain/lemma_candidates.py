"""Lemmas that would make a property inductive, found by trying: simple conditions that hold in drawn runs, kept as far as they are
inductive together (Houdini), of which those are named that the proof of the property needs.

A candidate is of one of these forms, over the variables of the machine and of its world:

    x >= a,  x <= a                        a tighter range
    mode = M implies x = a                 a value that a mode fixes
    mode = M implies flag,  ... ~flag
    x = y,  x <= y                         two variables of one unit
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

from safeloc.codegen.smtlib import Query
from safeloc.language.expr import Bool, BoolVar, Lit, NumVar, Var
from safeloc.language.interpret import Program, start, step
from safeloc.language.nodes import Value
from safeloc.language.spec import Goal
from safeloc.language.system import TransitionSystem
from safeloc.language.terms import variables
from safeloc.language.units import Enumeration
from safeloc.proof.drawn_runs.lawful import Repair, first_state
from safeloc.proof.drawn_runs.profiles import PLAUSIBLE, Profile
from safeloc.proof.provers.implication import unproved
from safeloc.proof.provers.kinduction import queries
from safeloc.proof.provers.limits import Deadline, Limits, deadline
from safeloc.proof.provers.proved_base import Base, base, inductive_beside

_RUNS, _STEPS, _STRETCH = 12, 60, 12
_MOST_PAIRS = 24
"""Most numeric variables that are compared with each other."""
_MOST = 400
"""Most candidates that are tried together."""

State = dict[Var, Value]


@dataclass(frozen=True)
class Tried:
    """Counts of candidates: those that held in the drawn runs, those of them that are inductive together, and those that
    prove the property.

    needed  None if the property is not proved with them either
    """

    held: int
    inductive: int
    needed: tuple[Bool, ...] | None


def tried_lemmas(goal: Goal, limits: Limits) -> Tried:
    """Try candidates for a property that is not inductive by itself, within the limits' seconds of effort."""
    system, ends = goal.original, deadline(limits.seconds)
    known = base(system, seconds=limits.seconds)
    states = list(_drawn_states(system, limits.seed))
    held = _holding(list(_candidates(system, states)), states)[:_MOST]
    kept = inductive_beside(system, known, held, limits.seconds, unconditional=goal.prop.unconditional)
    return Tried(len(held), len(kept), _needed(goal, known, kept, limits, ends))


# ------------------------------------------------------------------ candidates


def _drawn_states(system: TransitionSystem, seed: int) -> Iterator[State]:
    """Yield the states of lawful drawn runs."""
    for number in range(_RUNS):
        draw = random.Random(f"{seed} {number}")
        state, repair = start(system, first_state(system, draw)), Repair(system)
        yield state
        profile = Profile(system, "steady", draw)
        for count in range(_STEPS):
            if count % _STRETCH == 0:
                profile = Profile(system, draw.choice(PLAUSIBLE), draw)
            inputs = profile.inputs(state)
            mended = None if inputs is None else repair.mend(state, inputs, draw, profile.pick)
            if mended is None:
                break
            state, _ = step(system, state, mended)
            yield state


def _candidates(system: TransitionSystem, states: Sequence[State]) -> Iterator[Bool]:
    numbers = [var for var in system.state if isinstance(var, NumVar) and not isinstance(var.unit, Enumeration)]
    labels = [var for var in system.state if isinstance(var, NumVar) and isinstance(var.unit, Enumeration)]
    flags = [var for var in system.state if isinstance(var, BoolVar)]
    yield from _ranges(numbers, states)
    yield from _pairs(numbers[:_MOST_PAIRS])
    for mode in (var for var in labels if var.name.split(".")[-1] == "mode"):
        yield from _in_modes(mode, [*numbers, *(one for one in labels if one is not mode)], flags, states)


def _ranges(numbers: Sequence[NumVar], states: Sequence[State]) -> Iterator[Bool]:
    """Yield the least and the greatest value seen, where the declared range is wider."""
    for var in numbers:
        seen = [int(state[var]) for state in states]
        if min(seen) > var.low:
            yield var >= Lit(min(seen), var.unit)
        if max(seen) < var.high:
            yield var <= Lit(max(seen), var.unit)


def _pairs(numbers: Sequence[NumVar]) -> Iterator[Bool]:
    for one, other in combinations(numbers, 2):
        if one.unit == other.unit:
            yield one.eq(other)
            yield one <= other
            yield other <= one


def _in_modes(
    mode: NumVar, numbers: Sequence[NumVar], flags: Sequence[BoolVar], states: Sequence[State]
) -> Iterator[Bool]:
    """Yield what is the same in all states seen in a mode."""
    assert isinstance(mode.unit, Enumeration)
    for number in range(len(mode.unit.members)):
        seen = [state for state in states if state[mode] == number]
        in_mode = mode.eq(Lit(number, mode.unit))
        for var in numbers:
            if len(values := {int(state[var]) for state in seen}) == 1:
                yield in_mode.implies(var.eq(Lit(values.pop(), var.unit)))
        for flag in flags:
            if len(truths := {bool(state[flag]) for state in seen}) == 1:
                yield in_mode.implies(flag if truths.pop() else ~flag)


def _holding(candidates: Sequence[Bool], states: Sequence[State]) -> list[Bool]:
    """Return the candidates that hold in all states, without those that are constant."""
    open_ = [one for one in dict.fromkeys(candidates) if list(variables([one]))]
    program = Program(open_)
    left = set(range(len(open_)))
    for state in states:
        values = program(state)
        left = {number for number in left if values[number]}
    return [open_[number] for number in sorted(left)]


# ------------------------------------------------------------------ the proof with them


def _needed(goal: Goal, known: Base, lemmas: Sequence[Bool], limits: Limits, ends: Deadline) -> tuple[Bool, ...] | None:
    """Return lemmas of which none can be left out, with which the property is inductive over one step; None without such."""
    if not lemmas or not _proves(goal, known, lemmas, limits, ends):
        return None
    needed = list(lemmas)
    for one in lemmas:
        fewer = [other for other in needed if other is not one]
        if not ends.passed and _proves(goal, known, fewer, limits, ends):
            needed = fewer
    return tuple(needed)


def _proves(goal: Goal, known: Base, lemmas: Sequence[Bool], limits: Limits, ends: Deadline) -> bool:
    start_, later = queries(goal, known, 1)
    return all(not unproved(_with(query, lemmas), ends.left, limits.seed) for query in (start_, later))


def _with(query: Query[str], lemmas: Sequence[Bool]) -> Query[str]:
    return replace(query, hypotheses=[*query.hypotheses, *lemmas])
