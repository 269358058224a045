"""Rounding outward, for all rational bounds: by z3 for the rule, by exact fractions for the code."""

from __future__ import annotations

import math
from fractions import Fraction

import pytest
import z3
from hypothesis import given
from hypothesis import strategies as st

from safeloc.errors import InputError
from safeloc.sensing.rounding import ExactBounds, hull, outward

LOW, HIGH = z3.Reals("low high")
FLOOR, CEIL = z3.ToInt(LOW), -z3.ToInt(-HIGH)
VALUE = (FLOOR + CEIL) / 2
ERROR = CEIL - VALUE
SOME = st.fractions(-(10**9), 10**9, max_denominator=10**6)


def proved(claim: z3.BoolRef) -> bool:
    """Whether no pair of rationals low <= high contradicts it."""
    solver = z3.Solver()
    solver.add(LOW <= HIGH, z3.Not(claim))
    return bool(solver.check() == z3.unsat)


def test_nothing_inside_is_outside_afterwards() -> None:
    """value - error <= low and high <= value + error, for all rationals low <= high; a smaller error would not do."""
    assert proved(z3.And(VALUE - ERROR <= LOW, HIGH <= VALUE + ERROR))
    assert not proved(z3.And(VALUE - ERROR + 1 <= LOW, HIGH <= VALUE + ERROR - 1))


def test_little_is_given_away() -> None:
    """The error is below half the width plus one and a half, for all rationals."""
    assert proved(2 * ERROR < HIGH - LOW + 3)
    assert proved(ERROR >= 0)


def test_rounding_twice_is_rounding_once() -> None:
    """First down to nm, then down to mm: the same as at once, for all rationals; upwards by symmetry."""
    nm, twice, once = z3.Ints("nm twice once")
    solver = z3.Solver()
    solver.add(nm <= LOW, nm + 1 > LOW)
    solver.add(1_000_000 * twice <= nm, 1_000_000 * (twice + 1) > nm)
    solver.add(1_000_000 * once <= LOW, 1_000_000 * (once + 1) > LOW)
    assert solver.check() == z3.sat
    for apart in (twice < once, twice > once):
        assert solver.check(apart) == z3.unsat


@given(SOME, SOME, st.sampled_from([1, 1_000, 1_000_000]))
def test_the_code_is_the_rule(one: Fraction, other: Fraction, unit: int) -> None:
    """`outward` rounds as the rule that was proved."""
    low, high = min(one, other), max(one, other)
    floor, ceil = math.floor(low / unit), math.ceil(high / unit)
    value, error = outward(ExactBounds(low, high), unit)
    assert ((floor + ceil) // 2, ceil - (floor + ceil) // 2) == (value, error)
    assert unit * (value - error) <= low <= high <= unit * (value + error)


def test_an_interval_the_wrong_way_round_is_refused() -> None:
    """Bounds in the wrong order hold nothing."""
    with pytest.raises(InputError, match=r"^an interval from 2 to 1 holds nothing; give the lower bound first\.$"):
        ExactBounds(2, 1)


@given(SOME, SOME, SOME, SOME, SOME, SOME)
def test_products_and_hulls_hold(a: Fraction, b: Fraction, c: Fraction, d: Fraction, p: Fraction, q: Fraction) -> None:
    """The product of any two members is a member of the product; every member is in the hull."""
    one, other = ExactBounds(min(a, b), max(a, b)), ExactBounds(min(c, d), max(c, d))
    x, y = min(max(p, one.low), one.high), min(max(q, other.low), other.high)
    product, both = one * other, hull([one, other])
    assert product.low <= x * y <= product.high
    assert both.low <= x <= both.high
    assert both.low <= y <= both.high
