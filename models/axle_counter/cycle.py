"""Terms of one cycle of the entry record: bounds of speed and run after it, and the end of the passage."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from safeloc.language.expr import Bool, Lit, Num, any_of, between, maximum, minimum
from safeloc.language.units import MS, UM, UM_PER_MM
from safeloc.models.axle_counter.passage import Parts
from safeloc.models.axle_head import NO_AXLE


@dataclass(frozen=True, eq=False)
class Cycle:
    """Terms over the inputs of a cycle and the state before it."""

    own: Parts

    @cached_property
    def counted(self) -> Bool:
        """An axle was counted."""
        return self.own.axle.ne(NO_AXLE)

    @cached_property
    def onward(self) -> Bool:
        """The axle passed in the direction of the first one."""
        return self.own.axle.eq(self.own.direction)

    @cached_property
    def speeds(self) -> tuple[Num, Num]:
        """Bounds of the speed at any time of this cycle, from those before it, mm/s."""
        change, most = self.own.config.change_mm_s, self.own.config.max_speed_mm_s
        return maximum(self.own.speed_low - change, -most), minimum(self.own.speed_high + change, most)

    @cached_property
    def runs(self) -> tuple[Num, Num]:
        """Bounds of the run after this cycle, um."""
        low, high = self.speeds
        period = self.own.config.period_ms
        after_low, after_high = self.own.run_low + low * Lit(period, MS), self.own.run_high + high * Lit(period, MS)
        return after_low, after_high

    @cached_property
    def measured(self) -> tuple[Num, Num]:
        """Bounds of the speed after a cycle with axles, mm/s."""
        low, high = self.speeds
        change = self.own.config.change_mm_s
        return maximum(low, self.own.axle_speed_low.value - change), minimum(
            high, self.own.axle_speed_high.value + change
        )

    @cached_property
    def passed(self) -> Bool:
        """The train has certainly run farther since its last axle than its longest distance between two axles."""
        return self.past > Lit(self.own.config.axle_gap_mm * UM_PER_MM, UM)

    @cached_property
    def may_lack_an_axle(self) -> Bool:
        """The train has passed, and the head is still damped: a channel may have stayed damped under a wheel that was not counted."""
        return self.passed & ~self.counted & self.own.damped

    @cached_property
    def past(self) -> Num:
        """Lower bound of the run since the last axle, after a cycle without one, um."""
        return self.own.past_low + self.speeds[0] * Lit(self.own.config.period_ms, MS)

    @cached_property
    def lost(self) -> Bool:
        """The run may have left the range in which the machine follows a passage."""
        most = self.own.config.run_limit_um
        return any_of(~between(-most, run, most) for run in (*self.runs, self.past))

    @cached_property
    def length_known(self) -> Bool:
        """The bounds of the length, with room for axles that were counted late, are close enough to be used."""
        room = (self.own.config.length_spread_mm - 2 * self.own.config.late_mm) * UM_PER_MM
        return self.own.length_high - self.own.length_low <= room

    @cached_property
    def maybe_another(self) -> Bool:
        """The pause is so long that the axle may be another train's."""
        return self.own.pause >= self.own.config.pause_cycles

    @cached_property
    def paused(self) -> Num:
        """Cycles since the last axle, after a cycle without one."""
        return minimum(self.own.pause + 1, self.own.config.pause_cycles)
