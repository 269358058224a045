"""What one cycle means to the odometry machine: measurements, readings, and the values after it.

Every term is built once and shared by all transitions, the assumption and the properties.
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.expr import TRUE, Bool, Expr, Num, Var, abs_, all_of, any_of, as_num, ite, maximum
from safeloc.language.units import COUNT, MM
from safeloc.models.odometry.distance_device import NOTHING, Cycle, Device, Values, best, choose, cycle
from safeloc.models.odometry.marker_reading import (
    ACCEPTED,
    CANDIDATE,
    FOREIGN,
    MALFORMED,
    NONE,
    NOT_BETTER,
    OUT_OF_ORDER,
    OUT_OF_WINDOW,
    REPEATED,
    TOO_COARSE,
    UNCONFIRMED,
    UNPAIRED,
    Fix,
    fix,
)
from safeloc.models.odometry.variables import Parts
from safeloc.models.vocabulary.first_of import first_of


@dataclass(frozen=True, eq=False)
class Situation:
    """In which kind of mode the machine is: something is reported, a candidate waits, or neither."""

    located: Bool
    candidate: Bool
    lost: Bool


@dataclass(frozen=True, eq=False)
class Reading:
    """The judgement on one reader's reading in this cycle."""

    end: int
    device: Device
    fix: Fix
    fresh: tuple[Values, Values]
    verdict: Num
    leading: Bool

    @property
    def accepted(self) -> Bool:
        """It passed every check and sets its device."""
        return self.verdict.eq(ACCEPTED)

    @property
    def is_candidate(self) -> Bool:
        """It passed every check that can be made without a position, and waits for a second marker."""
        return self.verdict.eq(CANDIDATE)

    @property
    def consistent(self) -> Bool:
        """It fits what is known, whether or not it sets the device."""
        return self.verdict.one_of(ACCEPTED, CANDIDATE, NOT_BETTER)


@dataclass(frozen=True, eq=False)
class Judged:
    """One cycle, judged."""

    own: Parts
    cycles: tuple[Cycle, ...]
    readings: tuple[Reading, Reading]
    reversed: Bool
    heading: dict[Var, Expr]

    def moved(self, device: Device) -> Cycle:
        """The measurements of a device."""
        return next(moved for moved in self.cycles if moved.device is device)

    def setting(self, device: Device) -> tuple[Reading, ...]:
        """The readings that can set a device."""
        return tuple(reading for reading in self.readings if reading.device is device)

    def was_set(self, device: Device) -> Bool:
        """An accepted reading sets the device in this cycle."""
        return any_of(reading.accepted for reading in self.setting(device))

    def after(self, device: Device) -> tuple[Values, Values]:
        """The units' values after the cycle: set by a reading, the leading one first, or run on."""
        first, second = self.moved(device).prolonged
        for reading in self.setting(device):
            decides = reading.accepted & (reading.leading | ~self._leading_sets(device))
            first, second = choose(decides, reading.fresh[0], first), choose(decides, reading.fresh[1], second)
        return first, second

    def _leading_sets(self, device: Device) -> Bool:
        return any_of(reading.accepted & reading.leading for reading in self.setting(device))

    def says(self, device: Device) -> Values:
        """What the device says after the cycle."""
        return best(*self.after(device))

    @property
    def any_alive(self) -> Bool:
        """Some device still has a position after the cycle."""
        return any_of(self.says(device).alive for device in self.own.devices)

    @property
    def any_prolonged(self) -> Bool:
        """Some device still has a position, readings apart."""
        return any_of(moved.values.alive for moved in self.cycles)

    @property
    def clash(self) -> Bool:
        """Both devices have a position, and the two exclude each other."""
        if len(self.own.devices) == 1:
            return ~TRUE
        front, rear = (self.says(device) for device in self.own.devices)
        return front.alive & rear.alive & ~front.meets(rear)

    def become(self, device: Device) -> dict[Var, Expr]:
        """The device's updates in a cycle that keeps the position."""
        set_now, moved = self.was_set(device), self.moved(device)
        run = ite(set_now, self._run_since(device), moved.run)
        age = ite(set_now, as_num(self.own.config.period_ms, moved.age.unit), moved.age)
        by_leading = ite(set_now, self._leading_sets(device), device.by_leading)
        return device.become(self.after(device), run, age, by_leading)

    def _run_since(self, device: Device) -> Num:
        runs = [(r.accepted, abs_(self.own.readers[r.end].since.value_or(as_num(0, MM)))) for r in self.setting(device)]
        return first_of(*runs, default=as_num(0, MM))

    def become_only(self, reading: Reading) -> dict[Var, Expr]:
        """Only the reading's device has values, those of the reading; any other device has none."""
        updates: dict[Var, Expr] = {}
        for device in self.own.devices:
            if device is reading.device:
                since = abs_(self.own.readers[reading.end].since.value_or(as_num(0, MM)))
                age = as_num(self.own.config.period_ms, device.age.unit)
                updates |= device.become(reading.fresh, since, age, TRUE)
            else:
                updates |= nothing(device)
        return updates

    def run_on(self) -> dict[Var, Expr]:
        """All devices run on, readings apart."""
        updates: dict[Var, Expr] = {}
        for moved in self.cycles:
            updates |= moved.device.become(moved.prolonged, moved.run, moved.age, moved.device.by_leading)
        return updates

    def listen(self) -> dict[Var, Expr]:
        """Updates of every cycle, whatever the mode: what was heard and how it was judged."""
        updates: dict[Var, Expr] = dict(self.heading)
        for moved in self.cycles:
            updates |= moved.listen()
        for reader, reading in zip(self.own.readers, self.readings, strict=True):
            updates[reader.verdict] = reading.verdict
        return updates

    def remember(self) -> dict[Var, Expr]:
        """Identities after the cycle: the pending ones, and the last one the leading reader met."""
        led = [(r.consistent & r.leading, self.own.readers[r.end]) for r in self.readings]
        passed = [(r.consistent & ~r.leading, self.own.readers[r.end].marker.value) for r in self.readings]
        zero = as_num(0, COUNT)
        last = first_of(*((ok, by.marker.value) for ok, by in led), default=self.own.last_marker)
        place = first_of(*((ok, by.place.value) for ok, by in led), default=self.own.last_place)
        queue = self.own.pending.after(
            passed[0][0] | passed[1][0], first_of(*passed, default=zero), led[0][0] | led[1][0], last, ~self.reversed
        )
        kept: dict[Var, Expr] = {self.own.last_marker: ite(self.reversed, zero, last), self.own.last_place: place}
        return {**queue, **kept}

    def remember_only(self, reading: Reading) -> dict[Var, Expr]:
        """Only this reading's identity is remembered."""
        reader, zero = self.own.readers[reading.end], as_num(0, COUNT)
        marker = ite(self.reversed, zero, reader.marker.value)
        first, *rest = self.own.pending.places
        return {
            first: marker,
            **dict.fromkeys(rest, zero),
            self.own.last_marker: marker,
            self.own.last_place: reader.place.value,
        }

    def forget(self) -> dict[Var, Expr]:
        """No identity is remembered."""
        zero = as_num(0, COUNT)
        return {**dict.fromkeys(self.own.pending.places, zero), self.own.last_marker: zero}


