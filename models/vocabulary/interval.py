"""The interval a vehicle's front end lies in: an estimate in nm with its own margin on either side."""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.expr import Bool, Num, NumVar, Var, between, exact_to, ite, maximum, minimum
from safeloc.language.machine import Initial
from safeloc.language.units import NM, NM_PER_MM


@dataclass(frozen=True, eq=False)
class Interval:
    """The front end lies in [position - below, position + above]; all nm along the route.

    above  how far the truth may lie towards greater coordinates of the line
    below  how far towards smaller ones

    For a train whose front runs towards growing coordinates `above` is ETCS's L_DOUBTUNDER (under-reading amount: the
    true front may be that far ahead of the estimate) and `below` is L_DOUBTOVER; when it runs the other way they change
    places. With growing coordinates `high` is the max safe front end, `low` the min safe front end (SUBSET-026 3.6.4.4).
    """

    position: Num
    above: Num
    below: Num

    @property
    def low(self) -> Num:
        """Min safe front end, nm."""
        return self.position - self.below

    @property
    def high(self) -> Num:
        """Max safe front end, nm."""
        return self.position + self.above

    @property
    def margin(self) -> Num:
        """The greater of both sides, nm."""
        return maximum(self.above, self.below)

    def moved(self, distance_mm: Num, growth: Num) -> Interval:
        """After a measured distance with an error of at most `growth` nm."""
        return Interval(self.position + exact_to(distance_mm, NM), self.above + growth, self.below + growth)

    def meets(self, other: Interval, least: int = 0) -> Bool:
        """Whether both have a stretch of at least `least` nm in common."""
        return minimum(self.high, other.high) - maximum(self.low, other.low) >= least

    def narrowed(self, fix: Interval) -> Interval:
        """What both have in common; the estimate is the one of the two (brought inside) with the smaller margin.

        Neither end moves outward and the margin never grows. Meaningful only where both meet.
        """
        low, high = maximum(self.low, fix.low), minimum(self.high, fix.high)
        own, new = (_around(one.position, low, high) for one in (self, fix))
        return choose(new.margin <= own.margin, new, own)

    def usable(self, tolerance_mm: int, limit_mm: int) -> Bool:
        """Whether it may be reported: margins within the tolerance when rounded to whole mm, estimate on the line."""
        tolerable = self.margin <= (tolerance_mm - 1) * NM_PER_MM
        return tolerable & between(-limit_mm * NM_PER_MM, self.position, limit_mm * NM_PER_MM)


def _around(estimate: Num, low: Num, high: Num) -> Interval:
    inside = maximum(low, minimum(high, estimate))
    return Interval(inside, high - inside, inside - low)


def choose(condition: Bool, then: Interval, other: Interval) -> Interval:
    """`then` where the condition holds, else `other`."""
    return Interval(
        ite(condition, then.position, other.position),
        ite(condition, then.above, other.above),
        ite(condition, then.below, other.below),
    )


@dataclass(frozen=True, eq=False)
class Held:
    """The machine's own interval: state variables, all 0 while there is none."""

    position: NumVar
    above: NumVar
    below: NumVar

    @property
    def interval(self) -> Interval:
        """As an interval."""
        return Interval(self.position, self.above, self.below)

    def state(self) -> dict[Var, Initial]:
        """State variables with initial values."""
        return {self.position: 0, self.above: 0, self.below: 0}

    def become(self, other: Interval) -> dict[Var, Num]:
        """Updates that make the interval its own."""
        return {self.position: other.position, self.above: other.above, self.below: other.below}
