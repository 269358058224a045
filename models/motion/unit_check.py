"""A second unit that checks an odometer, so that a single fault of either cannot make a told distance wrong (MRK-4, MRK-D1).

Both units measure the same distance, and at least one of them keeps its law; nobody knows which. Told is a distance
between the two, and with it what has to be charged beyond the odometer's law so that the charge covers its error in both
cases:

    odometer lawful     its own law, and what is told beyond what it measured
    check unit lawful   the check unit's law, and what is told short of what it measured

What they differ by is summed up, and only what does not come back is charged: the sum may wander within a band, which is
charged once, as part of the one-off constant. What the odometer's law allows in a cycle beyond the check unit's brings
the sum back towards 0 without charge. So for every run of cycles, whenever it began, constant and charges together cover
the error. Nothing is judged by a threshold: units that agree cost little, a wheel that slides is charged what it misses.

A distance that comes without its check is not told. While the odometer measures nothing and the check unit no more than
its floor, the vehicle is taken to stand: nothing is charged but what it may creep then. Where standing is not believed, such
a cycle is charged as any other.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from safeloc.language.expr import (
    FALSE,
    Bool,
    BoolVar,
    Expr,
    Num,
    NumVar,
    Var,
    abs_,
    all_of,
    as_num,
    between,
    boolean,
    exact_to,
    floor_div,
    ite,
    maximum,
    minimum,
    number,
    with_unit,
)
from safeloc.language.machine import Initial
from safeloc.language.units import COUNT, MM, MS, NM, NM_PER_MM
from safeloc.models.vocabulary.error_law import ErrorLaw
from safeloc.models.vocabulary.odometer import Odometer, most_told_nm
from safeloc.models.vocabulary.odometer import odometer as a_unit


def told_law(odometer: ErrorLaw, check: ErrorLaw, band_mm: int) -> ErrorLaw:
    """The law of the distances told, apart from what is told beyond it: the constant covers either unit and the band."""
    constant = max(odometer.constant_mm, check.constant_mm + 2 * band_mm)
    return ErrorLaw.model_validate(odometer.model_dump() | {"constant_mm": constant})


@dataclass(frozen=True, eq=False)
class UnitCheck:
    """The odometer, the unit that checks it, and what is told.

    creep_nm    the fastest that a vehicle creeps which is taken to stand, nm a cycle; None: none is taken to stand
    apart       what the two differ by and has not been charged, nm
    told, more  whether the last cycle's distance is told, and the charge beyond the odometer's law, nm
    unheard     cycles since a distance was told
    """

    odometer: Odometer
    unit: Odometer
    band_nm: int
    creep_nm: int | None
    apart: NumVar
    told: BoolVar
    more: NumVar
    unheard: NumVar

    @cached_property
    def checked(self) -> Bool:
        """Both units measured, and each can have run that."""
        return self.odometer.admitted & self.unit.admitted

    @cached_property
    def standing(self) -> Bool:
        """The odometer measures nothing, and the check unit no more than its floor; where that is believed."""
        if self.creep_nm is None:
            return FALSE
        still = self.unit.law.floor_mm_s * self.unit.limits.period_ms // 1_000
        return all_of([self.checked, self.odometer.step.value.eq(0), between(-still, self.unit.step.value, still)])

    @cached_property
    def difference(self) -> Num:
        """What the check unit measured more than the odometer in the cycle, nm; only where both measured."""
        return exact_to(self.unit.step.value - self.odometer.step.value, NM)

    @property
    def disagree(self) -> Bool:
        """They differ by more in the cycle than both laws explain."""
        return self.checked & (abs_(self.difference) > self.odometer.most_error + self.unit.most_error)

    @property
    def alone(self) -> Bool:
        """Only one of them measured."""
        return (self.odometer.admitted | self.unit.admitted) & ~self.checked

    @property
    def failed(self) -> Bool:
        """Nothing was told for longer than permitted."""
        return ~self.checked & (self.unheard + 1 > self._unheard_limit)

    @property
    def _unheard_limit(self) -> int:
        return self.odometer.limits.gap_limit

    # ------------------------------------------------------------------ what is charged

    @cached_property
    def _sum(self) -> Num:
        return self.apart + self.difference

    @cached_property
    def apart_after(self) -> Num:
        """The difference that stays uncharged: towards 0 by what costs nothing, and within the band."""
        free = maximum(self.odometer.most_error - self.unit.most_error, 0)
        back = self._sum - maximum(-free, minimum(self._sum, free))
        kept = maximum(as_num(-self.band_nm, NM), minimum(back, self.band_nm))
        return ite(self.checked & ~self.standing, kept, self.apart)

    @cached_property
    def _settled(self) -> Num:
        """The difference that the cycle has to cover, nm."""
        return self._sum - self.apart_after

    @cached_property
    def shift(self) -> Num:
        """How much more than the odometer's distance is told, mm: so much that either unit's case costs the same."""
        size = abs_(self._settled)
        gap = maximum(size + self.unit.most_error - self.odometer.most_error, 0)
        half = with_unit(floor_div(minimum(gap, size * 2), 2 * NM_PER_MM), MM)
        signed = ite(self._settled >= 0, half, -half)
        return ite(self.checked & ~self.standing, signed, as_num(0, MM))

    @cached_property
    def distance(self) -> Num:
        """The distance told, mm; 0 where none is."""
        return ite(self.checked, self.odometer.step.value + self.shift, as_num(0, MM))

    @cached_property
    def beyond(self) -> Num:
        """What the cycle is charged beyond the odometer's law, or, where nothing is told, beyond the highest speed; nm."""
        shift = exact_to(self.shift, NM)
        either = maximum(self.odometer.most_error + abs_(shift), self.unit.most_error + abs_(self._settled - shift))
        law = self.odometer.law.growth_nm(abs_(self.distance), as_num(0, MS), self.odometer.limits.period_ms)
        run = ite(self.standing, as_num(self.creep_nm or 0, NM), maximum(either - law, 0))
        return ite(self.checked, run, maximum(self._alone(self.odometer), self._alone(self.unit)))

    def _alone(self, one: Odometer) -> Num:
        """A distance that comes alone may be the true one; what it says with its law may be beyond the highest speed."""
        said = exact_to(abs_(one.step.value), NM) + one.most_error
        return ite(one.admitted, maximum(said - one.limits.blind_nm, 0), as_num(0, NM))

    # ------------------------------------------------------------------ state

    def state(self) -> dict[Var, Initial]:
        """State variables with initial values: nothing was told."""
        silent: dict[Var, Initial] = {self.told: False, self.more: 0, self.unheard: self._unheard_limit + 1}
        return {**self.unit.state(), self.apart: 0, **silent}

    def listen(self) -> dict[Var, Expr]:
        """Updates of every cycle."""
        waited = minimum(self.unheard + 1, self._unheard_limit + 1)
        return {
            **self.unit.listen(),
            self.apart: self.apart_after,
            self.told: self.checked,
            self.more: self.beyond,
            self.unheard: ite(self.checked, as_num(0, COUNT), waited),
        }


def unit_check(odometer: Odometer, law: ErrorLaw, band_mm: int, creep_mm_s: int | None) -> UnitCheck:
    """A check by a unit of that law, with fresh variables; `creep_mm_s`: of a vehicle that stands, None where none is believed to."""
    limits, band = odometer.limits, band_mm * NM_PER_MM
    creep = None if creep_mm_s is None else creep_mm_s * limits.period_ms * (NM_PER_MM // 1_000)
    return UnitCheck(
        odometer,
        a_unit(law, limits, "check"),
        band,
        creep,
        number("units_apart_nm", NM, -band, band),
        boolean("distance_told"),
        number("told_more_nm", NM, 0, most_told_nm(limits.max_step_mm)),
        number("unheard_cycles", COUNT, 0, limits.gap_limit + 1),
    )
