"""The distance of a condition from being violated, as a term, so that every back end computes it.

    distance(condition, hidden)  ->  Distance(term, unit, far)

The distance is 0 or more exactly if the condition holds, and negative if it is violated: the number of units by which the
quantities may still move, or have moved too far. The distance of a comparison is the difference of its sides, of a
conjunction the least distance of its parts, of a disjunction the greatest. Truth values, enumerations and quantities of
another unit have no distance: they count as `far` if they hold and `-far` if not.

The unit is that of the comparison that states the physical fact: the last one that reads a hidden variable, else the last
one. If the hidden variable is multiplied by a factor, such as 1000, the difference is divided by this factor and rounded
down, so that the distance is in the unit itself.
"""

from __future__ import annotations

from collections.abc import Mapping, Set
from dataclasses import dataclass
from functools import reduce
from math import gcd
from typing import Literal, assert_never

from safeloc.errors import ModelError
from safeloc.language.expr import abs_, floor_div, ite, maximum, minimum
from safeloc.language.nodes import (
    And,
    Bool,
    BoolNode,
    BoolVar,
    ChooseBool,
    Compare,
    Expr,
    Lit,
    Not,
    Num,
    Or,
    Past,
    Sub,
    Truth,
)
from safeloc.language.ranges import bounds
from safeloc.language.sums import atoms
from safeloc.language.terms import variables
from safeloc.language.units import ONE, Enumeration, Unit


@dataclass(frozen=True, eq=False)
class Distance:
    """A term for the distance in `unit`; its value is `far` or `-far` where no comparison with a distance decides."""

    term: Num
    unit: Unit
    far: int

    def of_value(self, value: int) -> int | None:
        """Return the distance for a value of the term; None for a value that stands for no distance."""
        return None if abs(value) >= self.far else value


def distance(condition: Bool, hidden: Set[Expr] = frozenset()) -> Distance:
    """Return the distance of the condition; ModelError for a past operator, which has no distance in a single step."""
    compared = _compared(condition)
    physical = [one for one in compared if not hidden.isdisjoint(variables([one]))] or compared
    unit = physical[-1].left.unit if physical else ONE
    assert isinstance(unit, Unit)
    gaps = {one: _gap(one, hidden) for one in compared if one.left.unit.same(unit)}
    reach = [abs(end) for ends in bounds([gap.term for gap in gaps.values()]).values() for end in ends]
    far = 2 + 2 * max(reach, default=0)
    return Distance(_Written(gaps, Lit(far, unit)).of(condition, holds=True), unit, far)


def _compared(condition: Bool) -> list[Compare]:
    """Return the comparisons of numbers, in order, without those in the conditions of choices."""
    found: list[Compare] = []
    stack: list[Bool] = [condition]
    while stack:
        match stack.pop():
            case Compare(left=left) as one if not isinstance(left.unit, Enumeration):
                found.append(one)
            case Not(inner):
                stack.append(inner)
            case And(parts) | Or(parts):
                stack.extend(reversed(parts))
            case ChooseBool(_, then, other):
                stack.extend((other, then))
            case _:
                pass
    return found


@dataclass(frozen=True, eq=False)
class _Gap:
    """The right side minus the left side of a comparison; `scale` of it are one unit of the hidden variable."""

    term: Num
    scale: int

    def short_of(self, least: int) -> Num:
        """Return by how many units the term is above this number, rounded down."""
        return floor_div(self.term - least, self.scale)

    def beyond(self, most: int) -> Num:
        """Return by how many units the term is below this number, rounded down."""
        return floor_div(most - self.term, self.scale)


def _gap(one: Compare, hidden: Set[Expr]) -> _Gap:
    gap = Sub(one.right, one.left, one.left.unit)
    added, _ = atoms(gap)
    hidden_factors = [factor for one, factor in added.items() if one in hidden and one.unit.same(gap.unit)]
    return _Gap(gap, gcd(*hidden_factors) or 1)


class _Written:
    """Writes conditions as distances, each one once, however often it occurs in others."""

    def __init__(self, gaps: Mapping[Compare, _Gap], far: Lit) -> None:
        self._gaps, self._far, self._near = gaps, far, Lit(-far.value, far.unit)
        self._done: dict[tuple[Bool, bool], Num] = {}

    def of(self, condition: Bool, *, holds: bool) -> Num:
        """Return the distance to where the condition starts to fail (`holds`), or to where it starts to hold."""
        key = (condition, holds)
        if key not in self._done:
            self._done[key] = self._written(condition, holds=holds)
        return self._done[key]

    def _written(self, condition: Bool, *, holds: bool) -> Num:
        assert isinstance(condition, BoolNode)
        match condition:
            case Not(inner):
                return self.of(inner, holds=not holds)
            case And(parts) | Or(parts):
                least = isinstance(condition, And) is holds
                return reduce(minimum if least else maximum, [self.of(part, holds=holds) for part in parts])
            case ChooseBool(chosen, then, other):
                return ite(chosen, self.of(then, holds=holds), self.of(other, holds=holds))
            case Compare() if condition in self._gaps:
                return _compared_distance(condition.op, self._gaps[condition], holds=holds)
            case Compare() | BoolVar() | Truth():
                return ite(condition, *((self._far, self._near) if holds else (self._near, self._far)))
            case Past():
                raise ModelError(f"{condition!r} reads earlier steps; a distance is defined for a single step only.")
            case _:
                assert_never(condition)


def _compared_distance(op: Literal["<", "<=", "=="], gap: _Gap, *, holds: bool) -> Num:
    match op, holds:
        case "<=", True:
            return gap.short_of(0)
        case "<=", False:
            return gap.beyond(-1)
        case "<", True:
            return gap.short_of(1)
        case "<", False:
            return gap.beyond(0)
        case _:
            apart = _Gap(abs_(gap.term), gap.scale)
            return apart.beyond(0) if holds else apart.short_of(1)
