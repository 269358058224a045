"""Running sums: comparison of two measurements of one hidden quantity over a run, instead of in a single cycle.

A law often allows a one-off error that wanders within a range and does not accumulate: its change in one cycle may be any
part of that range, and over a run never more than the whole range. Two units that measure the same distance are therefore
compared by a running sum:

    total + (lower bound by one unit) - (upper bound by the other)   <=   both ranges together

The sum restarts from 0 if it falls below 0, if one of the units gives no measurement, and after a violation.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from safeloc.language.expr import Bool, Expr, Num, NumVar, Var, any_of, as_num, ite, maximum, number
from safeloc.language.hidden_bounds import Bound
from safeloc.language.nodes import Choose, Lit, Truth
from safeloc.language.sums import least
from safeloc.language.terms import Sharing, conjuncts, variables
from safeloc.language.units import Unit

Moves = Mapping[Var, Expr]


@dataclass(frozen=True, eq=False)
class Steady:
    """A bound of a sum, without its wandering errors; over a run, these change the sum by no more than `wanders`."""

    bound: Bound
    wanders: int

    def over(self, other: Steady, name: str) -> Running | None:
        """Return the running sum of this lower bound minus the other's upper bound; None if there is none or it never grows."""
        low, high = self.bound.low, other.bound.high
        if low is None or high is None or self.wanders + other.wanders == 0 or least(high - low) >= 0:
            return None
        unit, most = low.unit, self.wanders + other.wanders
        assert isinstance(unit, Unit)
        total = number(name, unit, 0, most)
        grown, apart = total + (low - high), any_of(~one for one in _in_order(self, other))
        return Running(total, ite(apart | (grown > most), as_num(0, unit), maximum(grown, 0)), apart | (grown <= most))


def _in_order(*both: Steady) -> list[Bool]:
    """Return the conditions under which each is in force, in an order that does not depend on the order of arguments."""
    return sorted((one.bound.when for one in both), key=lambda when: [var.name for var in variables([when])])


@dataclass(frozen=True, eq=False)
class Running:
    """A running sum: the observer's variable, its next value, and the condition that holds while both laws do."""

    total: NumVar
    move: Num
    term: Bool


def steady(bound: Bound, moves: Moves) -> Steady:
    """Return the bound without its wandering errors: differences of x and y, where x takes the value of y in the step."""
    of, wanders = dict(bound.of), 0
    for var, factor in bound.of:
        becomes = _becomes(var, bound.when, moves)
        if becomes is not None and of.get(becomes) == -factor:
            del of[var], of[becomes]
            wanders += abs(factor) * (var.high - var.low)
    return Steady(bound.of_other(tuple(of.items())), wanders)


def _becomes(var: NumVar, when: Bool, moves: Moves) -> NumVar | None:
    """Return the variable whose value this one takes in every step in which `when` holds; None if there is none."""
    match moves.get(var):
        case NumVar() as after if after is not var:
            return after
        case Choose(condition, NumVar() as after, _) if _implies(when, condition):
            return after
        case _:
            return None


def _implies(when: Bool, condition: Bool) -> bool:
    """Return whether all conjuncts of the condition are conjuncts of `when`; other implications are not recognized."""
    share = Sharing()
    known = set(conjuncts(share.bool(when)))
    return known.issuperset(conjuncts(share.bool(condition)))


def running(one: Sequence[Steady], other: Sequence[Steady], names: tuple[str, str]) -> Iterator[Running]:
    """Yield the running sums of two clauses, in both directions."""
    for first in one:
        for second in other:
            if first.bound.key == second.bound.key and not _is_constant(first) and not _is_constant(second):
                there = first.over(second, f"{names[0]} over {names[1]}")
                back = second.over(first, f"{names[1]} over {names[0]}")
                yield from (found for found in (there, back) if found is not None)


def _is_constant(one: Steady) -> bool:
    """Return whether the bound is a fixed figure that is always in force: it is no measurement to compare."""
    bound = one.bound.high if one.bound.low is None else one.bound.low
    return isinstance(one.bound.when, Truth) and isinstance(bound, Lit)
