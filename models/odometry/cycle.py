"""One cycle of the odometry machine: its measurements, the verdicts on its readings, and the values after it.

The table (`models/odometry/__init__.py`) states which transition sets which of these values.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from safeloc.language.expr import FALSE, TRUE, Bool, Num, abs_, all_of, any_of, as_num, ite, maximum
from safeloc.language.units import COUNT, MM
from safeloc.models.odometry.distance_device import Cycle, Device, DeviceState, Values, best, cycle
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
from safeloc.models.odometry.satellite_reading import SatelliteReader
from safeloc.models.odometry.variables import Parts
from safeloc.models.vocabulary.choose import choose
from safeloc.models.vocabulary.first_of import first_of


@dataclass(frozen=True, eq=False)
class Situation:
    """The kind of mode before the cycle: a position is reported, a candidate waits, or neither."""

    located: Bool
    candidate: Bool
    lost: Bool


@dataclass(frozen=True, eq=False)
class Reading:
    """A reading in the cycle, with the verdict on it.

    device   the device that it sets; fresh: the values of its units then
    leading  it begins the values M1: the reader is the leading one, or satellites gave the position
    since    the distance run since the reading, mm
    """

    device: Device
    fix: Fix
    fresh: tuple[Values, Values]
    verdict: Num
    leading: Bool
    since: Num

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
class MarkerReading(Reading):
    """The reading of the reader at that end of the vehicle: 0 (A, front) or 1 (B, rear)."""

    end: int


@dataclass(frozen=True, eq=False)
class Heading:
    """The direction of travel after a cycle: `turned` in it, and the distance run against it without a break."""

    turned: Bool
    backwards: Bool
    rolled: Num


@dataclass(frozen=True, eq=False)
class Remembered:
    """Identities after a cycle: those that wait for the trailing reader, and the last one that the leading reader read."""

    pending: list[Num]
    last_marker: Num
    last_place: Num


@dataclass(frozen=True, eq=False)
class Judgement:
    """One cycle with all verdicts.

    cycles      the measurements, one for each device
    readings    the readings of both readers
    satellites  the position of satellites, where they give any
    heading     the direction of travel after it; `reversed` where it turned in this cycle
    """

    own: Parts
    cycles: tuple[Cycle, ...]
    readings: tuple[MarkerReading, MarkerReading]
    satellites: Reading | None
    heading: Heading

    @property
    def reversed(self) -> Bool:
        """The direction of travel turns in the cycle."""
        return self.heading.turned

    def moved(self, device: Device) -> Cycle:
        """Return the measurements of a device."""
        return next(moved for moved in self.cycles if moved.device is device)

    def setting(self, device: Device) -> tuple[Reading, ...]:
        """Return the readings that can set a device."""
        every = self.readings if self.satellites is None else (*self.readings, self.satellites)
        return tuple(reading for reading in every if reading.device is device)

    def was_set(self, device: Device) -> Bool:
        """Return whether an accepted reading sets the device in the cycle."""
        return any_of(reading.accepted for reading in self.setting(device))

    def after(self, device: Device) -> tuple[Values, Values]:
        """Return the units' values after the cycle: set by a reading, the leading one first, or prolonged."""
        first, second = self.moved(device).prolonged
        for reading in self.setting(device):
            decides = reading.accepted & (reading.leading | ~self._leading_sets(device))
            first, second = choose(decides, reading.fresh[0], first), choose(decides, reading.fresh[1], second)
        return first, second

    def _leading_sets(self, device: Device) -> Bool:
        return any_of(reading.accepted & reading.leading for reading in self.setting(device))

    def says(self, device: Device) -> Values:
        """Return the values that the device reports after the cycle."""
        return best(*self.after(device))

    @property
    def any_alive(self) -> Bool:
        """Some device still has a position after the cycle."""
        return any_of(self.says(device).alive for device in self.own.devices)

    @property
    def any_prolonged(self) -> Bool:
        """Some device still has a position after the cycle, readings apart."""
        return any_of(moved.values.alive for moved in self.cycles)

    @property
    def clash(self) -> Bool:
        """Both devices have a position, and the two exclude each other."""
        if len(self.own.devices) == 1:
            return ~TRUE
        front, rear = (self.says(device) for device in self.own.devices)
        return front.alive & rear.alive & ~front.meets(rear)

    def state_after(self, device: Device) -> DeviceState:
        """Return the device's state after the cycle: set by a reading, or prolonged."""
        set_now, moved = self.was_set(device), self.moved(device)
        return DeviceState(
            self.after(device),
            run=ite(set_now, first_of(*self._runs_since(device), default=as_num(0, MM)), moved.run),
            age=ite(set_now, as_num(self.own.config.period_ms, moved.age.unit), moved.age),
            by_leading=ite(set_now, self._leading_sets(device), device.by_leading),
        )

    def _runs_since(self, device: Device) -> list[tuple[Bool, Num]]:
        return [(reading.accepted, reading.since) for reading in self.setting(device)]

    def state_set_by(self, reading: Reading) -> DeviceState:
        """Return the state of the reading's device if that reading sets it."""
        age = as_num(self.own.config.period_ms, reading.device.age.unit)
        return DeviceState(reading.fresh, reading.since, age, TRUE)

    def remembered(self) -> Remembered:
        """Return the identities after a cycle that keeps the position."""
        own = self.own
        led = [(r.consistent & r.leading, own.readers[r.end]) for r in self.readings]
        passed = [(r.consistent & ~r.leading, own.readers[r.end].marker.value) for r in self.readings]
        zero = as_num(0, COUNT)
        last = first_of(*((ok, by.marker.value) for ok, by in led), default=own.last_marker)
        place = first_of(*((ok, by.place.value) for ok, by in led), default=own.last_marker_position)
        queue = own.pending.after(
            passed[0][0] | passed[1][0], first_of(*passed, default=zero), led[0][0] | led[1][0], last, ~self.reversed
        )
        return Remembered(queue, ite(self.reversed, zero, last), place)

    def remembered_of(self, reading: MarkerReading) -> Remembered:
        """Return the identities if nothing but this reading's is remembered."""
        reader, zero = self.own.readers[reading.end], as_num(0, COUNT)
        marker = ite(self.reversed, zero, reader.marker.value)
        return Remembered([marker, *[zero] * (len(self.own.pending.places) - 1)], marker, reader.place.value)


