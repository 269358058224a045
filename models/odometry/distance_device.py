"""A distance-measuring device: two units of different principle, each with its own position and margins.

The same marker reading sets both units, and both go on measuring; the device reports the values of the unit with the smaller
margin (MRK-D4). A unit is `alive` while its margins are within the tolerance. Otherwise it is dead and has no position.
In each cycle

    own distance admitted   the position moves by it; the margin grows by the unit's own error law
    only the other's        the position moves by that; the margin grows by the other unit's law and one-off constant
    neither                 the position rests; the margin grows by the highest speed x period

Each unit is checked against the other one. The margins grow with the greater of the two distances. Where the two distances
differ by more than both laws explain, one unit is faulty, and each margin also grows by the difference and the other unit's
law: a wheel that slips, slides or stands while the vehicle runs widens its own margin by the distance it misses. With
`single_fault_safe` this is added in every cycle, so that even an undetectably small fault is covered. A distance without the
other unit's distance then moves nothing and counts as missing, since it may come from the faulty unit. The price: no unit is
ever better than the worse law, and missing distances widen the interval much.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from safeloc.language.declared import Declared
from safeloc.language.expr import (
    FALSE,
    TRUE,
    Bool,
    BoolVar,
    Lit,
    Num,
    NumVar,
    Optional,
    abs_,
    as_num,
    between,
    boolean,
    choice,
    enumeration,
    exact_to,
    ite,
    maximum,
    number,
    optional,
    with_unit,
)
from safeloc.language.units import COUNT, MM, MS, NM, PPM, PPM_PER_ONE
from safeloc.models.vocabulary.choose import choose
from safeloc.models.vocabulary.error_law import ErrorLaw
from safeloc.models.vocabulary.interval import Interval
from safeloc.models.vocabulary.measured import ADMITTED, JUMP, MEASURED, MISSING, TOO_FAST, Limits


@dataclass(frozen=True, eq=False)
class Values(Interval):
    """Position (in mm) and margins at one moment: they count while `alive`."""

    alive: Bool

    def better_than(self, other: Values) -> Bool:
        """Return whether it is alive and the other one is dead or has a greater margin."""
        return self.alive & (~other.alive | (self.margin < other.margin))


NOTHING = Values(as_num(0, MM), as_num(0, NM), as_num(0, NM), alive=as_num(1, MM) <= 0)


@dataclass(frozen=True, eq=False)
class Unit:
    """One measuring unit of a device.

    measured      input: the distance measured in the cycle
    alive, position, above, below   state: its values
    last, gap     state: the last admitted distance, and the cycles without one since then
    last_verdict  state: the verdict on the cycle's distance
    """

    name: str
    law: ErrorLaw
    measured: Optional
    alive: BoolVar
    position: NumVar
    above: NumVar
    below: NumVar
    last: NumVar
    gap: NumVar
    last_verdict: NumVar
    limits: Limits

    @property
    def values(self) -> Values:
        """Its values before the step."""
        return Values(self.position, self.above, self.below, self.alive)

    def start_wander_nm(self, device: Device) -> int:
        """Return half of the one-off constant that a reading adds, nm: its own, or with `single_fault_safe` the greater of both units."""
        units = device.units if self.limits.single_fault_safe else (self,)
        return max(unit.law.wander_nm for unit in units)

    def verdict(self) -> Num:
        """Return the verdict on the cycle's distance: admitted, or why not. Its limits are configured, never measured."""
        known = self.gap <= self.limits.gap_limit
        allowed = (self.gap + 1) * self.limits.max_cycle_distance_change_mm
        jump = known & (abs_(self.measured.value - self.last) > _as_mm(allowed))
        too_fast = abs_(self.measured.value) > self.limits.max_cycle_distance_mm
        return ite(~self.measured.present, MISSING, ite(too_fast, TOO_FAST, ite(jump, JUMP, ADMITTED)))


def _as_mm(count_of_mm: Num) -> Num:
    """Return a number of millimetres, given as a count, in mm."""
    return with_unit(count_of_mm, MM)


@dataclass(frozen=True, eq=False)
class Device:
    """Two units at one end of the vehicle.

    run, age      distance and time since the reading that set the device
    by_leading    the leading reader set it, not the trailing one
    """

    name: str
    units: tuple[Unit, Unit]
    run: NumVar
    age: NumVar
    by_leading: BoolVar
    limits: Limits

    @property
    def values(self) -> Values:
        """The values that the device reports before the step."""
        return best(*(unit.values for unit in self.units))


