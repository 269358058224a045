"""Streams of a tube that obey the laws of the world, with the truth beside them; or the cycle from which on there is none."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from safeloc.codegen.smtlib import Query
from safeloc.language.expr import FALSE, Var, all_of
from safeloc.language.first_values import Any_
from safeloc.language.interpret import evaluate, holds, start, stepped
from safeloc.language.nodes import Value
from safeloc.language.system import TransitionSystem, environment
from safeloc.proof.around.broken_runs import open_first
from safeloc.proof.around.course import Course, Piece, Space, first_piece
from safeloc.proof.around.hand_over import UnsettledError, hand_over
from safeloc.proof.around.tube import Given
from safeloc.proof.cores.clauses import ClauseId, assumed_clauses
from safeloc.proof.provers.implication import countermodel
from safeloc.proof.provers.limits import Limits, deadline
from safeloc.proof.provers.settle import settled

_STEP, _AHEAD = 10, 20
"""Cycles of which values are kept, and those that are looked at beyond them: a truth that is lawful now may have no way on."""
_PATIENCE = 3


@dataclass(frozen=True, eq=False)
class Member:
    """A stream with the truth that the world's laws allow: the first state, and all inputs of each cycle."""

    first: Mapping[Var, Value]
    stream: Sequence[Mapping[Var, Value]]


@dataclass(frozen=True)
class Empty:
    """No stream of the tube obeys the laws up to the end of this cycle, proved; `laws` exclude it together."""

    cycle: int
    laws: tuple[str, ...]


def as_recorded(system: TransitionSystem, given: Given) -> Member | None:
    """Return the inputs of a stream with the truth that was recorded beside them, as far as the stream goes; None if none was."""
    if not given.choices and any(var in system.ghosts for var in system.inputs):
        return None
    choices = given.choices[: given.length] or [{} for _ in given.rows]
    ghosts = given.ghosts[0] if given.ghosts else {}
    first = start(system, open_first(system, {**given.first, **ghosts}))
    return Member(first, [{**row, **truth} for row, truth in zip(given.rows, choices, strict=True)])


def as_steps(system: TransitionSystem, found: Member) -> tuple[dict[str, Value], list[dict[str, Value]]]:
    """Return the first values of open variables and the inputs of each cycle by name, as a recording holds them."""
    first = {var.name: found.first[var] for var in system.state if isinstance(system.initial[var], Any_)}
    present: dict[Var, Var] = {one.value: one.present for one in system.optionals}
    flags = set(present.values())
    steps = [
        {var.name: row[var] for var in system.inputs if var not in flags and (var not in present or row[present[var]])}
        for row in found.stream
    ]
    return first, steps


def first_unlawful(system: TransitionSystem, member: Member) -> int | None:
    """Return the first cycle in which a stream breaks a law or a range, 0 for the first state; None if it does not."""
    state = dict(member.first)
    if not holds(system.init, state):
        return 0
    lawful = sum(1 for _ in stepped(system, state, member.stream, while_=environment(system)))
    return None if lawful == len(member.stream) else lawful + 1


def member(space: Space, limits: Limits, cycles: int) -> Member | None:
    """Return a lawful stream of the tube over so many cycles; None if the search finds none, which proves nothing.

    Values are chosen some cycles at a time. Where that comes to an end, it looks farther ahead from an earlier place.
    """
    piece, at, ahead = first_piece(space), 0, _AHEAD
    kept: list[tuple[int, Piece, list[Mapping[Var, Value]]]] = []
    first: Mapping[Var, Value] | None = None
    stream: list[Mapping[Var, Value]] = []
    patience = _PATIENCE
    while at < cycles or first is None:
        course = Course(space, piece, at).to(min(cycles, at + _STEP + ahead))
        values = _some(course, limits)
        if values is None:
            if not patience or not kept:
                return None
            patience, ahead = patience - 1, 3 * ahead
            at, piece, stream = kept[max(0, len(kept) - ahead // _STEP)]
            kept = kept[: max(0, len(kept) - ahead // _STEP)]
            continue
        kept.append((at, piece, list(stream)))
        first = course.first_state(values) if at == 0 else first
        to = cycles if course.end == cycles else at + _STEP
        stream = [*stream, *course.stream(values, to - at)]
        piece, at = Piece(_state(course, values, to)), to
    return Member(first, stream)


def _some(course: Course, limits: Limits) -> dict[Var, Value] | None:
    if course.dead:
        return None
    query = Query("a lawful stream", course.hypotheses(course.end), {0: FALSE})
    return countermodel(query, limits.seconds)


def _state(course: Course, values: Mapping[Var, Value], cycle: int) -> dict[Var, Value]:
    terms = course.states[cycle - course.begin]
    return dict(zip(terms, evaluate(list(terms.values()), course.with_rest(values)), strict=True))


def emptied(space: Space, limits: Limits) -> Empty | None:
    """Return the first cycle through which no stream of the tube comes, proved by both solvers; None if none is proved."""
    pieces: Sequence[Piece] = [first_piece(space)]
    at = 0
    while at < space.tube.length:
        to = min(space.tube.length, at + _AHEAD)
        courses = [Course(space, piece, at).to(to) for piece in pieces]
        if all(_some(course, limits) is None for course in courses):
            for cycle in range(at + 1, to + 1):
                if all(_none(space, piece, at, cycle, limits) for piece in pieces):
                    return Empty(cycle, _culprits(space, pieces, at, cycle, limits))
            return None
        try:
            made = [hand_over(one, deadline(limits.seconds), f"{space.system.name} alive {to}") for one in courses]
        except UnsettledError:
            return None
        pieces, at = [piece for one in made for piece in one.pieces], to
    return None


def _none(space: Space, piece: Piece, at: int, cycle: int, limits: Limits) -> bool:
    """Return whether it is proved that no stream comes from a piece through a cycle."""
    course = Course(space, piece, at).to(cycle)
    name = f"{space.system.name} is empty in cycle {cycle}"
    return not settled(Query(name, course.hypotheses(course.end), {0: FALSE}), deadline(limits.seconds)).failed


def _culprits(space: Space, pieces: Sequence[Piece], at: int, cycle: int, limits: Limits) -> tuple[str, ...]:
    """Return laws that leave no stream, none of which can be taken out; each is left out in turn."""
    left = list(assumed_clauses(space.system))
    out: list[ClauseId] = []
    for law in list(left):
        fewer = replace(space, system=_assuming(space.system, [one for one in left if one != law]))
        if all(_none(fewer, piece, at, cycle, limits) for piece in pieces):
            left.remove(law)
            out.append(law)
    names = str if space.system.parts else (lambda law: law.name)
    return tuple(names(law) for law in left)


def _assuming(system: TransitionSystem, kept: Sequence[ClauseId]) -> TransitionSystem:
    every = assumed_clauses(system)
    return replace(system, assume=all_of(every[law] for law in kept))