def judge(own: Parts, situation: Situation) -> Judgement:
    """Make the verdicts on one cycle's measurements and readings."""
    cycles = tuple(cycle(device) for device in own.devices)
    reference = cycles[0].values if len(cycles) == 1 else best(cycles[0].values, cycles[1].values)
    front, rear = (_reading(own, end, cycles, reference, situation) for end in (0, 1))
    satellites = None
    if own.satellites is not None:
        satellites = _position(own, own.satellites, (front, rear), cycles[0], reference, situation)
    return Judgement(own, cycles, (front, rear), satellites, _heading(own, cycles))


def _heading(own: Parts, cycles: tuple[Cycle, ...]) -> Heading:
    """The direction of travel turns when more than `reversal_mm` were run against it without a break."""
    movement = cycles[-1].movement
    for moved in reversed(cycles[:-1]):
        movement = ite(moved.admitted[0] | moved.admitted[1], moved.movement, movement)
    rolled = maximum(own.rolled + ite(own.backwards, movement, -movement), 0)
    turned = rolled > own.config.reversal_mm
    return Heading(turned, ite(turned, ~own.backwards, own.backwards), ite(turned, 0, rolled))


def _position(
    own: Parts,
    reader: SatelliteReader,
    readings: Sequence[Reading],
    moved: Cycle,
    reference: Values,
    situation: Situation,
) -> Reading:
    """The position of satellites: it sets the front device, unless a marker is taken in the same cycle.

    Satellites do not confirm their own candidate: a position that is wrong may stay wrong for long.
    """
    found, device = reader.fix, moved.device
    fresh = _fresh(found, device)
    outside, alive = ~found.fits(reference), fresh[0].alive | fresh[1].alive
    kept = moved.values.alive & (moved.values.margin <= best(*fresh).margin)
    own_candidate = FALSE if reader.candidate_of_satellites is None else reader.candidate_of_satellites
    verdict = first_of(
        (~reader.place.present, NONE),
        (any_of(reading.accepted | reading.is_candidate for reading in readings), NOT_BETTER),
        (~alive, TOO_COARSE),
        (situation.lost, ACCEPTED if own.config.trust_first_marker else CANDIDATE),
        (situation.candidate & (own_candidate | ~reference.alive | outside), CANDIDATE),
        (~reference.alive, UNCONFIRMED),
        (outside, OUT_OF_WINDOW),
        (situation.located & kept, NOT_BETTER),
        default=ACCEPTED,
    )
    return Reading(device, found, fresh, verdict, TRUE, as_num(0, MM))


def _fresh(found: Fix, device: Device) -> tuple[Values, Values]:
    """Return the values of the device's units if a reading sets it."""
    limits = device.limits
    first, second = (
        found.values(unit.start_wander_nm(device), limits.tolerance_nm, limits.position_limit_mm)
        for unit in device.units
    )
    return first, second


def _reading(own: Parts, end: int, cycles: tuple[Cycle, ...], reference: Values, situation: Situation) -> MarkerReading:
    device = own.set_by(end)
    moved = next(one for one in cycles if one.device is device)
    found, reader = fix(own.readers[end], moved), own.readers[end]
    fresh = _fresh(found, device)
    malformed, foreign = reader.flaw()
    coarse = ~(fresh[0].alive | fresh[1].alive)
    outside = ~found.fits(reference)
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
    return MarkerReading(device, found, fresh, verdict, leads, abs_(reader.since.value_or(as_num(0, MM))), end)


def _behind(own: Parts, end: int) -> Bool:
    """The marker lies behind the last one that the leading reader read, or at the same place."""
    place = own.readers[end].place.value
    behind = ite(own.backwards, place >= own.last_marker_position, place <= own.last_marker_position)
    return all_of([own.last_marker.ne(0), behind])
