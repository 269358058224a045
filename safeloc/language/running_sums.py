"""Two measurements of one hidden quantity, compared over a run and not in a single cycle.

A law often leaves a one-off error that wanders within a range and does not add up: in one cycle it may be any part of that
range, and over a run no more than the whole. So two units that measure the same way are compared by a running sum:

    total + (what one says it was at least) - (what the other says it was at most)   <=   both ranges together

The sum begins anew where it falls below 0, where one of them is silent, and after a breach.
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
    """A bound of a sum without the change of what wanders in it; over a run, that change is no more than `range`."""

    bound: Bound
    wanders: int

    def over(self, other: Steady, name: str) -> Running | None:
        """Return the running sum of what this bound has below and the other above; None where it never grows."""
        low, high = self.bound.low, other.bound.high
        if low is None or high is None or self.wanders + other.wanders == 0 or least(high - low) >= 0:
            return None
        unit, most = low.unit, self.wanders + other.wanders
        assert isinstance(unit, Unit)
        total = number(name, unit, 0, most)
        grown, apart = total + (low - high), any_of(~one for one in _in_order(self, other))
        return Running(total, ite(apart | (grown > most), as_num(0, unit), maximum(grown, 0)), apart | (grown <= most))


def _in_order(*both: Steady) -> list[Bool]:
    """When both are in force, whichever comes first, so that both ways share it."""
    return sorted((one.bound.when for one in both), key=lambda when: [var.name for var in variables([when])])


@dataclass(frozen=True, eq=False)
class Running:
    """A running sum: what an observer remembers, how that moves, and what holds as long as both laws do."""

    total: NumVar
    move: Num
    term: Bool


def steady(bound: Bound, moves: Moves) -> Steady:
    """Return the bound without what wanders in it: a variable that becomes the one it is subtracted from."""
    of, wanders = dict(bound.of), 0
    for var, factor in bound.of:
        becomes = _becomes(var, bound.when, moves)
        if becomes is not None and of.get(becomes) == -factor:
            del of[var], of[becomes]
            wanders += abs(factor) * (var.high - var.low)
    return Steady(bound.of_other(tuple(of.items())), wanders)


def _becomes(var: NumVar, when: Bool, moves: Moves) -> NumVar | None:
    """The variable whose value this one has after every step in which `when` holds."""
    match moves.get(var):
        case NumVar() as after if after is not var:
            return after
        case Choose(condition, NumVar() as after, _) if _implies(when, condition):
            return after
        case _:
            return None


def _implies(when: Bool, condition: Bool) -> bool:
    """Whether all parts of the condition are parts of `when`; another reason is not looked for."""
    share = Sharing()
    known = set(conjuncts(share.bool(when)))
    return known.issuperset(conjuncts(share.bool(condition)))


def running(one: Sequence[Steady], other: Sequence[Steady], names: tuple[str, str]) -> Iterator[Running]:
    """Yield the running sums of two clauses, both ways."""
    for first in one:
        for second in other:
            if first.bound.key == second.bound.key and not _is_constant(first) and not _is_constant(second):
                there = first.over(second, f"{names[0]} over {names[1]}")
                back = second.over(first, f"{names[1]} over {names[0]}")
                yield from (found for found in (there, back) if found is not None)


def _is_constant(one: Steady) -> bool:
    """A figure that is always in force measures nothing: no run is compared with it."""
    bound = one.bound.high if one.bound.low is None else one.bound.low
    return isinstance(one.bound.when, Truth) and isinstance(bound, Lit)
