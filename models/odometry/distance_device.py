"""A distance-measuring device: two units of different principle, each carrying its own position and margins.

Both units are set by the same marker reading and go on measuring; the one with the smaller margin speaks for the
device (MRK-D4). A unit is `alive` while its margins are within the tolerance, and dead otherwise: a dead unit has
no position. In each cycle

    own distance admitted   position moves by it; the margin grows by the own law
    only the other's        position moves by that; the margin grows by the other's law and one-off constant
    neither                 position rests; the margin grows by the highest speed x period (a stale sample is charged)

A unit is never judged by itself alone. Growth is charged on the greater of the two units' distances. Where the two
differ by more than both laws explain, one of them is at fault, and each is charged their difference and the other's
law: a wheel that slips, slides or stands while the vehicle runs widens its own margin by what it misses. With
`single_fault_safe` that charge is made in every cycle, so that even a fault too small to be seen is covered, and a
distance that comes alone moves nothing and is charged as if none had come, for it may be the faulty one. The price is
that neither unit is ever better than the worse law, and that drop-outs cost much.
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.expr import (
    FALSE,
    Bool,
    BoolVar,
    Expr,
    Lit,
    Num,
    NumVar,
    Optional,
    Var,
    abs_,
    as_num,
    between,
    boolean,
    choice,
    exact_to,
    ite,
    maximum,
    minimum,
    number,
    optional,
    with_unit,
)
from safeloc.language.machine import Initial
from safeloc.language.units import COUNT, MM, MS, NM, PPM, PPM_PER_ONE, Enumeration
from safeloc.models.vocabulary.error_law import ErrorLaw
from safeloc.models.vocabulary.measured import ADMITTED, JUMP, MEASURED, MISSING, TOO_FAST, Limits


@dataclass(frozen=True, eq=False)
class Values:
    """Position and margins at one moment: truth lies in [position - below, position + above] while `alive`.

    Which margin is which ETCS variable: `safeloc.models.vocabulary.interval`.
    """

    alive: Bool
    position: Num
    above: Num
    below: Num

    @property
    def margin(self) -> Num:
        """The greater of both sides, nm."""
        return maximum(self.above, self.below)

    @property
    def low(self) -> Num:
        """Lower end, nm."""
        return exact_to(self.position, NM) - self.below

    @property
    def high(self) -> Num:
        """Upper end, nm."""
        return exact_to(self.position, NM) + self.above

    def meets(self, other: Values) -> Bool:
        """Whether both intervals have a point in common."""
        return (self.low <= other.high) & (other.low <= self.high)

    def better_than(self, other: Values) -> Bool:
        """Alive, and the other is dead or has a greater margin."""
        return self.alive & (~other.alive | (self.margin < other.margin))


def choose(condition: Bool, then: Values, other: Values) -> Values:
    """`then` where the condition holds, else `other`."""
    return Values(
        ite(condition, then.alive, other.alive),
        ite(condition, then.position, other.position),
        ite(condition, then.above, other.above),
        ite(condition, then.below, other.below),
    )


NOTHING = Values(as_num(1, MM) <= 0, as_num(0, MM), as_num(0, NM), as_num(0, NM))


@dataclass(frozen=True, eq=False)
class Unit:
    """One measuring unit of a device: its input, its state and its law."""

    name: str
    law: ErrorLaw
    step: Optional
    alive: BoolVar
    position: NumVar
    above: NumVar
    below: NumVar
    last: NumVar
    gap: NumVar
    judged: NumVar
    limits: Limits

    @property
    def values(self) -> Values:
        """Its values before the step."""
        return Values(self.alive, self.position, self.above, self.below)

    def start_wander_nm(self, device: Device) -> int:
        """Half of the one-off constant that a reading charges: the own one, or the greater one of the device's units."""
        units = device.units if self.limits.single_fault_safe else (self,)
        return max(unit.law.wander_nm for unit in units)

    def verdict(self) -> Num:
        """Whether this cycle's distance is admitted, and if not, why. The gate is configuration, never a sensor."""
        known = self.gap <= self.limits.gap_limit
        allowed = (self.gap + 1) * self.limits.max_step_change_mm
        jump = known & (abs_(self.step.value - self.last) > as_mm(allowed))
        too_fast = abs_(self.step.value) > self.limits.max_step_mm
        return ite(~self.step.present, MISSING, ite(too_fast, TOO_FAST, ite(jump, JUMP, ADMITTED)))

    def state(self) -> dict[Var, Initial]:
        """State variables with initial values: dead, and not yet heard of."""
        return {
            self.alive: False,
            self.position: 0,
            self.above: 0,
            self.below: 0,
            self.last: 0,
            self.gap: self.limits.gap_limit + 1,
            self.judged: MISSING,
        }

    def listen(self, admitted: Bool) -> dict[Var, Expr]:
        """Updates that happen in every cycle, whatever the mode."""
        ceiling = self.limits.lone_limit + 1
        return {
            self.last: ite(admitted, self.step.value, self.last),
            self.gap: ite(admitted, as_num(0, COUNT), minimum(self.gap + 1, ceiling)),
            self.judged: self.verdict(),
        }

    def become(self, values: Values) -> dict[Var, Expr]:
        """Updates that make `values` its own; a dead unit holds zeros."""
        return {
            self.alive: values.alive,
            self.position: ite(values.alive, values.position, 0),
            self.above: ite(values.alive, values.above, 0),
            self.below: ite(values.alive, values.below, 0),
        }


