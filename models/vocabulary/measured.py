"""A distance that is measured once in a cycle: its limits, and its effect on the position."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Protocol

from safeloc.language.expr import (
    Bool,
    Num,
    NumVar,
    Optional,
    abs_,
    as_num,
    ite,
    members,
    minimum,
)
from safeloc.language.units import COUNT, MM, MS, NM, NM_PER_MM
from safeloc.models.vocabulary.cycle_figures import DistanceConfig
from safeloc.models.vocabulary.error_law import ErrorLaw
from safeloc.models.vocabulary.interval import Interval

MEASURED = members("measured", "ADMITTED", "MISSING", "TOO_FAST", "JUMP")
ADMITTED, MISSING, TOO_FAST, JUMP = MEASURED


@dataclass(frozen=True)
class Limits:
    """Physical and configured limits of a measuring device, whole numbers in the units named."""

    period_ms: int
    tolerance_mm: int
    max_speed_mm_s: int
    max_cycle_distance_mm: int
    max_cycle_distance_change_mm: int
    gap_limit: int
    lone_limit: int
    age_limit_ms: int
    position_limit_mm: int
    single_fault_safe: bool

    @classmethod
    def of(cls, config: DistanceConfig, tolerance_mm: int, limit_mm: int) -> Limits:
        """Return the limits of one odometer, rounded so that its checks are no tighter than physics.

        It has no partner, so a lone distance counts as long as any, and no distance has an age.
        """
        distance = max_cycle_distance_mm(config.max_speed_mm_s, config.period_ms, config.measuring_step_mm)
        change = max_cycle_distance_change_mm(config.max_acceleration_mm_s2, config.period_ms, config.measuring_step_mm)
        gap = config.gap_limit_cycles
        return cls(
            config.period_ms, tolerance_mm, config.max_speed_mm_s, distance, change, gap, gap, 0, limit_mm, False
        )

    @property
    def tolerance_nm(self) -> int:
        """The tolerable error, nm."""
        return self.tolerance_mm * NM_PER_MM

    @property
    def blind_nm(self) -> int:
        """The farthest that the vehicle gets in a cycle, nm."""
        return self.max_speed_mm_s * self.period_ms * 1_000


def max_cycle_distance_mm(max_speed_mm_s: int, period_ms: int, measuring_step_mm: int) -> int:
    """Return the greatest distance that is measured in a cycle at the highest speed, mm, rounded up."""
    return -(-max_speed_mm_s * period_ms // 1_000) + measuring_step_mm


def max_cycle_distance_change_mm(max_acceleration_mm_s2: int, period_ms: int, measuring_step_mm: int) -> int:
    """Return the most by which the distances of successive cycles differ, mm, rounded up."""
    return -(-max_acceleration_mm_s2 * period_ms**2 // 1_000_000) + 2 * measuring_step_mm


class CycleLimits(Protocol):
    """The figures of a cycle that a measured distance is judged by."""

    @property
    def period_ms(self) -> int:
        """Length of the cycle, ms."""
        ...

    @property
    def max_cycle_distance_mm(self) -> int:
        """The greatest distance that is measured in a cycle at the highest speed, mm."""
        ...

    @property
    def blind_nm(self) -> int:
        """The farthest that the vehicle gets in a cycle, nm."""
        ...

    @property
    def gap_limit(self) -> int:
        """The most cycles without a usable distance."""
        ...


@dataclass(frozen=True, eq=False)
class MeasuredDistance:
    """A distance measured once in a cycle, wrong by no more than its error law allows.

    The distance is used if it is there and the vehicle can have run it. Otherwise the position rests, and the farthest travel
    at the highest speed is added to both margins: no guess takes the place of a missing distance.

    measured  input: the distance measured in the cycle, mm; absent where the unit sent none
    gap   cycles since the last distance that was used
    more  error beyond the law, nm, which a checking unit reports with each distance (safeloc.models.motion)
    """

    law: ErrorLaw
    measured: Optional
    gap: NumVar
    limits: CycleLimits
    more: NumVar | None = field(default=None, kw_only=True)

    @cached_property
    def inputs(self) -> list[NumVar | Optional]:
        """The measured distance, and the error that is reported with it."""
        return [self.measured] if self.more is None else [self.measured, self.more]

    @cached_property
    def admitted(self) -> Bool:
        """This cycle's distance is used."""
        return self.measured.present & (abs_(self.measured.value) <= self.limits.max_cycle_distance_mm)

    @cached_property
    def failed(self) -> Bool:
        """No distance could be used for longer than permitted."""
        return ~self.admitted & (self.gap + 1 > self.limits.gap_limit)

    @cached_property
    def distance(self) -> Num:
        """Distance by which the position moves, mm: the measured one, or 0."""
        return ite(self.admitted, self.measured.value, as_num(0, MM))

    @cached_property
    def most_error(self) -> Num:
        """Greatest error of a distance that is used, nm: by the law, and what is reported beyond it."""
        return self._with_more(self.law.growth_nm(abs_(self.measured.value), as_num(0, MS), self.limits.period_ms))

    def _with_more(self, error: Num) -> Num:
        return error if self.more is None else error + self.more

    @cached_property
    def growth(self) -> Num:
        """Error that the cycle adds to either margin, nm: that of the distance, or the farthest travel where none is used."""
        return ite(self.admitted, self.most_error, self._with_more(as_num(self.limits.blind_nm, NM)))

    def run_on(self, interval: Interval) -> Interval:
        """Return the interval after this cycle's distance; the law's one-off constant has to be in its margins already."""
        return interval.moved(self.distance, self.growth)

    @cached_property
    def gap_after(self) -> Num:
        """Cycles without a usable distance after this one, counted up to one more than permitted."""
        return ite(self.admitted, as_num(0, COUNT), minimum(self.gap + 1, self.limits.gap_limit + 1))
