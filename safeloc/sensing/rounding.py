"""Exact bounds of quantities, and their outward rounding to whole numbers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from safeloc.errors import InputError

Exact = int | Fraction


@dataclass(frozen=True, slots=True)
class ExactBounds:
    """Exact bounds of a quantity. InputError if they are in the wrong order."""

    low: Exact
    high: Exact

    def __post_init__(self) -> None:
        if self.low > self.high:
            raise InputError(f"an interval from {self.low} to {self.high} holds nothing; give the lower bound first.")

    def __mul__(self, other: ExactBounds) -> ExactBounds:
        corners = [a * b for a in (self.low, self.high) for b in (other.low, other.high)]
        return ExactBounds(min(corners), max(corners))

    def moved(self, by: Exact) -> ExactBounds:
        """Return the bounds, both shifted by this much."""
        return ExactBounds(self.low + by, self.high + by)

    def widened(self, by: Exact) -> ExactBounds:
        """Return the bounds, `by` wider on either side."""
        return ExactBounds(self.low - by, self.high + by)


def exactly(value: float) -> Fraction:
    """Return the exact rational value of a float. InputError if it is not finite, since it bounds nothing then."""
    if not math.isfinite(value):
        raise InputError(
            f"a measured figure is {value}; remove figures that are not finite before bounds are computed."
        )
    return Fraction(value)


def hull(intervals: Sequence[ExactBounds]) -> ExactBounds:
    """Return the smallest bounds around all of them: they contain the true value if any single one does."""
    return ExactBounds(min(one.low for one in intervals), max(one.high for one in intervals))


def outward(interval: ExactBounds, unit: int = 1) -> tuple[int, int]:
    """Return (value, error), whole multiples of the unit with value - error <= low and high <= value + error.

    The error is below half the width plus one and a half: both ends move to whole numbers, the middle to one of two.
    """
    low, high = math.floor(Fraction(interval.low, unit)), math.ceil(Fraction(interval.high, unit))
    value = (low + high) // 2
    return value, high - value