def as_mm(count_of_mm: Num) -> Num:
    """A multiple of a length, counted: the same number in mm."""
    return with_unit(count_of_mm, MM)


@dataclass(frozen=True, eq=False)
class Device:
    """Two units at one end of the vehicle, with what they share.

    `run` is the distance and `age` the time since the last reference; `by_leading` tells which reader set it.
    """

    name: str
    units: tuple[Unit, Unit]
    run: NumVar
    age: NumVar
    by_leading: BoolVar
    limits: Limits

    @property
    def inputs(self) -> tuple[Optional, Optional]:
        """The measured distances of one cycle."""
        return (self.units[0].step, self.units[1].step)

    @property
    def values(self) -> Values:
        """What the device says before the step."""
        return best(*(unit.values for unit in self.units))

    def state(self) -> dict[Var, Initial]:
        """State variables with their initial values."""
        own: dict[Var, Initial] = {self.run: 0, self.age: 0, self.by_leading: True}
        return self.units[0].state() | self.units[1].state() | own

    def become(self, values: tuple[Values, Values], run: Num, age: Num, by_leading: Bool) -> dict[Var, Expr]:
        """Updates that make the values its own."""
        first, second = (unit.become(value) for unit, value in zip(self.units, values, strict=True))
        alive = values[0].alive | values[1].alive
        shared: dict[Var, Expr] = {self.run: ite(alive, run, 0), self.age: ite(alive, age, 0)}
        return {**first, **second, **shared, self.by_leading: by_leading}


def best(first: Values, second: Values) -> Values:
    """The one that speaks: the smaller margin; the first one (wheel pulses) where both are equal."""
    return choose(second.better_than(first), second, first)


def device(name: str, laws: tuple[ErrorLaw, ErrorLaw], limits: Limits) -> Device:
    """A device with fresh variables, named `name_kind_...`."""
    first, second = (_unit(f"{name}_{law.kind}", law, limits) for law in laws)
    run = number(f"{name}_run_mm", MM, 0, limits.position_limit_mm)
    age = number(f"{name}_age_ms", MS, 0, limits.age_limit_ms)
    return Device(name, (first, second), run, age, boolean(f"{name}_set_by_leading"), limits)


def _unit(name: str, law: ErrorLaw, limits: Limits) -> Unit:
    reach = 2 * limits.max_step_mm + 1_000
    measured = MEASURED[0].unit
    assert isinstance(measured, Enumeration)
    return Unit(
        name,
        law,
        optional(f"{name}_mm", MM, -reach, reach),
        boolean(f"{name}_alive"),
        number(f"{name}_position_mm", MM, -limits.position_limit_mm, limits.position_limit_mm),
        number(f"{name}_margin_above_nm", NM, 0, limits.tolerance_nm),
        number(f"{name}_margin_below_nm", NM, 0, limits.tolerance_nm),
        number(f"{name}_last_mm", MM, -limits.max_step_mm, limits.max_step_mm),
        number(f"{name}_gap_cycles", COUNT, 0, limits.lone_limit + 1),
        choice(f"{name}_judged", measured),
        limits,
    )


