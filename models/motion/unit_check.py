"""A second unit that checks an odometer, so that a single fault of either cannot make a reported distance wrong (MRK-4, MRK-D1).

Both units measure the same distance, and at least one of them keeps its law; it is unknown which. The machine reports a
distance between the two, and with it the error to add beyond the odometer's law, so that both together cover the error of
the reported distance in both cases:

    odometer lawful     its own law, and the reported distance less the one it measured
    check unit lawful   the check unit's law, and the distance it measured less the reported one

The machine sums up the difference of both units and adds only what does not come back: the sum may wander within a band,
which is added once, as part of the one-off constant. Where the odometer's law allows a greater error in a cycle than the
check unit's, that excess brings the sum back towards 0 at no cost. So for every run of cycles, whenever it began, constant and
added errors together cover the error. There is no threshold: units that agree cost little, and a wheel that slides costs the
distance it misses.

A distance without its check is not reported. While the odometer measures nothing and the check unit no more than its floor,
the vehicle counts as standing. It may still run on to the next pulse, in all cycles of the stop together: that is added in its
first cycle, and once to the constant, since a run may begin within the stop. Beyond that only its possible creep is added in each cycle.
If standing is not believed (`standing_believed`), such a cycle counts as any other.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from safeloc.language.declared import Declared
from safeloc.language.expr import (
    FALSE,
    Bool,
    BoolVar,
    Num,
    NumVar,
    abs_,
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
from safeloc.language.units import COUNT, MM, MS, NM, NM_PER_MM
from safeloc.models.motion.unmeasured import Unmeasured
from safeloc.models.vocabulary.error_law import ErrorLaw
from safeloc.models.vocabulary.odometer import Odometer, most_further_error_nm
from safeloc.models.vocabulary.odometer import odometer as measuring_unit


def reported_law(odometer: ErrorLaw, check: ErrorLaw, band_mm: int, unmeasured: Unmeasured | None) -> ErrorLaw:
    """Return the law of the reported distances, without the error reported beyond it.

    Its constant covers either unit, the band, and the run between two pulses of a vehicle that counts as standing.
    """
    between_pulses_mm = 0 if unmeasured is None else unmeasured.between_pulses_mm
    constant = max(odometer.constant_mm, check.constant_mm + 2 * band_mm + between_pulses_mm)
    return ErrorLaw.model_validate(odometer.model_dump() | {"constant_mm": constant})


@dataclass(frozen=True, eq=False)
class UnitCheck:
    """The odometer, the unit that checks it, and the reported distance.

    unmeasured  what a vehicle may run that counts as standing; None: no vehicle counts as standing
    apart       the difference of both units that has not been added to the error bound, nm
    reported, more  the last cycle's distance is reported, and the error to add beyond the odometer's law, nm
    unreported     cycles since a distance was reported
    """

    odometer: Odometer
    unit: Odometer
    band_nm: int
    unmeasured: Unmeasured | None
    apart: NumVar
    reported: BoolVar
    more: NumVar
    unreported: NumVar

    @cached_property
    def checked(self) -> Bool:
        """Both units measured a distance that the vehicle can have run."""
        return self.odometer.admitted & self.unit.admitted

    @cached_property
    def standing(self) -> Bool:
        """The vehicle counts as standing: the odometer measures nothing, and the check unit no more than its floor."""
        if self.unmeasured is None:
            return FALSE
        return self.checked & self._nothing(self.odometer.measured.value, self.unit.measured.value)

    @cached_property
    def stood(self) -> Bool:
        """The vehicle counted as standing in the cycle before."""
        both = self.odometer.gap.eq(0) & self.unit.gap.eq(0)
        return both & self._nothing(self.odometer.last, self.unit.last)

    def _nothing(self, distance: Num, check_distance: Num) -> Bool:
        still = self.unit.law.floor_mm_s * self.unit.limits.period_ms // 1_000
        return distance.eq(0) & between(-still, check_distance, still)

    @cached_property
    def difference(self) -> Num:
        """Distance of the check unit less that of the odometer in the cycle, nm; only where both measured."""
        return exact_to(self.unit.measured.value - self.odometer.measured.value, NM)

    @property
    def disagree(self) -> Bool:
        """Both units differ by more in the cycle than their laws explain."""
        return self.checked & (abs_(self.difference) > self.odometer.most_error + self.unit.most_error)

    @property
    def alone(self) -> Bool:
        """Only one unit measured."""
        return (self.odometer.admitted | self.unit.admitted) & ~self.checked

    @property
    def failed(self) -> Bool:
        """No distance was reported for longer than permitted."""
        return ~self.checked & (self.unreported + 1 > self._unheard_limit)

    @property
    def _unheard_limit(self) -> int:
        return self.odometer.limits.gap_limit

    # ------------------------------------------------------------------ the error to add

    @cached_property
    def _sum(self) -> Num:
        return self.apart + self.difference

    @cached_property
    def apart_after(self) -> Num:
        """The difference that is not added yet: closer to 0 by what costs nothing, and within the band."""
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
        """The reported distance less that of the odometer, mm: so chosen that the error is the same whichever unit is lawful."""
        size = abs_(self._settled)
        gap = maximum(size + self.unit.most_error - self.odometer.most_error, 0)
        half = with_unit(floor_div(minimum(gap, size * 2), 2 * NM_PER_MM), MM)
        signed = ite(self._settled >= 0, half, -half)
        return ite(self.checked & ~self.standing, signed, as_num(0, MM))

    @cached_property
    def distance(self) -> Num:
        """The reported distance, mm; 0 where there is none."""
        return ite(self.checked, self.odometer.measured.value + self.shift, as_num(0, MM))

    @cached_property
    def beyond(self) -> Num:
        """Error to add beyond the odometer's law, or, without a reported distance, beyond the highest speed; nm."""
        shift = exact_to(self.shift, NM)
        either = maximum(self.odometer.most_error + abs_(shift), self.unit.most_error + abs_(self._settled - shift))
        law = self.odometer.law.growth_nm(abs_(self.distance), as_num(0, MS), self.odometer.limits.period_ms)
        run = ite(self.standing, self._uncounted, maximum(either - law, 0))
        return ite(self.checked, run, maximum(self._alone(self.odometer), self._alone(self.unit)))

    @cached_property
    def _uncounted(self) -> Num:
        """Error to add in a cycle of standing, nm: the creep, and what is between two pulses once, in the first of these cycles."""
        if self.unmeasured is None:
            return as_num(0, NM)
        creep = as_num(self.unmeasured.creep_nm(self.unit.limits.period_ms), NM)
        return ite(self.stood, creep, creep + self.unmeasured.between_pulses_nm)

    def _alone(self, one: Odometer) -> Num:
        """Error beyond the highest speed, nm, if this unit's unchecked distance and its law imply a farther run."""
        bound = exact_to(abs_(one.measured.value), NM) + one.most_error
        return ite(one.admitted, maximum(bound - one.limits.blind_nm, 0), as_num(0, NM))

    @property
    def unheard_after(self) -> Num:
        """Cycles since a distance was reported, after this one, counted up to one more than permitted."""
        return ite(self.checked, as_num(0, COUNT), minimum(self.unreported + 1, self._unheard_limit + 1))


def unit_check(
    declared: Declared, odometer: Odometer, law: ErrorLaw, band_mm: int, unmeasured: Unmeasured | None
) -> UnitCheck:
    """Declare the variables of a check by a unit of that law; `unmeasured`: of a standing vehicle, None where standing is not believed."""
    limits, band = odometer.limits, band_mm * NM_PER_MM
    return UnitCheck(
        odometer,
        measuring_unit(law, limits, "check").declare(declared),
        band,
        unmeasured,
        apart=declared.state(number("units_apart_nm", NM, -band, band), first=0),
        reported=declared.state(boolean("distance_reported"), first=False),
        more=declared.state(
            number("reported_more_nm", NM, 0, most_further_error_nm(limits.max_cycle_distance_mm)), first=0
        ),
        unreported=declared.state(
            number("unreported_cycles", COUNT, 0, limits.gap_limit + 1), first=limits.gap_limit + 1
        ),
    )
