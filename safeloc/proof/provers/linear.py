"""Sums of inputs and terms over state, and solving equations and bounds for one input after another."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from safeloc.language.expr import Expr, Lit, Num, NumVar, Var
from safeloc.language.nodes import Add, FloorDiv, Max, Min, Mul, Sub, Truth, Value
from safeloc.language.system import canonical
from safeloc.language.terms import Substitution
from safeloc.language.units import ONE

_MOST_PAIRS = 400  # of lower and upper bounds that are combined when an input is eliminated; the others are left out


def constant_of(var: Var, value: Value) -> Expr:
    """Return a constant of the variable's kind."""
    return Lit(int(value), var.unit) if isinstance(var, NumVar) else Truth(bool(value))


@dataclass(frozen=True, eq=False)
class Linear:
    """The sum of `of` (input -> factor, none 0) and `rest`, a term without inputs."""

    of: Mapping[NumVar, int]
    rest: Num

    def times(self, factor: int) -> Linear:
        """Return the sum times a constant."""
        if factor == 0:
            return Linear({}, Lit(0, ONE))
        return Linear({var: one * factor for var, one in self.of.items()}, scaled(self.rest, factor))

    def plus(self, value: int) -> Linear:
        """Return the sum plus a constant."""
        return Linear(self.of, added(self.rest, Lit(value, ONE)))

    def sum(self, other: Linear) -> Linear:
        """Return the sum of both."""
        of = {var: self.of.get(var, 0) + other.of.get(var, 0) for var in {**self.of, **other.of}}
        return Linear({var: one for var, one in of.items() if one}, added(self.rest, other.rest))

    def minus(self, other: Linear) -> Linear:
        """Return the difference."""
        return self.sum(other.times(-1))

    def without(self, var: NumVar, value: Linear) -> Linear:
        """Replace an input by `value`."""
        factor = self.of.get(var, 0)
        if not factor:
            return self
        left = Linear({other: one for other, one in self.of.items() if other is not var}, self.rest)
        return left.sum(value.times(factor))

    def term(self) -> Num:
        """Return the sum as one term."""
        total: Num = self.rest
        for var, factor in self.of.items():
            total = added(total, scaled(var, factor))
        return total


def scaled(term: Num, factor: int) -> Num:
    """Return factor * term, without a unit."""
    if isinstance(term, Lit):
        return Lit(term.value * factor, ONE)
    return term if factor == 1 else Mul(Lit(factor, ONE), term, ONE)


def added(left: Num, right: Num) -> Num:
    """Return left + right, without a unit."""
    if isinstance(left, Lit) and isinstance(right, Lit):
        return Lit(left.value + right.value, ONE)
    if isinstance(left, Lit) and left.value == 0:
        return right
    return left if isinstance(right, Lit) and right.value == 0 else Add(left, right, ONE)


def solved(numbers: Sequence[NumVar], zeros: Sequence[Linear], bounds: Sequence[Linear]) -> dict[Var, Num]:
    """Return each number as a term over state: by equations (= 0) where there are some, else within the bounds (<= 0)."""
    rules: list[tuple[NumVar, Num]] = []
    left, zeros, bounds = list(numbers), list(zeros), list(bounds)
    while left:
        equation = _usable(zeros)
        if equation is not None:
            var, linear = equation
            zeros.remove(linear)
            rule, value = _by_equation(var, linear)
        else:
            var = min(left, key=lambda one: _pairs(one, bounds))
            rule, value = _by_bounds(var, bounds), None
        rules.append((var, rule))
        left = [one for one in left if one is not var]
        zeros = [one for one in (_replaced(one, var, value) for one in zeros) if one is not None and one.of]
        bounds = _projected(var, bounds) if value is None else [one.without(var, value) for one in bounds]
        bounds = [one for one in bounds if one.of]
    known: dict[Var, Expr] = {}
    for var, rule in reversed(rules):
        known[var] = Substitution(dict(known))(rule)
    return {var: term for var, term in known.items() if isinstance(term, Num)}


def _usable(zeros: Sequence[Linear]) -> tuple[NumVar, Linear] | None:
    """Choose an equation and a number to solve it for, preferably one with factor 1."""
    pairs = [(abs(factor), place, var) for place, one in enumerate(zeros) for var, factor in one.of.items()]
    if not pairs:
        return None
    _, place, var = min(pairs, key=lambda pair: pair[:2])
    return var, zeros[place]


def _by_equation(var: NumVar, zero: Linear) -> tuple[Num, Linear | None]:
    factor = zero.of[var]
    others = Linear({one: each for one, each in zero.of.items() if one is not var}, zero.rest)
    value = others.times(-1 if factor > 0 else 1)
    if abs(factor) == 1:
        return value.term(), value
    return FloorDiv(value.term(), abs(factor), ONE), None


def _replaced(one: Linear, var: NumVar, value: Linear | None) -> Linear | None:
    if var not in one.of:
        return one
    return None if value is None else one.without(var, value)


def _split(var: NumVar, bounds: Sequence[Linear]) -> tuple[list[Linear], list[Linear], list[Linear]]:
    """Return the lower bounds of the number, its upper bounds, and the bounds without it."""
    lower = [one for one in bounds if one.of.get(var, 0) < 0]
    upper = [one for one in bounds if one.of.get(var, 0) > 0]
    return lower, upper, [one for one in bounds if var not in one.of]


def _pairs(var: NumVar, bounds: Sequence[Linear]) -> int:
    lower, upper, _ = _split(var, bounds)
    return len(lower) * len(upper)


def _by_bounds(var: NumVar, bounds: Sequence[Linear]) -> Num:
    """Return the value nearest to rest within the bounds."""
    lower, upper, _ = _split(var, bounds)
    value: Num = Lit(canonical(var), ONE)
    for one in upper:
        value = Min(value, _bound(var, one), ONE)
    for one in lower:
        value = Max(value, _bound(var, one), ONE)
    return value


def _bound(var: NumVar, one: Linear) -> Num:
    """Return the upper bound of the variable (for a positive factor) or its lower bound (for a negative one)."""
    factor = one.of[var]
    others = Linear({each: f for each, f in one.of.items() if each is not var}, one.rest)
    if factor > 0:
        return _floored(others.times(-1).term(), factor)
    return _negated(_floored(others.times(-1).term(), -factor))


def _floored(term: Num, divisor: int) -> Num:
    return term if divisor == 1 else FloorDiv(term, divisor, ONE)


def _negated(term: Num) -> Num:
    return Lit(-term.value, ONE) if isinstance(term, Lit) else Sub(Lit(0, ONE), term, ONE)


def _projected(var: NumVar, bounds: Sequence[Linear]) -> list[Linear]:
    """Eliminate the variable: every lower bound must be below every upper bound."""
    lower, upper, others = _split(var, bounds)
    crossed = [
        high.without(var, Linear({}, Lit(0, ONE)))
        .times(-low.of[var])
        .sum(low.without(var, Linear({}, Lit(0, ONE))).times(high.of[var]))
        for low in lower
        for high in upper
    ]
    return [*others, *crossed[:_MOST_PAIRS]]
