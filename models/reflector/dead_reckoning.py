"""Dead reckoning: an interval that runs on with the measured distance, and grows by the odometer's error law.

An interval read off a reflector or a balise is true as it stands. To run on from it, the odometer's one-off constant
has to be charged once (`charged`), because the odometer's error may wander within it from the next cycle on.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from safeloc.language.expr import (
    Bool,
    Expr,
    Lit,
    Num,
    NumVar,
    Optional,
    Var,
    abs_,
    as_num,
    between,
    exact_to,
    ite,
    maximum,
    number,
)
from safeloc.language.machine import Initial
from safeloc.language.units import COUNT, MM, NM, NM_PER_MM, PPM
from safeloc.models.vocabulary.error_law import ErrorLaw


@dataclass(frozen=True, eq=False)
class Interval:
    """The truth lies in [position - below, position + above]: position in mm, both sides in nm.

    Which margin is which ETCS variable: `safeloc.models.vocabulary.interval`.
    """

    position: Num
    above: Num
    below: Num

    @cached_property
    def low(self) -> Num:
        """Lower end, nm."""
        return exact_to(self.position, NM) - self.below

    @cached_property
    def high(self) -> Num:
        """Upper end, nm."""
        return exact_to(self.position, NM) + self.above

    @cached_property
    def margin(self) -> Num:
        """The greater side, nm."""
        return maximum(self.above, self.below)

    @cached_property
    def width(self) -> Num:
        """Both sides together, nm."""
        return self.above + self.below

    def meets(self, other: Interval) -> Bool:
        """Whether both have a point in common."""
        return (self.low <= other.high) & (other.low <= self.high)

    def holds(self, truth: Num) -> Bool:
        """Whether the truth (nm) lies in it."""
        return between(self.low, truth, self.high)

    def widened(self, both_sides_nm: Num | int) -> Interval:
        """The same with more margin on both sides."""
        return Interval(self.position, self.above + both_sides_nm, self.below + both_sides_nm)

    def within(self, tolerance_nm: int, limit_mm: int) -> Bool:
        """Whether it may be kept: margins tolerable, position on the line."""
        tolerable = (self.above <= tolerance_nm) & (self.below <= tolerance_nm)
        return tolerable & between(-limit_mm, self.position, limit_mm)


def choose(condition: Bool, then: Interval, other: Interval) -> Interval:
    """`then` where the condition holds, else `other`."""
    return Interval(
        ite(condition, then.position, other.position),
        ite(condition, then.above, other.above),
        ite(condition, then.below, other.below),
    )


@dataclass(frozen=True, eq=False)
class Track:
    """An interval kept in state."""

    position: NumVar
    above: NumVar
    below: NumVar

    @cached_property
    def interval(self) -> Interval:
        """The interval before the step."""
        return Interval(self.position, self.above, self.below)

    def state(self) -> dict[Var, Initial]:
        """State variables with initial values."""
        return {self.position: 0, self.above: 0, self.below: 0}

    def become(self, interval: Interval) -> dict[Var, Expr]:
        """Updates that keep the interval."""
        return {self.position: interval.position, self.above: interval.above, self.below: interval.below}

    def nothing(self) -> dict[Var, Expr]:
        """Updates after which nothing is kept."""
        return self.become(Interval(as_num(0, MM), as_num(0, NM), as_num(0, NM)))


def track(position: str, margin: str, limit_mm: int, tolerance_nm: int) -> Track:
    """Fresh variables `{position}position_mm`, `{margin}margin_above_nm`, `{margin}margin_below_nm`."""
    return Track(
        number(f"{position}position_mm", MM, -limit_mm, limit_mm),
        number(f"{margin}margin_above_nm", NM, 0, tolerance_nm),
        number(f"{margin}margin_below_nm", NM, 0, tolerance_nm),
    )


@dataclass(frozen=True, eq=False)
class Odometer:
    """The distance measured in a cycle. A distance that is missing or faster than the vehicle can run is not used:
    the position then rests, and the highest speed x period is charged on both sides.

    more    where the distance comes judged (safeloc.models.motion): what the cycle is charged beyond the law, nm
    """

    step: Optional
    gap: NumVar
    law: ErrorLaw
    period_ms: int
    max_step_mm: int
    blind_nm: int
    gap_limit: int
    more: NumVar | None = None

    @cached_property
    def inputs(self) -> list[Var | Optional]:
        """The measured distance, and what comes with it."""
        return [self.step] if self.more is None else [self.step, self.more]

    @cached_property
    def admitted(self) -> Bool:
        """The distance is there and possible."""
        return self.step.present & (abs_(self.step.value) <= self.max_step_mm)

    @cached_property
    def failed(self) -> Bool:
        """Without a usable distance for longer than permitted."""
        return ~self.admitted & (self.gap + 1 > self.gap_limit)

    @cached_property
    def moved(self) -> Num:
        """The distance that counts: the measured one, else 0. Unit mm."""
        return ite(self.admitted, self.step.value, 0)

    @cached_property
    def growth(self) -> Num:
        """What the cycle adds to the error, nm."""
        measured = self.law.growth_nm(abs_(self.step.value), as_num(0, COUNT), self.period_ms)
        charge = ite(self.admitted, measured, self.blind_nm)
        return charge if self.more is None else charge + self.more

    @cached_property
    def constant_nm(self) -> int:
        """The one-off constant of the law."""
        return 2 * self.law.wander_nm

    def run_on(self, interval: Interval) -> Interval:
        """The interval after this cycle; its one-off constant is charged already."""
        moved = Interval(interval.position + self.moved, interval.above, interval.below)
        return moved.widened(self.growth)

    def lag(self, share_ppm: int) -> tuple[Num, Num]:
        """What the vehicle may have run (forwards, backwards) in the last `share` of the cycle, nm."""
        blind = as_num(-(-self.blind_nm * share_ppm // NM_PER_MM), NM)
        share, more = Lit(share_ppm, PPM), as_num(0, NM) if self.more is None else self.more
        forward = maximum(self.step.value, 0) * share + more
        backward = maximum(-self.step.value, 0) * share + more
        return ite(self.admitted, forward, blind), ite(self.admitted, backward, blind)

    def listen(self) -> dict[Var, Expr]:
        """Updates of every cycle."""
        return {self.gap: ite(self.admitted, as_num(0, COUNT), _at_most(self.gap + 1, self.gap_limit + 1))}


def _at_most(count: Num, ceiling: int) -> Num:
    return ite(count > ceiling, ceiling, count)
