"""From exact bounds to whole numbers, outward: nothing that was inside is outside afterwards."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from safeloc.errors import InputError

Exact = int | Fraction


@dataclass(frozen=True, slots=True)
class ExactBounds:
    """Exact bounds of a quantity. InputError when they are in the wrong order."""

    low: Exact
    high: Exact

    def __post_init__(self) -> None:
        if self.low > self.high:
            raise InputError(f"an interval from {self.low} to {self.high} holds nothing; give the lower bound first.")

    def __mul__(self, other: ExactBounds) -> ExactBounds:
        corners = [a * b for a in (self.low, self.high) for b in (other.low, other.high)]
        return ExactBounds(min(corners), max(corners))

    def moved(self, by: Exact) -> ExactBounds:
        """Return the same, farther by this."""
        return ExactBounds(self.low + by, self.high + by)

    def widened(self, by: Exact) -> ExactBounds:
        """Return the same, `by` more on either side."""
        return ExactBounds(self.low - by, self.high + by)


def exactly(value: float) -> Fraction:
    """Return the rational number that a float stands for. InputError when it is not finite: such a figure bounds nothing."""
    if not math.isfinite(value):
        raise InputError(f"a measured figure is {value}; leave out what is not finite before bounds are made of it.")
    return Fraction(value)


def hull(intervals: Sequence[ExactBounds]) -> ExactBounds:
    """Return the smallest interval that holds them all: it holds the truth if any single one does."""
    return ExactBounds(min(one.low for one in intervals), max(one.high for one in intervals))


def outward(interval: ExactBounds, unit: int = 1) -> tuple[int, int]:
    """(value, error), whole multiples of the unit with value - error <= low and high <= value + error.

    The error is below half the width plus one and a half: both ends move to whole numbers, the middle to one of two.
    """
    low, high = math.floor(Fraction(interval.low, unit)), math.ceil(Fraction(interval.high, unit))
    value = (low + high) // 2
    return value, high - value
