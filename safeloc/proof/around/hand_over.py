"""The set of states in which a window of cycles may end, proved, and handed over to the next window.

It is a union of pieces. In each piece modes and flags are constants, as far as there are few combinations of them, and numbers
have ranges. The ranges are those of the folded terms; those of terms that choose among values are narrowed (narrowing.py). Wherever they come from, both solvers then prove that no stream leaves the set.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

from safeloc.codegen.simplify_under_facts import Known, implied
from safeloc.codegen.smtlib import Query
from safeloc.errors import EngineError
from safeloc.language.expr import Bool, Expr, Lit, Num, NumVar, Var, all_of, any_of
from safeloc.language.nodes import Truth, Value
from safeloc.language.ranges import Bounds
from safeloc.language.terms import in_order
from safeloc.language.units import Enumeration
from safeloc.proof.around.course import CHOOSING, Course, Piece, within
from safeloc.proof.around.narrowing import Narrowing
from safeloc.proof.provers.implication import Refuted
from safeloc.proof.provers.limits import Deadline, deadline
from safeloc.proof.provers.linear import constant_of
from safeloc.proof.provers.models import GaveUpError, Models
from safeloc.proof.provers.settle import settled

_MOST_PIECES = 12
"""More combinations of modes and flags than that are joined into one piece."""
_NARROWED_SECONDS, _CONFIRMING_SECONDS = 4.0, 1.0
"""Seconds of effort of z3 for all ranges that were narrowed, and of the second solver for each: where they take longer, the bounds of terms are
handed over.
"""


class UnsettledError(Exception):
    """The solvers do not settle a question within the limits."""


@dataclass(frozen=True, eq=False)
class HandedOver:
    """The pieces, and the certificates that no stream leaves them."""

    pieces: Sequence[Piece]
    texts: Mapping[str, str]


Labels = Mapping[Var, Value]


def hand_over(course: Course, ends: Deadline, name: str) -> HandedOver:
    """Return the proved set of states at the end of a course; no piece if no stream comes so far. UnsettledError if undecided."""
    return _Ending(course, ends, name).handed_over()


@dataclass(eq=False)
class _Ending:
    course: Course
    ends: Deadline
    name: str

    def __post_init__(self) -> None:
        self.state = self.course.states[-1]
        self.hypotheses = self.course.hypotheses(self.course.end)
        self.texts: dict[str, str] = {}
        self.labels = [
            var
            for var, term in self.state.items()
            if self.course.space.tells_apart(var) and not isinstance(term, (Lit, Truth))
        ]

    def handed_over(self) -> HandedOver:
        if self.course.dead:
            return HandedOver((), {})
        found = self._combinations() if self.labels else [{}]
        if len(found) > _MOST_PIECES:
            return HandedOver([self._piece({})], self.texts)
        if self.labels:
            self._prove(self.hypotheses, {"one of them": any_of(self._is(one) for one in found)}, "modes and flags")
        return HandedOver([self._piece(one) for one in found], self.texts)

    # -------------------------------------------------------------- modes and flags

    def _combinations(self) -> list[Labels]:
        """Return the combinations of labels that a stream may end with; one more than the most if there are more."""
        models = Models(self.hypotheses, [self.state[var] for var in self.labels])
        found: list[Labels] = []
        while len(found) <= _MOST_PIECES:
            try:
                values = models.in_which(all_of(~self._is(one) for one in found), self.ends.left)
            except GaveUpError:  # there may be more: the proof that these are all of them decides
                break
            if values is None:
                break
            last = self.course.last_state(values)
            found.append({var: last[var] for var in self.labels})
        return found

    def _is(self, labels: Labels) -> Bool:
        return all_of(_equals(self.state[var], value) for var, value in labels.items())

    # -------------------------------------------------------------- numbers

    def _piece(self, labels: Labels) -> Piece:
        """Return the states with these labels."""
        state = self._under(labels)
        fixed: dict[Var, Value] = {var: term.value for var, term in state.items() if isinstance(term, (Lit, Truth))}
        fixed |= labels
        numbers = {
            var: term
            for var, term in state.items()
            if isinstance(var, NumVar) and var not in fixed and isinstance(term, Num)
        }
        hypotheses = [*self.hypotheses, self._is(labels)]
        sure = {var: _kept(var, self.course.intervals(term)) for var, term in numbers.items()}
        rough = {var: term for var, term in numbers.items() if self._is_rough(term)}
        ranges = {**sure, **Narrowing(self.course, hypotheses, rough, sure, self.ends).ranges()}
        constants, whole = self._folded_to(fixed, labels), self._unfolded(numbers)
        left = self._prove(
            hypotheses, constants | _bounded(whole, ranges), "ranges", perhaps={var.name for var in rough}
        )
        if left:
            ranges |= {var: sure[var] for var in rough if var.name in left}
            self._prove(hypotheses, constants | _bounded(whole, ranges), "ranges")
        return Piece(fixed, ranges)

    def _folded_to(self, fixed: Mapping[Var, Value], labels: Labels) -> dict[str, Bool]:
        """Return the goals that numbers and flags are the constants to which they fold under the labels, by name."""
        open_ = [var for var in fixed if var not in labels and not isinstance(self.state[var], (Lit, Truth))]
        return {f"{var.name} is constant": _equals(self.state[var], fixed[var]) for var in open_}

    def _unfolded(self, numbers: Mapping[NumVar, Num]) -> dict[NumVar, Num]:
        """Return the terms of numbers as they were before they were folded under the labels: those are proved."""
        return {var: term for var in numbers if isinstance(term := self.state[var], Num)}

    def _under(self, labels: Labels) -> dict[Var, Expr]:
        """Return the state with its terms folded under the labels."""
        facts: dict[Expr, Expr] = {}
        for var, value in labels.items():
            term = self.state[var]
            facts |= implied(term, bool(value)) if isinstance(term, Bool) else {term: constant_of(var, value)}
        known = Known(facts, self.course.intervals.decide)
        return {var: known(term) for var, term in self.state.items()}

    def _is_rough(self, term: Num) -> bool:
        """Return whether the bounds of a number may be wider than what streams reach, since it chooses among values.

        Members of an enumeration have no order: where modes are not told apart, any of them that the term allows is handed over.
        """
        return not isinstance(term.unit, Enumeration) and any(isinstance(node, CHOOSING) for node in in_order([term]))

    # -------------------------------------------------------------- proofs

    def _prove(
        self, hypotheses: Sequence[Bool], goals: Mapping[str, Bool], what: str, *, perhaps: Collection[str] = ()
    ) -> set[str]:
        """Let both solvers prove the goals; return those that do not follow, which only those in `perhaps` may do.

        A range may be narrowed too far where the solver gave up on a value. EngineError if a stream refutes another goal: then the set was
        computed wrongly.
        """
        ends = deadline(min(_NARROWED_SECONDS, self.ends.left)) if perhaps else self.ends
        confirming = _CONFIRMING_SECONDS if perhaps else math.inf
        asked = settled(Query(f"{self.name} {what}", hypotheses, goals), ends, confirming=confirming)
        open_ = {key: why for key, why in asked.failed.items() if key not in perhaps}
        wrong = [f"{key}: {why}" for key, why in open_.items() if isinstance(why, Refuted)]
        if wrong and what != "modes and flags":
            raise EngineError(
                f"{self.name}: a stream leaves the states handed over: {wrong[0]}. Do not use this result; report it."
            )
        if open_ and not perhaps:
            raise UnsettledError(f"{self.name}, {what}: {next(iter(open_.values()))}")
        self.texts |= asked.texts
        return set(asked.failed)


def _bounded(numbers: Mapping[NumVar, Num], ranges: Mapping[NumVar, Bounds]) -> dict[str, Bool]:
    """Return the goals that numbers are in their ranges, by name."""
    goals = {var.name: within(numbers[var], ranges[var]) for var in numbers}
    return {key: goal for key, goal in goals.items() if not isinstance(goal, Truth)}


def _equals(term: Expr, value: Value) -> Bool:
    if isinstance(term, Num):
        return term.eq(Lit(int(value), term.unit))
    assert isinstance(term, Bool)
    return term if value else ~term


def _kept(var: NumVar, bounds: Bounds) -> Bounds:
    """Return the bounds as the terms give them; one that cannot be (a contradiction) becomes the declared range."""
    return bounds if bounds[0] <= bounds[1] else (var.low, var.high)


def joined(pieces: Sequence[Piece], labels: Sequence[Var]) -> list[Piece]:
    """Return the pieces, those with the same labels joined to one that holds both."""
    groups: dict[tuple[object, ...], list[Piece]] = {}
    for piece in pieces:
        key = tuple(piece.fixed.get(var) for var in labels)
        groups.setdefault(key, []).append(piece)
    return [_hull(group) for group in groups.values()]


def _hull(pieces: Sequence[Piece]) -> Piece:
    """Return the least piece of this form that holds all of them."""
    first, *others = pieces
    for other in others:
        first = _both(first, other)
    return first


def _both(one: Piece, other: Piece) -> Piece:
    ranges: dict[NumVar, Bounds] = {}
    for var in dict.fromkeys([*one.fixed, *one.ranges, *other.fixed, *other.ranges]):
        if isinstance(var, NumVar) and not (var in one.fixed and one.fixed[var] == other.fixed.get(var)):
            (low, high), (least, most) = _of(one, var), _of(other, var)
            ranges[var] = min(low, least), max(high, most)
    fixed = {var: value for var, value in one.fixed.items() if var in other.fixed and other.fixed[var] == value}
    return replace(one, fixed=fixed, ranges=ranges)


def _of(piece: Piece, var: NumVar) -> Bounds:
    if var in piece.fixed:
        return int(piece.fixed[var]), int(piece.fixed[var])
    return piece.ranges.get(var, (var.low, var.high))
