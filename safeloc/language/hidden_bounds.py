"""Consequences of a clause that read no hidden variable: its visible parts, and comparisons of bounds of hidden sums.

    divided(clause, hidden)     the parts that read no hidden variable, and the bounds of sums of hidden variables
    compatible(one, other)      consequences of bounds of the same hidden sum: no lower bound is above an upper one
    all_compatible(bounds)      the same for any number of bounds at once, as one short term for each sum

A part is a disjunction. If exactly one of its members reads hidden variables, and it is a comparison that is linear in
them, the part is a bound, in force while none of the other members holds. Parts of any other form are ignored: this module
derives nothing from them.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import reduce
from math import gcd

from safeloc.language.expr import (
    TRUE,
    Bool,
    Num,
    NumVar,
    Var,
    all_of,
    any_of,
    floor_div,
    ite,
    maximum,
    minimum,
)
from safeloc.language.nodes import And, Compare, Lit, Not, Or, Sub, Truth
from safeloc.language.ranges import bounds as bounds_of
from safeloc.language.sums import factors, least
from safeloc.language.terms import variables
from safeloc.language.units import Enumeration, Unit

Hidden = frozenset[Var]
Members = tuple[Bool, ...]
Factors = tuple[tuple[NumVar, int], ...]


@dataclass(frozen=True, eq=False)
class Bound:
    """A bound of a hidden sum: at least `low`, and at most `high`, while `when` holds; None for an end without a bound.

    of   the sum: variables with factors that have no common divisor, the first of them positive
    """

    of: Factors
    when: Bool
    low: Num | None = None
    high: Num | None = None

    def of_other(self, of: Factors) -> Bound:
        """Return the same bound for another sum; if its first factor is negative, sum and bound change their sign."""
        if not of or of[0][1] > 0:
            return Bound(of, self.when, self.low, self.high)
        turned = tuple((var, -factor) for var, factor in of)
        low, high = (None if end is None else _negated(end) for end in (self.high, self.low))
        return Bound(turned, self.when, low, high)

    @property
    def key(self) -> tuple[object, ...]:
        """A key that is equal for bounds of the same sum in the same unit; variables are compared by identity."""
        bound = self.high if self.low is None else self.low
        assert bound is not None
        unit = bound.unit
        assert isinstance(unit, Unit)
        return (unit.dimension, unit.scale, *((id(var), factor) for var, factor in self.of))

    @property
    def reads(self) -> list[Var]:
        """The variables that determine whether the bound is in force, and its value."""
        return variables([one for one in (self.when, self.low, self.high) if one is not None])


@dataclass(frozen=True, eq=False)
class Divided:
    """The parts of a clause that read no hidden variable, and its bounds of hidden sums.

    is_equivalent  all parts of the clause are visible
    """

    visible: Sequence[Bool]
    bounds: Sequence[Bound] = field(default_factory=tuple)
    is_equivalent: bool = False


def divided(clause: Bool, hidden: Hidden) -> Divided:
    """Return the parts of the clause that read no hidden variable, and its bounds of hidden sums."""
    visible, bounds, parts = list[Bool](), list[Bound](), list(_parts(clause, hidden))
    for members in parts:
        behind = [one for one in members if _reads(one, hidden)]
        if not behind:
            visible.append(any_of(members))
        elif len(behind) == 1:
            bounds += _bounds(behind[0], all_of(~one for one in members if one is not behind[0]), hidden)
    return Divided(visible, bounds, len(visible) == len(parts))


def compatible(one: Iterable[Bound], other: Sequence[Bound]) -> list[Bool]:
    """Return the conditions that follow from bounds of the same sum, without those that hold for all values in range."""
    pairs = [(first, second) for first in one for second in other if first.key == second.key]
    return [part for pair in pairs for low, high in (pair, pair[::-1]) for part in _ordered(low, high)]


def _ordered(lower: Bound, upper: Bound) -> Iterator[Bool]:
    if lower.low is not None and upper.high is not None and least(upper.high - lower.low) < 0:
        yield any_of([~lower.when, ~upper.when, lower.low <= upper.high])


def all_compatible(bounds: Iterable[Bound]) -> Bool:
    """Return the condition that no lower bound in force is above an upper one: one short term that does not name the pair."""
    groups: dict[tuple[object, ...], list[Bound]] = {}
    for one in bounds:
        groups.setdefault(one.key, []).append(one)
    return all_of(_meeting(group) for group in groups.values())


def _meeting(group: Sequence[Bound]) -> Bool:
    lows = [(one.when, one.low) for one in group if one.low is not None]
    highs = [(one.when, one.high) for one in group if one.high is not None]
    if not lows or not highs:
        return TRUE
    found = bounds_of([bound for _, bound in (*lows, *highs)])
    far = 1 + max(abs(end) for ends in found.values() for end in ends)
    low = reduce(maximum, [ite(when, bound, -far) for when, bound in lows])
    return low <= reduce(minimum, [ite(when, bound, far) for when, bound in highs])


# ------------------------------------------------------------------ parts


def _reads(term: Bool, hidden: Hidden) -> bool:
    return not hidden.isdisjoint(variables([term]))


def _parts(clause: Bool, hidden: Hidden, *, holds: bool = True) -> Iterator[Members]:
    """Yield the parts of the clause (of its negation, if `holds` is False), each as the members of a disjunction."""
    match clause:
        case Truth(value) if value is holds:
            return
        case _ if not _reads(clause, hidden):
            yield (clause if holds else ~clause,)
        case Not(inner):
            yield from _parts(inner, hidden, holds=not holds)
        case And(parts) | Or(parts) if isinstance(clause, And) is holds:
            for part in parts:
                yield from _parts(part, hidden, holds=holds)
        case And(parts) | Or(parts):
            yield from _spread([list(_parts(part, hidden, holds=holds)) for part in parts])
        case _:
            yield (clause if holds else ~clause,)


def _spread(alternatives: Sequence[Sequence[Members]]) -> Iterator[Members]:
    """Yield the parts of a disjunction of conjunctions; if more than one alternative has several parts, it stays one part."""
    several = [parts for parts in alternatives if len(parts) > 1]
    single = [one for parts in alternatives if len(parts) == 1 for one in parts[0]]
    if not all(alternatives):  # one of them always holds
        return
    if len(several) == 1:
        yield from ((*single, *members) for members in several[0])
    else:
        yield (*single, *(all_of(any_of(members) for members in parts) for parts in several))


def _bounds(member: Bool, when: Bool, hidden: Hidden) -> Iterator[Bound]:
    """Yield the bounds that a comparison sets, in force while `when` holds."""
    holds = not isinstance(member, Not)
    compared = member.inner if isinstance(member, Not) else member
    if not isinstance(compared, Compare) or isinstance(compared.left.unit, Enumeration):
        return
    left, right = compared.left, compared.right
    match compared.op, holds:
        case "<=", True:
            yield from _bound(left, right, 0, when, hidden)
        case "<", True:
            yield from _bound(left, right, 1, when, hidden)
        case "<=", False:
            yield from _bound(right, left, 1, when, hidden)
        case "<", False:
            yield from _bound(right, left, 0, when, hidden)
        case "==", True:
            yield from _bound(left, right, 0, when, hidden)
            yield from _bound(right, left, 0, when, hidden)
        case _:
            return


def _bound(small: Num, great: Num, apart: int, when: Bool, hidden: Hidden) -> Iterator[Bound]:
    """Yield the bound that `great - small >= apart` sets on a hidden sum, if there is one."""
    found = factors(Sub(great, small, great.unit), hidden)
    if found is None or not found.of:
        return
    named = sorted(found.of.items(), key=lambda item: (item[0].name, id(item[0])))
    common, sign = gcd(*found.of.values()), 1 if named[0][1] > 0 else -1
    of = tuple((var, sign * factor // common) for var, factor in named)
    rest = found.rest - apart
    if sign > 0:
        yield Bound(of, when, low=_negated(floor_div(rest, common)))
    else:
        yield Bound(of, when, high=floor_div(rest, common))


def _negated(term: Num) -> Num:
    """Return the term with the opposite sign; for `0 - x`, return x."""
    match term:
        case Sub(Lit(0, _), inner):
            return inner
        case _:
            return 0 - term