def nothing(device: Device) -> dict[Var, Expr]:
    """Updates after which the device has no position."""
    return device.become((NOTHING, NOTHING), as_num(0, MM), as_num(0, device.age.unit), TRUE)


def judge(own: Parts, situation: Situation) -> Judged:
    """Judge one cycle's measurements and readings."""
    cycles = tuple(cycle(device) for device in own.devices)
    reference = cycles[0].values if len(cycles) == 1 else best(cycles[0].values, cycles[1].values)
    readings = tuple(_reading(own, end, cycles, reference, situation) for end in (0, 1))
    reversed_, heading = _heading(own, cycles)
    return Judged(own, cycles, (readings[0], readings[1]), reversed_, heading)


def _heading(own: Parts, cycles: tuple[Cycle, ...]) -> tuple[Bool, dict[Var, Expr]]:
    """The direction of travel turns when more than `reversal_mm` were run against it without a break."""
    movement = cycles[-1].movement
    for moved in reversed(cycles[:-1]):
        movement = ite(moved.admitted[0] | moved.admitted[1], moved.movement, movement)
    rolled = maximum(own.rolled + ite(own.backwards, movement, -movement), 0)
    turned = rolled > own.config.reversal_mm
    return turned, {own.rolled: ite(turned, 0, rolled), own.backwards: ite(turned, ~own.backwards, own.backwards)}


def _reading(own: Parts, end: int, cycles: tuple[Cycle, ...], reference: Values, situation: Situation) -> Reading:
    device = own.set_by(end)
    moved = next(one for one in cycles if one.device is device)
    found, limits, reader = fix(own.readers[end], moved), device.limits, own.readers[end]
    fresh = tuple(
        found.values(unit.start_wander_nm(device), limits.tolerance_nm, limits.position_limit_mm)
        for unit in device.units
    )
    malformed, foreign = reader.flaw()
    coarse = ~(fresh[0].alive | fresh[1].alive)
    outside = ~found.meets(reference)
    kept = moved.values.alive & (moved.values.margin <= best(fresh[0], fresh[1]).margin)
    trusted = CANDIDATE if not own.config.trust_first_marker else ACCEPTED
    leading = first_of(
        (own.last_marker.eq(reader.marker.value), REPEATED),
        (_behind(own, end), OUT_OF_ORDER),
        (coarse, TOO_COARSE),
        (situation.lost, trusted),
        (situation.candidate & (~reference.alive | outside), CANDIDATE),
        (~reference.alive, UNCONFIRMED),
        (outside, OUT_OF_WINDOW),
        (situation.located & kept, NOT_BETTER),
        default=ACCEPTED,
    )
    trailing = first_of(
        (~own.pending.has(reader.marker.value), UNPAIRED),
        (~situation.located | ~reference.alive, UNCONFIRMED),
        (coarse, TOO_COARSE),
        (outside, OUT_OF_WINDOW),
        (kept, NOT_BETTER),
        default=ACCEPTED,
    )
    leads = own.leads(end)
    verdict = first_of(
        (malformed, MALFORMED),
        (~reader.marker.present, NONE),
        (foreign, FOREIGN),
        (leads, leading),
        default=trailing,
    )
    return Reading(end, device, found, (fresh[0], fresh[1]), verdict, leads)


def _behind(own: Parts, end: int) -> Bool:
    """The marker lies behind the last one the leading reader met, or at the same place."""
    place = own.readers[end].place.value
    behind = ite(own.backwards, place >= own.last_place, place <= own.last_place)
    return all_of([own.last_marker.ne(0), behind])
