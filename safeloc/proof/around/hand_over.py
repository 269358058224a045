"""The set of states in which a window of cycles may end, proved, and handed over to the next window.

It is a union of pieces. In each piece modes and flags are constants, as far as there are few combinations of them, and numbers
have ranges. The ranges are those of the folded terms; those of terms that choose among values are narrowed by bisection. Wherever they come from, both solvers then prove that no stream leaves the set.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from safeloc.codegen.simplify_under_facts import Known, implied
from safeloc.codegen.smtlib import Query
from safeloc.errors import EngineError
from safeloc.language.expr import FALSE, Bool, Expr, Lit, Num, NumVar, Var, all_of, any_of
from safeloc.language.interpret import evaluate
from safeloc.language.nodes import Truth, Value
from safeloc.language.ranges import Bounds
from safeloc.language.terms import in_order
from safeloc.proof.around.course import CHOOSING, Course, Piece, within
from safeloc.proof.provers.implication import Refuted, countermodel, unproved
from safeloc.proof.provers.limits import Deadline
from safeloc.proof.provers.linear import constant_of
from safeloc.proof.provers.settle import settled

_MOST_PIECES = 12
"""More combinations of modes and flags than that are joined into one piece."""
_MOST_TRIES = 60
_PRECISION = 20_000
"""A range is narrowed to this share of its first width."""
_VALUE_SECONDS = 2.0
"""Seconds of effort to look for one value."""


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
            self._prove(self.hypotheses, {0: any_of(self._is(one) for one in found)}, "modes and flags")
        return HandedOver([self._piece(one) for one in found], self.texts)

    # -------------------------------------------------------------- modes and flags

    def _combinations(self) -> list[Labels]:
        """Return the combinations of labels that a stream may end with; one more than the most if there are more."""
        found: list[Labels] = []
        while len(found) <= _MOST_PIECES:
            none = all_of(~self._is(one) for one in found)
            values = countermodel(Query("another", self.hypotheses, {0: ~none}), self.ends.left)
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
        ranges = {
            var: self._narrowed(hypotheses, numbers[var], bounds) if self._is_rough(numbers[var]) else bounds
            for var, bounds in sure.items()
        }
        ranges |= {var: sure[var] for var in self._refuted(hypotheses, numbers, ranges)}
        self._prove(hypotheses, self._folded_to(fixed, labels) | _bounded(self._unfolded(numbers), ranges), "ranges")
        return Piece(fixed, ranges)

    def _folded_to(self, fixed: Mapping[Var, Value], labels: Labels) -> dict[str, Bool]:
        """Return the goals that numbers and flags are the constants to which they fold under the labels, by name."""
        open_ = [var for var in fixed if var not in labels and not isinstance(self.state[var], (Lit, Truth))]
        return {f"{var.name} is constant": _equals(self.state[var], fixed[var]) for var in open_}

    def _unfolded(self, numbers: Mapping[NumVar, Num]) -> dict[NumVar, Num]:
        """Return the terms of numbers as they were before they were folded under the labels: those are proved."""
        return {var: term for var in numbers if isinstance(term := self.state[var], Num)}

    def _refuted(
        self, hypotheses: Sequence[Bool], numbers: Mapping[NumVar, Num], ranges: Mapping[NumVar, Bounds]
    ) -> list[NumVar]:
        """Return the numbers whose narrowed ranges some stream leaves: the solver gave up on a value there."""
        by_name = {var.name: var for var in numbers}
        rough = _bounded({var: term for var, term in numbers.items() if self._is_rough(term)}, ranges)
        return (
            [by_name[key] for key in unproved(Query(f"{self.name} narrowed", hypotheses, rough), self.ends.left)]
            if rough
            else []
        )

    def _under(self, labels: Labels) -> dict[Var, Expr]:
        """Return the state with its terms folded under the labels."""
        facts: dict[Expr, Expr] = {}
        for var, value in labels.items():
            term = self.state[var]
            facts |= implied(term, bool(value)) if isinstance(term, Bool) else {term: constant_of(var, value)}
        known = Known(facts, self.course.intervals.decide)
        return {var: known(term) for var, term in self.state.items()}

    def _is_rough(self, term: Num) -> bool:
        """Return whether the bounds of a term may be wider than what streams reach, since it chooses among values."""
        return any(isinstance(node, CHOOSING) for node in in_order([term]))

    def _narrowed(self, hypotheses: Sequence[Bool], term: Num, bounds: Bounds) -> Bounds:
        """Return bounds that some stream reaches, as far as the limits go."""
        low, high = bounds
        reached = self._value(hypotheses, term, FALSE)
        if reached is None:
            return bounds
        near = (high - low) // _PRECISION
        return self._lower(hypotheses, term, low, reached, near), self._upper(hypotheses, term, reached, high, near)

    def _lower(self, hypotheses: Sequence[Bool], term: Num, low: int, reached: int, near: int) -> int:
        """Return the greatest proved lower bound, by bisection between a proved one and a value that is reached."""
        for _ in range(_MOST_TRIES):
            if reached - low <= near or self.ends.passed:
                break
            middle = low if reached - low <= 1 else (low + reached) // 2
            value = self._value(hypotheses, term, term > middle)
            if value is None:
                low = middle + 1
            else:
                reached = min(reached, value)
        return low

    def _upper(self, hypotheses: Sequence[Bool], term: Num, reached: int, high: int, near: int) -> int:
        for _ in range(_MOST_TRIES):
            if high - reached <= near or self.ends.passed:
                break
            middle = high if high - reached <= 1 else (reached + high + 1) // 2
            value = self._value(hypotheses, term, term < middle)
            if value is None:
                high = middle - 1
            else:
                reached = max(reached, value)
        return high

    def _value(self, hypotheses: Sequence[Bool], term: Num, unless: Bool) -> int | None:
        """Return the value of a term in some stream in which the condition is false; None if there seems to be none."""
        values = countermodel(Query("a value", hypotheses, {0: unless}), min(_VALUE_SECONDS, self.ends.left))
        if values is None:
            return None
        return int(self._evaluated(term, values))

    def _evaluated(self, term: Num, values: Mapping[Var, Value]) -> Value:
        (value,) = evaluate([term], self.course.with_rest(values))
        return value

    # -------------------------------------------------------------- proofs

    def _prove(self, hypotheses: Sequence[Bool], goals: Mapping[Any, Bool], what: str) -> None:
        """Let both solvers prove the goals; EngineError if one does not follow: then the set was computed wrongly."""
        asked = settled(Query(f"{self.name} {what}", hypotheses, goals), self.ends)
        wrong = [f"{key}: {why}" for key, why in asked.failed.items() if isinstance(why, Refuted)]
        if wrong and what != "modes and flags":
            raise EngineError(
                f"{self.name}: a stream leaves the states handed over: {wrong[0]}. Do not use this result; report it."
            )
        if asked.failed:
            raise UnsettledError(f"{self.name}, {what}: {next(iter(asked.failed.values()))}")
        self.texts |= asked.texts


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
