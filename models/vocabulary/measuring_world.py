"""A distance-measuring unit in a world: the distances that a vehicle can have run, and the errors that its law allows.

Only worlds import this. A machine adds errors by figures and terms of its own, so that a wrong one cannot excuse itself.
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.expr import (
    TRUE,
    Bool,
    Expr,
    Lit,
    Num,
    NumVar,
    Optional,
    Var,
    all_of,
    as_num,
    between,
    exact_to,
    ite,
    maximum,
    minimum,
    with_unit,
)
from safeloc.language.machine import Initial
from safeloc.language.units import COUNT, MM, NM
from safeloc.models.vocabulary.cycle_figures import DistanceConfig
from safeloc.models.vocabulary.error_law import ErrorLaw

THOUSAND = 1_000


@dataclass(frozen=True)
class Physics:
    """Limits of the vehicle's movement, and the step of its measurement; silence is counted up to `longest_cycles`."""

    period_ms: int
    max_speed_mm_s: int
    max_acceleration_mm_s2: int
    measuring_step_mm: int
    gap_limit_cycles: int
    longest_cycles: int

    @classmethod
    def of(cls, config: DistanceConfig, longest_cycles: int | None = None) -> Physics:
        """Return the limits that a configuration states; silence is counted up to one more than its gap, or to `longest_cycles`."""
        longest = config.gap_limit_cycles + 1 if longest_cycles is None else longest_cycles
        return cls(
            config.period_ms, config.max_speed_mm_s, config.max_acceleration_mm_s2, config.measuring_step_mm,
            config.gap_limit_cycles, longest,
        )  # fmt: skip

    @property
    def farthest_mm(self) -> int:
        """The greatest distance that a unit measures in a cycle at the highest speed, in whole mm."""
        return -(-self.max_speed_mm_s * self.period_ms // THOUSAND) + self.measuring_step_mm

    @property
    def change_mm(self) -> int:
        """The most by which two distances of successive cycles differ, in whole mm."""
        return -(-self.max_acceleration_mm_s2 * self.period_ms**2 // THOUSAND**2) + 2 * self.measuring_step_mm

    @property
    def farthest_nm(self) -> int:
        """The true distance of a cycle at the highest speed, nm."""
        return self.max_speed_mm_s * self.period_ms * THOUSAND


def possible_at_speed(measured: Optional, farthest_mm: int) -> Bool:
    """Return whether a distance was delivered that a vehicle can have run by its speed, either way."""
    return measured.present & between(-farthest_mm, measured.value, farthest_mm)


def further_error(more: Num | None) -> Num:
    """Return the error that a checking unit reports beyond the law, nm; 0 without such a unit."""
    return as_num(0, NM) if more is None else more


def wander_after(counts: Bool, wander: Num, next_wander: Num, *, checked: bool) -> Num:
    """Return the one-off error after the cycle: it moves with a distance that counts.

    That of a checked distance may move in every cycle, since the reported error covers it.
    """
    return ite(TRUE if checked else counts, next_wander, wander)


@dataclass(frozen=True, eq=False)
class Measuring:
    """A unit in the world.

    measured  distance that the unit delivers
    last_delivered  ghost: the last distance it delivered that a vehicle can have run, mm
    silent  ghost: cycles since then
    """

    law: ErrorLaw
    measured: Optional
    last_delivered: NumVar
    silent: NumVar
    physics: Physics

    @property
    def can_be_run(self) -> Bool:
        """The unit delivered a distance that a vehicle can have run, by its speed and by the change since the last such distance.

        The term limits the distance either way, where machines compare magnitudes: a wrong edit there is not repeated here.
        """
        distance, farthest_mm = self.measured.value, self.physics.farthest_mm
        change = with_unit((self.silent + 1) * self.physics.change_mm, MM)
        unheard = self.silent > self.physics.gap_limit_cycles
        changed = unheard | between(-change, distance - self.last_delivered, change)
        return all_of([self.measured.present, between(-farthest_mm, distance, farthest_mm), changed])

    def first(self) -> dict[Var, Initial]:
        """Return the ghosts with their first values: the unit has delivered nothing yet."""
        return {self.last_delivered: 0, self.silent: self.physics.gap_limit_cycles + 1}

    def moves(self) -> dict[Var, Expr]:
        """Return the next values of the ghosts."""
        counts, longest = self.can_be_run, self.physics.longest_cycles
        return {
            self.last_delivered: ite(counts, self.measured.value, self.last_delivered),
            self.silent: ite(counts, as_num(0, COUNT), minimum(self.silent + 1, longest)),
        }

    def wander_after(self, wander: Num, next_wander: Num) -> Num:
        """Return the one-off part of the error after the cycle: it moves only with a distance that can be run."""
        return wander_after(self.can_be_run, wander, next_wander, checked=False)

    def error(self, ran: Num, wander: Num, next_wander: Num) -> Num:
        """Return the error of the cycle's distance without its one-off part, nm; `ran`: the true run of the cycle, nm."""
        return ran - exact_to(self.measured.value, NM) - (next_wander - wander)

    def allows(self, error: Num, drift_age: Num | None = None) -> Bool:
        """Return whether the law allows this error of the cycle's distance, nm; `drift_age`: ms since the reference, if it drifts.

        The rate counts the part of the distance above the knee, in thousandths of a nm.
        """
        law, period = self.law, self.physics.period_ms
        thousandths, knee = self.measured.value * THOUSAND, Lit(law.knee_mm_s * period, MM)
        above = maximum(thousandths - knee, maximum(-thousandths - knee, 0))
        most = with_unit(above * law.rate_ppm, NM) + law.floor_mm_s * period * THOUSAND**2
        if drift_age is not None:
            most = most + with_unit(drift_age * (law.drift_mm_s2 * period * THOUSAND), NM)
        return (error * THOUSAND <= most) & (-error * THOUSAND <= most)