@dataclass(frozen=True, eq=False)
class DeviceState:
    """State of a device after a cycle: its units' values, distance and time since its reading, and whether the leading reader set it."""

    values: tuple[Values, Values]
    run: Num
    age: Num
    by_leading: Bool

    @property
    def alive(self) -> Bool:
        """At least one unit has a position."""
        return self.values[0].alive | self.values[1].alive


def nothing(device: Device) -> DeviceState:
    """Return the state of a device without a position."""
    return DeviceState((NOTHING, NOTHING), as_num(0, MM), as_num(0, device.age.unit), TRUE)


def best(first: Values, second: Values) -> Values:
    """Return the values with the smaller margin; the first ones (wheel pulses) where both are equal."""
    return choose(second.better_than(first), second, first)


def device(declared: Declared, name: str, laws: tuple[ErrorLaw, ErrorLaw], limits: Limits) -> Device:
    """Declare the variables of a device, named `name_kind_...`."""
    first, second = (_unit(declared, f"{name}_{law.kind}", law, limits) for law in laws)
    return Device(
        name,
        (first, second),
        run=declared.state(number(f"{name}_run_mm", MM, 0, limits.position_limit_mm), first=0),
        age=declared.state(number(f"{name}_age_ms", MS, 0, limits.age_limit_ms), first=0),
        by_leading=declared.state(boolean(f"{name}_set_by_leading"), first=True),
        limits=limits,
    )


def _unit(declared: Declared, name: str, law: ErrorLaw, limits: Limits) -> Unit:
    reach, farthest, longest = (
        2 * limits.max_cycle_distance_mm + 1_000,
        limits.position_limit_mm,
        limits.max_cycle_distance_mm,
    )
    return Unit(
        name,
        law,
        measured=declared.sensor(optional(f"{name}_mm", MM, -reach, reach)),
        alive=declared.state(boolean(f"{name}_alive"), first=False),
        position=declared.state(number(f"{name}_position_mm", MM, -farthest, farthest), first=0),
        above=declared.state(number(f"{name}_margin_above_nm", NM, 0, limits.tolerance_nm), first=0),
        below=declared.state(number(f"{name}_margin_below_nm", NM, 0, limits.tolerance_nm), first=0),
        last=declared.state(number(f"{name}_last_mm", MM, -longest, longest), first=0),
        gap=declared.state(number(f"{name}_gap_cycles", COUNT, 0, limits.lone_limit + 1), first=limits.gap_limit + 1),
        last_verdict=declared.state(choice(f"{name}_last_verdict", enumeration(MEASURED)), first=MISSING),
        limits=limits,
    )