@dataclass(frozen=True, eq=False)
class Cycle:
    """What one cycle's measurements do to a device: computed once, shared by all transitions."""

    device: Device
    admitted: tuple[Bool, Bool]
    reach: Num
    age: Num
    run: Num
    failed: Bool
    prolonged: tuple[Values, Values]

    @property
    def values(self) -> Values:
        """What the device says after running on, without a reading."""
        return best(*self.prolonged)

    @property
    def movement(self) -> Num:
        """The signed distance of this cycle: the first unit's, else the second's, else 0."""
        first, second = self.device.units
        return ite(self.admitted[0], first.step.value, ite(self.admitted[1], second.step.value, as_num(0, MM)))

    def farthest(self, share_ppm: int) -> tuple[Num, Num]:
        """How far the vehicle may have run forwards, and backwards, in this share of the cycle, nm.

        What was measured is not what was run: the units' laws are charged. Where not both measured, or a unit drifts with a
        time that nobody knows before it is set, it is the highest speed.
        """
        units, share = self.device.units, Lit(share_ppm, PPM)
        steps = [ite(ok, unit.step.value, 0) for ok, unit in zip(self.admitted, units, strict=True)]
        wrong = maximum(
            *(unit.law.portion(share_ppm).growth_nm(self.reach, self.age, unit.limits.period_ms) for unit in units)
        )
        sure = self.admitted[0] & self.admitted[1] if not any(unit.law.drift_mm_s2 for unit in units) else FALSE
        unknown = as_num(-(-self.device.limits.blind_nm * share_ppm // PPM_PER_ONE), NM)
        forward = maximum(maximum(*steps) * share + wrong, 0)
        backward = maximum(maximum(*(-step for step in steps)) * share + wrong, 0)
        return ite(sure, forward, unknown), ite(sure, backward, unknown)

    def listen(self) -> dict[Var, Expr]:
        """Updates that happen in every cycle."""
        first, second = self.device.units
        return {**first.listen(self.admitted[0]), **second.listen(self.admitted[1])}


def cycle(device: Device) -> Cycle:
    """The terms of one cycle."""
    limits = device.limits
    admitted = tuple(unit.verdict().eq(ADMITTED) for unit in device.units)
    steps = [ite(ok, unit.step.value, 0) for ok, unit in zip(admitted, device.units, strict=True)]
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
    kept = tuple(Values(values.alive & ~clash, values.position, values.above, values.below) for values in moved)
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
    """Both units silent too long, or one silent so long that nothing checks the other."""
    silent = [~ok & (unit.gap + 1 > device.limits.gap_limit) for ok, unit in zip(admitted, device.units, strict=True)]
    alone = [~ok & (unit.gap + 1 > device.limits.lone_limit) for ok, unit in zip(admitted, device.units, strict=True)]
    return (silent[0] & silent[1]) | alone[0] | alone[1]


def _prolonged(own: Unit, other: Unit, admitted: tuple[Bool, Bool], reach: Num, age: Num, failed: Bool) -> Values:
    limits = own.limits
    growth = own.law.growth_nm(reach, age, limits.period_ms)
    checking = other.law.growth_nm(reach, age, limits.period_ms)
    bridged = checking + 2 * other.law.wander_nm
    alone = ite(admitted[1], _checked(own, other, growth, checking), growth)
    heard, unheard = _usable(limits, admitted), _unheard(limits, admitted, reach, (growth, checking))
    charge = ite(heard[0], alone, ite(heard[1], bridged, unheard))
    moved = own.position + ite(heard[0], own.step.value, ite(heard[1], other.step.value, as_num(0, MM)))
    above, below = own.above + charge, own.below + charge
    tolerable = maximum(above, below) <= limits.tolerance_nm
    on_line = between(-limits.position_limit_mm, moved, limits.position_limit_mm)
    return Values(own.alive & ~failed & tolerable & on_line, moved, above, below)


def _usable(limits: Limits, admitted: tuple[Bool, Bool]) -> tuple[Bool, Bool]:
    """Which distances may move a position: all admitted ones, or, where one may be faulty, only both together."""
    both = admitted[0] & admitted[1]
    return (both, both) if limits.single_fault_safe else admitted


def _unheard(limits: Limits, admitted: tuple[Bool, Bool], reach: Num, growth: tuple[Num, Num]) -> Num:
    """The charge where the position rests: the farthest the vehicle gets, or what a lone lawful distance may mean."""
    blind = as_num(limits.blind_nm, NM)
    if not limits.single_fault_safe:
        return blind
    said = exact_to(reach, NM)
    return ite(
        admitted[0],
        maximum(said + growth[0], blind),
        ite(admitted[1], maximum(said + growth[1], blind), blind),
    )


def _checked(own: Unit, other: Unit, growth: Num, checking: Num) -> Num:
    """The charge where both units measured: the own law, or what the other unit says is missing."""
    apart = exact_to(abs_(own.step.value - other.step.value), NM)
    covered = maximum(growth, checking + apart)
    if own.limits.single_fault_safe:
        return covered
    return ite(apart > growth + checking, covered, growth)
