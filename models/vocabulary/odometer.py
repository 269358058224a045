"""The odometer between two groups: one measured distance a cycle, admitted only where the vehicle can have run it.

A distance that is missing or not admitted is never replaced by a guess: the estimate rests and both margins grow by
what the vehicle can have run at its highest speed. Where several hear one odometer that a second unit checks
(safeloc.models.motion), the distance comes judged, and with it what is to be charged beyond the law.
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.expr import (
    FALSE,
    Bool,
    BoolVar,
    Expr,
    Num,
    NumVar,
    Optional,
    Var,
    abs_,
    as_num,
    choice,
    enumeration,
    ite,
    maximum,
    minimum,
    number,
    optional,
    with_unit,
)
from safeloc.language.machine import Initial
from safeloc.language.units import COUNT, MM, MS, NM, NM_PER_MM
from safeloc.models.vocabulary.error_law import ErrorLaw
from safeloc.models.vocabulary.interval import Interval
from safeloc.models.vocabulary.measured import ADMITTED, JUMP, MEASURED, MISSING, TOO_FAST, Limits


@dataclass(frozen=True, eq=False)
class Odometer:
    """Its input, its law, what it last measured, and for how many cycles it has been silent.

    more    where the distance comes judged: what the cycle is charged beyond the law, nm
    """

    law: ErrorLaw
    step: Optional
    last: NumVar
    gap: NumVar
    judged: NumVar
    limits: Limits
    more: NumVar | None = None

    @property
    def inputs(self) -> list[Var | Optional]:
        """The measured distance, and what comes with it."""
        return [self.step] if self.more is None else [self.step, self.more]

    @property
    def verdict(self) -> Num:
        """Whether this cycle's distance is admitted, and if not, why."""
        too_fast = abs_(self.step.value) > self.limits.max_step_mm
        return ite(~self.step.present, MISSING, ite(too_fast, TOO_FAST, ite(self._jump, JUMP, ADMITTED)))

    @property
    def _jump(self) -> Bool:
        """The vehicle cannot have changed its speed so much; a distance that comes judged is not judged again."""
        if self.more is not None:
            return FALSE
        known = self.gap <= self.limits.gap_limit
        allowed = with_unit((self.gap + 1) * self.limits.max_step_change_mm, MM)
        return known & (abs_(self.step.value - self.last) > allowed)

    @property
    def admitted(self) -> Bool:
        """This cycle's distance counts."""
        return self.verdict.eq(ADMITTED)

    @property
    def failed(self) -> Bool:
        """Silent, or not to be believed, for longer than permitted."""
        return ~self.admitted & (self.gap + 1 > self.limits.gap_limit)

    @property
    def distance(self) -> Num:
        """The distance that counts in this cycle, mm; 0 where none was admitted."""
        return ite(self.admitted, self.step.value, as_num(0, MM))

    @property
    def most_error(self) -> Num:
        """The error that an admitted distance may have, nm: what the law allows, and what is told beyond it."""
        return self._beyond(self.law.growth_nm(abs_(self.step.value), as_num(0, MS), self.limits.period_ms))

    def _beyond(self, charge: Num) -> Num:
        return charge if self.more is None else charge + self.more

    @property
    def growth(self) -> Num:
        """What the cycle adds to either margin, nm."""
        return ite(self.admitted, self.most_error, self._beyond(as_num(self.limits.blind_nm, NM)))

    def run_on(self, interval: Interval) -> Interval:
        """The interval after the cycle, telegrams apart."""
        return interval.moved(self.distance, self.growth)

    def state(self) -> dict[Var, Initial]:
        """State variables with initial values: not yet heard of."""
        return {self.last: 0, self.gap: self.limits.gap_limit + 1, self.judged: MISSING}

    def listen(self) -> dict[Var, Expr]:
        """Updates of every cycle."""
        return {
            self.last: ite(self.admitted, self.step.value, self.last),
            self.gap: ite(self.admitted, as_num(0, COUNT), minimum(self.gap + 1, self.limits.gap_limit + 1)),
            self.judged: self.verdict,
        }


def odometer(law: ErrorLaw, limits: Limits, name: str = "odometer", *, told: bool = False) -> Odometer:
    """An odometer with fresh variables named `odometer_...`; `told`: its distances come judged."""
    reach = 2 * limits.max_step_mm + 1_000
    return Odometer(
        law,
        optional(f"{name}_mm", MM, -reach, reach),
        number(f"{name}_last_mm", MM, -limits.max_step_mm, limits.max_step_mm),
        number(f"{name}_gap_cycles", COUNT, 0, limits.gap_limit + 1),
        choice(f"{name}_judged", enumeration(MEASURED)),
        limits,
        number(f"{name}_more_nm", NM, 0, most_told_nm(limits.max_step_mm)) if told else None,
    )


def most_told_nm(max_step_mm: int) -> int:
    """The most that can be told as to be charged beyond the law in a cycle: four times the farthest distance, nm."""
    return 4 * max_step_mm * NM_PER_MM


@dataclass(frozen=True, eq=False)
class Heading:
    """Which way the vehicle runs along the route: it turns after more than `reversal_mm` against it without a break."""

    backwards: BoolVar
    rolled: NumVar
    reversal_mm: int

    def state(self) -> dict[Var, Initial]:
        """State variables with initial values: forwards."""
        return {self.backwards: False, self.rolled: 0}

    def after(self, distance: Num) -> tuple[Bool, dict[Var, Expr]]:
        """Whether the vehicle runs backwards after the cycle, and the updates."""
        rolled = maximum(self.rolled + ite(self.backwards, distance, -distance), 0)
        turned = rolled > self.reversal_mm
        backwards = ite(turned, ~self.backwards, self.backwards)
        return backwards, {self.backwards: backwards, self.rolled: ite(turned, 0, rolled)}
