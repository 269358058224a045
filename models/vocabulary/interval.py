"""Confidence interval of a position: an estimate with a margin of its own on either side."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from safeloc.language.expr import Bool, Expr, Num, NumVar, Var, as_num, between, exact_to, maximum, minimum
from safeloc.language.units import MM, NM, NM_PER_MM
from safeloc.models.vocabulary.choose import choose


@dataclass(frozen=True, eq=False)
class Interval:
    """The truth lies in [position - below, position + above]: the position in mm or nm, both margins in nm.

    above  how far the truth may lie towards greater coordinates of the line
    below  how far towards smaller ones

    For a train whose front runs towards growing coordinates `above` is ETCS's L_DOUBTUNDER (under-reading amount: the
    true front may be that far ahead of the estimate) and `below` is L_DOUBTOVER; when it runs the other way they change
    places. With growing coordinates `high` is the max safe front end, `low` the min safe front end (SUBSET-026 3.6.4.4).
    """

    position: Num
    above: Num
    below: Num

    @cached_property
    def low(self) -> Num:
        """Lower end, nm: the min safe front end."""
        return self._position_nm - self.below

    @cached_property
    def high(self) -> Num:
        """Upper end, nm: the max safe front end."""
        return self._position_nm + self.above

    @cached_property
    def _position_nm(self) -> Num:
        return self.position if self.position.unit == NM else exact_to(self.position, NM)

    @cached_property
    def margin(self) -> Num:
        """The greater margin, nm."""
        return maximum(self.above, self.below)

    @cached_property
    def width(self) -> Num:
        """Distance from end to end, nm."""
        return self.above + self.below

    def meets(self, other: Interval) -> Bool:
        """Return whether both intervals have a point in common."""
        return (self.low <= other.high) & (other.low <= self.high)

    def overlap(self, other: Interval) -> Num:
        """Return the length that both intervals have in common, nm; negative if there is a gap between them."""
        return minimum(self.high, other.high) - maximum(self.low, other.low)

    def holds(self, truth: Num) -> Bool:
        """Return whether the truth, in nm, lies in the interval."""
        return between(self.low, truth, self.high)

    def within(self, tolerance_nm: int, limit_mm: int) -> Bool:
        """Return whether both margins are tolerable and the position, in mm, is on the line."""
        tolerable = (self.above <= tolerance_nm) & (self.below <= tolerance_nm)
        return tolerable & between(-limit_mm, self.position, limit_mm)

    def usable(self, tolerance_mm: int, limit_mm: int) -> Bool:
        """Return whether margins stay within the tolerance when rounded up to mm, and the position, in nm, is on the line."""
        tolerable = self.margin <= (tolerance_mm - 1) * NM_PER_MM
        return tolerable & between(-limit_mm * NM_PER_MM, self.position, limit_mm * NM_PER_MM)

    def widened(self, both_sides_nm: Num | int) -> Interval:
        """Return the interval with this much added to both margins."""
        return Interval(self.position, self.above + both_sides_nm, self.below + both_sides_nm)

    def moved(self, distance_mm: Num, growth_nm: Num) -> Interval:
        """Return the interval after a measured distance that is wrong by at most `growth_nm`."""
        distance = distance_mm if self.position.unit == MM else exact_to(distance_mm, NM)
        return Interval(self.position + distance, self.above, self.below).widened(growth_nm)

    def narrowed(self, fix: Interval) -> Interval:
        """Return what both intervals have in common; only where they meet.

        The estimate is the one of the two (brought inside) with the smaller margin. Neither end moves outward, and the
        margin never grows.
        """
        low, high = maximum(self.low, fix.low), minimum(self.high, fix.high)
        own, new = (_around(one.position, low, high) for one in (self, fix))
        return choose(new.margin <= own.margin, new, own)


def _around(estimate: Num, low: Num, high: Num) -> Interval:
    inside = maximum(low, minimum(high, estimate))
    return Interval(inside, high - inside, inside - low)


@dataclass(frozen=True, eq=False)
class StoredInterval:
    """An interval in state variables, all 0 while there is none."""

    position: NumVar
    above: NumVar
    below: NumVar

    @cached_property
    def interval(self) -> Interval:
        """The interval before the step."""
        return Interval(self.position, self.above, self.below)

    def become(self, interval: Interval) -> dict[Var, Expr]:
        """Return updates that store the interval."""
        return {self.position: interval.position, self.above: interval.above, self.below: interval.below}

    def nothing(self) -> dict[Var, Expr]:
        """Return updates after which no interval is stored."""
        return {var: as_num(0, var.unit) for var in (self.position, self.above, self.below)}
