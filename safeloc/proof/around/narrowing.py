"""Ranges of numbers, narrowed to about what streams reach. They are proposals: the hand-over proves them.

A bound is first looked for where one of the values has its own among which a term chooses, since most are reached there; then by
bisection. Every stream that is found shows what it reaches of all numbers.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass

from safeloc.language.expr import TRUE, Bool, Num, NumVar
from safeloc.language.interpret import evaluate
from safeloc.language.nodes import Choose, Max, Min
from safeloc.language.ranges import Bounds
from safeloc.proof.around.course import Course
from safeloc.proof.provers.limits import Deadline
from safeloc.proof.provers.models import GaveUpError, Models

_PRECISION = 1_000_000
"""A range is narrowed to this share of its first width."""
_VALUE_SECONDS = 2.0
"""Seconds of effort to look for one value."""


@dataclass(eq=False)
class Narrowing:
    """Numbers at the end of a course, under conditions.

    numbers  the terms whose ranges are narrowed
    sure     bounds that hold of them
    """

    course: Course
    conditions: Sequence[Bool]
    numbers: Mapping[NumVar, Num]
    sure: Mapping[NumVar, Bounds]
    ends: Deadline

    def __post_init__(self) -> None:
        self._models = Models(self.conditions, list(self.numbers.values()))
        self._reached: dict[NumVar, Bounds] = {}

    def ranges(self) -> dict[NumVar, Bounds]:
        """Return ranges within the sure ones; these themselves if no stream is found."""
        try:
            found = bool(self.numbers) and self._finds(TRUE)
        except GaveUpError:
            found = False
        if not found:
            return {var: self.sure[var] for var in self.numbers}
        return {var: (-self._most(var, -1), self._most(var, 1)) for var in self.numbers}

    def _most(self, var: NumVar, sign: int) -> int:
        """Return the least upper bound that is found of a number (with sign -1: of its negative): no stream goes above it.

        Where a question is too hard, it is the least one so far.
        """
        low, high = self.sure[var]
        most = high if sign > 0 else -low
        with suppress(GaveUpError):
            for bound in self._bounds(var, sign, most, (high - low) // _PRECISION):
                most = bound
        return most

    def _bounds(self, var: NumVar, sign: int, most: int, near: int) -> Iterator[int]:
        """Yield ever lower upper bounds, the last one at most `near` above what some stream reaches."""
        ends = sorted({end for end in self._ends(var, sign) if end < most}, reverse=True)
        while ends:  # which of them is the least that no stream goes beyond?
            ends = [end for end in ends if end >= self._reached_most(var, sign)]
            middle = len(ends) // 2
            if ends and not self._goes_beyond(var, sign, ends[middle]):
                most, ends = ends[middle], ends[middle + 1 :]
                yield most
        reached = self._reached_most(var, sign)
        ends = [most - 1, reached + near] if most - reached > near else []
        if ends and not any(self._goes_beyond(var, sign, end) for end in ends):
            yield reached + near
            return
        while most - self._reached_most(var, sign) > near:
            middle = (most + self._reached_most(var, sign)) // 2
            if not self._goes_beyond(var, sign, middle):
                most = middle
                yield most

    def _ends(self, var: NumVar, sign: int) -> Iterator[int]:
        """Yield the upper bounds of the values among which a number chooses."""
        for value in _chosen(self.numbers[var]):
            low, high = self.course.intervals(value)
            yield high if sign > 0 else -low

    def _reached_most(self, var: NumVar, sign: int) -> int:
        least, most = self._reached[var]
        return most if sign > 0 else -least

    def _goes_beyond(self, var: NumVar, sign: int, value: int) -> bool:
        """Return whether a stream is found in which a number is above a value."""
        term = self.numbers[var]
        return self._finds(term > value if sign > 0 else term < -value)

    def _finds(self, condition: Bool) -> bool:
        """Look for a stream in which a condition holds, and note what it reaches of all numbers."""
        values = self._models.in_which(condition, min(_VALUE_SECONDS, self.ends.left))
        if values is None:
            return False
        found = evaluate(list(self.numbers.values()), self.course.with_rest(values))
        for var, value in zip(self.numbers, found, strict=True):
            least, most = self._reached.get(var, (int(value), int(value)))
            self._reached[var] = min(least, int(value)), max(most, int(value))
        return True


def _chosen(term: Num) -> list[Num]:
    """Return the terms among which a term chooses: itself if it does not choose."""
    found: list[Num] = []
    left, seen = [term], {term}
    while left:
        node = left.pop()
        match node:
            case Choose(_, one, other) | Max(one, other) | Min(one, other):
                left += [part for part in (one, other) if part not in seen]
                seen |= {one, other}
            case _:
                found.append(node)
    return found
