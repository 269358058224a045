"""Outward-rounded interval arithmetic (mpmath.iv) as the judge of bounds that `safeloc.sensing` hands over.

    exact(0.1), exact(Fraction(1, 3))     the very number, as an interval that is as thin as 256 bits allow
    span(exact(2), exact(3))              everything in between
    assert_encloses(low, high, found)     the bound holds the whole interval

Every operation on these rounds outward, so what comes out holds the quantity for sure; it shares no code with the front ends.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from hypothesis import settings
from mpmath import iv

Ball = Any
Figure = int | float | Fraction
BITS = 256
iv.prec = BITS
FEWER = settings(max_examples=settings().max_examples // 3)
"""For tests of many operations: the extremes are among the examples, or are drawn from few."""
THIN = Fraction(1, 2**160)
"""Relative width that 256 bits leave: far below what a float can tell, so nothing that matters hides behind it."""


def exact(value: Figure) -> Ball:
    """Return the number itself: a float is the rational number that it stands for."""
    number = Fraction(value)
    return iv.mpf(number.numerator) / iv.mpf(number.denominator)


def span(low: Ball, high: Ball) -> Ball:
    """Return the interval from the lowest to the highest of both."""
    return iv.mpf([low.a, high.b])


def around(value: Ball, error: Ball) -> Ball:
    """Return the interval of everything that is off the value by the error at most."""
    return span(value - error, value + error)


def ends(found: Ball) -> tuple[Fraction, Fraction]:
    """Return the ends of an interval as fractions."""
    return _fraction(found.a), _fraction(found.b)


def _fraction(end: Ball) -> Fraction:
    sign, mantissa, exponent, _ = end._mpi_[0]
    whole = Fraction(int(mantissa)) * Fraction(2) ** int(exponent)
    return -whole if sign else whole


def assert_encloses(low: Figure, high: Figure, found: Ball) -> None:
    """Fail where the quantity reaches beyond the bound handed over, by more than the judge's own last bits."""
    lowest, highest = ends(found)
    slack = THIN * max(abs(lowest), abs(highest), 1)
    assert Fraction(low) <= lowest + slack, f"{low} is above {float(lowest)!r}"
    assert highest - slack <= Fraction(high), f"{high} is below {float(highest)!r}"