@dataclass(frozen=True, eq=False)
class Cycle:
    """Effect of the measured distances of one cycle on a device, readings apart.

    reach, run, age  the greater of both measured distances; distance and time since the device's reading, after the cycle
    failed           its distances are missing for too long, it has run too far or too long, or its units exclude each other
    prolonged        its units' values after the cycle
    """

    device: Device
    admitted: tuple[Bool, Bool]
    reach: Num
    age: Num
    run: Num
    failed: Bool
    prolonged: tuple[Values, Values]

    @property
    def values(self) -> Values:
        """The values that the device reports after the cycle, if no reading sets it."""
        return best(*self.prolonged)

    @property
    def movement(self) -> Num:
        """The signed distance of the cycle: the first unit's, else the second's, else 0."""
        first, second = self.device.units
        return ite(self.admitted[0], first.measured.value, ite(self.admitted[1], second.measured.value, as_num(0, MM)))

    def farthest(self, share_ppm: int) -> tuple[Num, Num]:
        """Return how far the vehicle may have run forwards, and backwards, in this share of the cycle, nm.

        This is the measured distance and the units' error. Where a distance is missing, or a unit drifts since a time that is
        unknown before a reading sets it, it is the distance at the highest speed.
        """
        units, share = self.device.units, Lit(share_ppm, PPM)
        steps = [ite(ok, unit.measured.value, 0) for ok, unit in zip(self.admitted, units, strict=True)]
        wrong = maximum(
            *(unit.law.portion(share_ppm).growth_nm(self.reach, self.age, unit.limits.period_ms) for unit in units)
        )
        sure = self.admitted[0] & self.admitted[1] if not any(unit.law.drift_mm_s2 for unit in units) else FALSE
        unknown = as_num(-(-self.device.limits.blind_nm * share_ppm // PPM_PER_ONE), NM)
        forward = maximum(maximum(*steps) * share + wrong, 0)
        backward = maximum(maximum(*(-step for step in steps)) * share + wrong, 0)
        return ite(sure, forward, unknown), ite(sure, backward, unknown)

    @property
    def state(self) -> DeviceState:
        """The device's state after the cycle, if no reading sets it."""
        return DeviceState(self.prolonged, self.run, self.age, self.device.by_leading)


def cycle(device: Device) -> Cycle:
    """Make the terms of one cycle of a device."""
    limits = device.limits
    admitted = tuple(unit.verdict().eq(ADMITTED) for unit in device.units)
    steps = [ite(ok, unit.measured.value, 0) for ok, unit in zip(admitted, device.units, strict=True)]
    reach = maximum(abs_(steps[0]), abs_(steps[1]))
    age = device.age + limits.period_ms
    run = device.run + reach
    first, second = device.units
    failed = (
        _failed(device, (admitted[0], admitted[1])) | (age > limits.age_limit_ms) | (run > limits.position_limit_mm)
    )
    moved = (
        _prolonged(first, second, (admitted[0], admitted[1]), reach, age, failed),
        _prolonged(second, first, (admitted[1], admitted[0]), reach, age, failed),
    )
    clash = moved[0].alive & moved[1].alive & ~moved[0].meets(moved[1])
    kept = tuple(replace(values, alive=values.alive & ~clash) for values in moved)
    return Cycle(
        device,
        (admitted[0], admitted[1]),
        reach,
        age,
        run,
        failed | clash,
        (kept[0], kept[1]),
    )


def _failed(device: Device, admitted: tuple[Bool, Bool]) -> Bool:
    """Both units are without a distance for too long, or one so long that the other one is unchecked."""
    silent = [~ok & (unit.gap + 1 > device.limits.gap_limit) for ok, unit in zip(admitted, device.units, strict=True)]
    alone = [~ok & (unit.gap + 1 > device.limits.lone_limit) for ok, unit in zip(admitted, device.units, strict=True)]
    return (silent[0] & silent[1]) | alone[0] | alone[1]


def _prolonged(own: Unit, other: Unit, admitted: tuple[Bool, Bool], reach: Num, age: Num, failed: Bool) -> Values:
    limits = own.limits
    growth = own.law.growth_nm(reach, age, limits.period_ms)
    checking = other.law.growth_nm(reach, age, limits.period_ms)
    bridged = checking + 2 * other.law.wander_nm
    alone = ite(admitted[1], _checked(own, other, growth, checking), growth)
    delivered, nothing_delivered = (
        _usable(limits, admitted),
        _nothing_delivered(limits, admitted, reach, (growth, checking)),
    )
    added_error = ite(delivered[0], alone, ite(delivered[1], bridged, nothing_delivered))
    moved = own.position + ite(delivered[0], own.measured.value, ite(delivered[1], other.measured.value, as_num(0, MM)))
    above, below = own.above + added_error, own.below + added_error
    tolerable = maximum(above, below) <= limits.tolerance_nm
    on_line = between(-limits.position_limit_mm, moved, limits.position_limit_mm)
    return Values(moved, above, below, own.alive & ~failed & tolerable & on_line)


def _usable(limits: Limits, admitted: tuple[Bool, Bool]) -> tuple[Bool, Bool]:
    """Select the distances that may move a position: all admitted ones, or, with `single_fault_safe`, only both together."""
    both = admitted[0] & admitted[1]
    return (both, both) if limits.single_fault_safe else admitted


def _nothing_delivered(limits: Limits, admitted: tuple[Bool, Bool], reach: Num, growth: tuple[Num, Num]) -> Num:
    """Error added in a cycle without a usable distance, nm: the farthest possible run, or more if a single unchecked distance implies more."""
    blind = as_num(limits.blind_nm, NM)
    if not limits.single_fault_safe:
        return blind
    farthest = exact_to(reach, NM)
    return ite(
        admitted[0],
        maximum(farthest + growth[0], blind),
        ite(admitted[1], maximum(farthest + growth[1], blind), blind),
    )


def _checked(own: Unit, other: Unit, growth: Num, checking: Num) -> Num:
    """Error added in a cycle in which both units measured, nm: by the own law, or by the other unit's distance and law."""
    apart = exact_to(abs_(own.measured.value - other.measured.value), NM)
    covered = maximum(growth, checking + apart)
    if own.limits.single_fault_safe:
        return covered
    return ite(apart > growth + checking, covered, growth)
