"""The odometer between two references: one measured distance a cycle, used only where the vehicle can have run it.

Several machines may read one odometer that a second unit checks (safeloc.models.motion). They get its distances checked
already, and with each one the error that has to be added beyond the law.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from safeloc.language.declared import Declared
from safeloc.language.expr import (
    FALSE,
    Bool,
    BoolVar,
    Expr,
    Num,
    NumVar,
    Var,
    abs_,
    choice,
    enumeration,
    ite,
    maximum,
    number,
    optional,
    with_unit,
)
from safeloc.language.units import COUNT, MM, NM, NM_PER_MM
from safeloc.models.vocabulary.error_law import ErrorLaw
from safeloc.models.vocabulary.measured import (
    ADMITTED,
    JUMP,
    MEASURED,
    MISSING,
    TOO_FAST,
    Limits,
    MeasuredDistance,
)


@dataclass(frozen=True, eq=False)
class Odometer(MeasuredDistance):
    """A measured distance that is also compared with the last one: the speed changes no faster than the vehicle can.

    last          the last distance that was used, mm
    last_verdict  verdict on the distance of the last cycle
    """

    limits: Limits
    last: NumVar
    last_verdict: NumVar

    @cached_property
    def verdict(self) -> Num:
        """Verdict on this cycle's distance: ADMITTED, or why it is not used."""
        too_fast = abs_(self.measured.value) > self.limits.max_cycle_distance_mm
        return ite(~self.measured.present, MISSING, ite(too_fast, TOO_FAST, ite(self._jump, JUMP, ADMITTED)))

    @cached_property
    def _jump(self) -> Bool:
        """The vehicle cannot have changed its speed so much; a distance that was checked already is not checked again."""
        if self.more is not None:
            return FALSE
        known = self.gap <= self.limits.gap_limit
        allowed = with_unit((self.gap + 1) * self.limits.max_cycle_distance_change_mm, MM)
        return known & (abs_(self.measured.value - self.last) > allowed)

    @cached_property
    def admitted(self) -> Bool:
        """This cycle's distance is used."""
        return self.verdict.eq(ADMITTED)

    def declare(self, declared: Declared) -> Odometer:
        """Declare inputs and state, in which no distance was measured yet; return the odometer itself."""
        for one in self.inputs:
            declared.sensor(one)
        declared.state(self.last, first=0)
        declared.state(self.gap, first=self.limits.gap_limit + 1)
        declared.state(self.last_verdict, first=MISSING)
        return self

    @cached_property
    def last_after(self) -> Num:
        """The last distance that was used, this cycle included, mm."""
        return ite(self.admitted, self.measured.value, self.last)

    def listen(self) -> dict[Var, Expr]:
        """Return the updates of every cycle: last distance, gap and verdict."""
        return {self.last: self.last_after, self.gap: self.gap_after, self.last_verdict: self.verdict}


def odometer(law: ErrorLaw, limits: Limits, name: str = "odometer", *, checked: bool = False) -> Odometer:
    """Return an odometer with fresh variables named `odometer_...`; `checked`: a second unit has checked its distances."""
    reach = 2 * limits.max_cycle_distance_mm + 1_000
    return Odometer(
        law,
        optional(f"{name}_mm", MM, -reach, reach),
        number(f"{name}_gap_cycles", COUNT, 0, limits.gap_limit + 1),
        limits,
        last=number(f"{name}_last_mm", MM, -limits.max_cycle_distance_mm, limits.max_cycle_distance_mm),
        last_verdict=choice(f"{name}_last_verdict", enumeration(MEASURED)),
        more=number(f"{name}_more_nm", NM, 0, most_further_error_nm(limits.max_cycle_distance_mm)) if checked else None,
    )


def most_further_error_nm(max_cycle_distance_mm: int) -> int:
    """Return the greatest error beyond the law that is reported with a distance, nm: four times the farthest distance."""
    return 4 * max_cycle_distance_mm * NM_PER_MM


@dataclass(frozen=True, eq=False)
class Heading:
    """The vehicle's direction along the route: it turns after more than `reversal_mm` against it without a break."""

    backwards: BoolVar
    rolled: NumVar
    reversal_mm: int

    def after(self, distance: Num) -> tuple[Bool, dict[Var, Expr]]:
        """Return whether the vehicle runs backwards after the cycle, and the updates."""
        rolled = maximum(self.rolled + ite(self.backwards, distance, -distance), 0)
        turned = rolled > self.reversal_mm
        backwards = ite(turned, ~self.backwards, self.backwards)
        return backwards, {self.backwards: backwards, self.rolled: ite(turned, 0, rolled)}
