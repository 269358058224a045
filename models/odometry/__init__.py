"""Odometry between position markers, with a reader at the front and one at the rear (MRK-1 to MRK-5).

Passing a marker with the LEADING reader sets the device at that end (values M1); when the TRAILING reader passes
the same marker, the device at its end is set again (values M2), until the leading reader meets the next marker.
Which end leads follows from the direction of travel. In the one-device variant both readers set the same device.

    DELOCALIZED  no reference, or lost: nothing is reported
    CANDIDATE    one marker was read; nothing is reported until a different marker agrees with it (not if the first is trusted)
    FRONT        the device at end A gives the position
    REAR         the device at end B gives the position (two-device variant)

A device takes over when a reading has set it or its margin has become the smaller one, never with a greater margin
(MRK-D3). The position is that of end A, in mm along the line, growing in the direction from end B to end A.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from safeloc.language.expr import (
    FALSE,
    TRUE,
    Bool,
    Expr,
    Lit,
    Num,
    Var,
    any_of,
    as_num,
    ceil_to,
    ite,
    members,
    minimum,
)
from safeloc.language.machine import Machine, Model, Transition, current_mode, modes
from safeloc.language.rows import Updates, together
from safeloc.language.units import COUNT, MM, Enumeration
from safeloc.models.odometry.cycle import Judgement, Reading, Remembered, Situation, judge
from safeloc.models.odometry.distance_device import Cycle, Device, DeviceState, Values, nothing
from safeloc.models.odometry.hidden_faults import with_hidden
from safeloc.models.odometry.lemmas import lemmas
from safeloc.models.odometry.marker_reading import ACCEPTED
from safeloc.models.odometry.variables import OdometryConfig, Parts, parts
from safeloc.models.odometry.world import world
from safeloc.models.vocabulary.absent import margin_if, position_if
from safeloc.models.vocabulary.choose import choose
from safeloc.models.vocabulary.reasons import CONTRADICTION, LOCATED, SENSOR_FAILURE, TOLERANCE

VALUES = members("values", "NONE", "M1", "M2")
NO_VALUES, M1, M2 = VALUES
UNIT = members("unit", "NONE", "FIRST", "SECOND")
NO_UNIT, FIRST_UNIT, SECOND_UNIT = UNIT
ENDS = ("front", "rear")


def machine(config: OdometryConfig | None = None) -> Machine:
    """Return the odometry machine of a vehicle (MRK-1 to MRK-6, MRK-D1 to MRK-D6, without the latch of the delocalized state)."""
    return build(parts(config or OdometryConfig())).machine


@dataclass(frozen=True, eq=False)
class Odometry(Model[Parts]):
    """The machine together with the terms it was built from, for properties to speak about."""

    judgement: Judgement

    @property
    def lead(self) -> Values:
        """The reported values: those of the device that the mode names."""
        return lead(self.own, self.machine.mode)


def build(own: Parts, name: str = "odometry") -> Odometry:
    """Build the machine over the given variables."""
    waits = [] if own.config.trust_first_marker else ["CANDIDATE"]
    mode = modes("DELOCALIZED", *waits, "FRONT", *(["REAR"] if len(own.devices) == 2 else []))
    current = current_mode(mode)
    located = _located_modes(own, mode)
    situation = Situation(current.one_of(*located), current.eq(mode[1]) if waits else FALSE, current.eq(mode[0]))
    judgement = judge(own, situation)
    made = own.declared.machine(
        name=name,
        modes=mode,
        outputs=_outputs(own, current, mode),
        transitions=[*_located(own, judgement, mode), *_unlocated(own, judgement, mode)],
        world=with_hidden(world(own), judgement),
        lemmas=lemmas(own, situation, [current.eq(one) for one in located]),
        definitions=_definitions(own, judgement),
        doc=(
            "Position of end A of the vehicle from the distance measured since position markers, which a reader at either "
            "end reads. Assumed: each unit delivers a distance that obeys its error law, or one that no vehicle can have run; the "
            "vehicle keeps to its highest speed and is as long as its data say; a reader stood, within its latency, over the marker "
            "that it reports, and the map has this marker within its accuracy. Once in the age limit a reader may report a marker "
            "that lies far away instead (never, if the first marker is trusted at once)."
        ),
    )
    return Odometry(made, own, judgement)


# ------------------------------------------------------------------ the transition table


def _located(own: Parts, cycle: Judgement, mode: tuple[Lit, ...]) -> Iterator[Transition]:
    """Transitions out of the modes that report a position."""
    lost, located = mode[0], _located_modes(own, mode)
    failed = any_of(moved.device.alive & moved.failed for moved in cycle.cycles)
    gone = ~cycle.any_alive
    keep = together(
        _seen(own, cycle), _set_or_prolonged(own, cycle), _identities(own, cycle.remembered()), {own.reason: LOCATED}
    )

    def drop(reason: Lit) -> Updates:
        return together(_seen(own, cycle), _no_position(own), _no_identities(own), {own.reason: reason})

    if len(own.devices) == 2:
        yield Transition(
            "devices contradict each other", located, lost, cycle.clash, drop(CONTRADICTION), ("MRK-D1",), 0
        )
    yield Transition("sensors failed", located, lost, gone & failed, drop(SENSOR_FAILURE), ("MRK-D1",), 1)
    yield Transition("tolerance exceeded", located, lost, gone, drop(TOLERANCE), ("MRK-D1",), 2)
    for reading in cycle.readings:
        device, end = _index(own, reading.device), ENDS[reading.end]
        when = reading.accepted & reading.leading & _leads(own, cycle, device)
        yield Transition(
            f"leading reading at {end}", located, located[device], when, keep, ("MRK-1", "MRK-5", "MRK-D6"), 3
        )
    for reading in cycle.readings:
        device, end = _index(own, reading.device), ENDS[reading.end]
        when = reading.accepted & ~reading.leading & _leads(own, cycle, device)
        yield Transition(f"trailing reading at {end}", located, located[device], when, keep, ("MRK-1", "MRK-5"), 4)
    if cycle.satellites is not None:
        when = cycle.satellites.accepted & _leads(own, cycle, 0)
        yield Transition("position of satellites", located, located[0], when, keep, ("MRK-D6",), 4)
    for device, other in ((0, 1), (1, 0))[: 2 * (len(own.devices) - 1)]:
        name = f"hand over to {ENDS[device]} device"
        yield Transition(name, located[other], located[device], _takes_over(own, cycle, device), keep, ("MRK-D3",), 5)
    for device, target in enumerate(located):
        yield Transition(f"run on {ENDS[device]} device", target, target, TRUE, keep, ("MRK-4", "MRK-D4"), 6)


def _unlocated(own: Parts, cycle: Judgement, mode: tuple[Lit, ...]) -> Iterator[Transition]:
    """Transitions out of the modes that report nothing; no candidate waits where the first reference is trusted."""
    yield from _trusted(own, cycle, mode) if own.config.trust_first_marker else _confirmed(own, cycle, mode)
    yield Transition("wait for a marker", mode[0], mode[0], TRUE, _seen(own, cycle), ("MRK-D1",), 9)


def _trusted(own: Parts, cycle: Judgement, mode: tuple[Lit, ...]) -> Iterator[Transition]:
    """Transitions by which the first reference alone gives the position."""
    lost, located = mode[0], _located_modes(own, mode)
    found: Updates = {own.reason: LOCATED}
    for reading in cycle.readings:
        end, target, sure = ENDS[reading.end], located[_index(own, reading.device)], reading.accepted & reading.leading
        alone = _identities(own, cycle.remembered_of(reading))
        set_by_it = together(_seen(own, cycle), _only_by(own, cycle, reading), alone, found)
        yield Transition(f"trusted marker at {end}", lost, target, sure, set_by_it, ("MRK-1",), 7)
    if cycle.satellites is not None:
        position = cycle.satellites
        set_by_it = together(_seen(own, cycle), _only_by(own, cycle, position), found, _no_identities(own))
        name = "trusted position of satellites"
        yield Transition(name, lost, located[0], position.accepted, set_by_it, ("MRK-D6",), 7)


def _confirmed(own: Parts, cycle: Judgement, mode: tuple[Lit, ...]) -> Iterator[Transition]:
    """Transitions by which a second reference that agrees with the candidate gives the position, and those of the candidate."""
    lost, candidate, *located = mode
    waiting, seen = (lost, candidate), _seen(own, cycle)
    located_now: Updates = {own.reason: LOCATED}
    of_marker = _candidate_of_satellites(own, FALSE)
    for reading in cycle.readings:
        end, target, leads = ENDS[reading.end], located[_index(own, reading.device)], reading.leading
        taken, sure = reading.is_candidate & leads, reading.accepted & leads
        only = together(seen, _only_by(own, cycle, reading))
        alone, both = (_identities(own, one) for one in (cycle.remembered_of(reading), cycle.remembered()))
        first, agreed = together(only, alone, of_marker), together(only, both, located_now, of_marker)
        yield Transition(f"candidate marker at {end}", waiting, candidate, taken, first, ("MRK-D1",), 7)
        yield Transition(f"marker confirmed at {end}", candidate, target, sure, agreed, ("MRK-1", "MRK-D1"), 7)
    if cycle.satellites is not None:
        yield from _by_satellites(own, cycle, cycle.satellites, mode)
    carried = together(seen, _prolonged(own, cycle), _identities_unless_turned(own, cycle))
    dropped = together(seen, _no_position(own), _no_identities(own))
    yield Transition("candidate lost", candidate, lost, ~cycle.any_prolonged, dropped, ("MRK-D1",), 8)
    yield Transition("carry the candidate", candidate, candidate, TRUE, carried, ("MRK-D1",), 9)


def _by_satellites(own: Parts, cycle: Judgement, position: Reading, mode: tuple[Lit, ...]) -> Iterator[Transition]:
    """Transitions out of the modes that report nothing, by a position of satellites."""
    lost, candidate, front = mode[:3]
    only = together(_seen(own, cycle), _only_by(own, cycle, position))
    found: Updates = {own.reason: LOCATED}
    located_now = together(only, found, _candidate_of_satellites(own, FALSE))
    first = together(only, _no_identities(own), _candidate_of_satellites(own, TRUE))
    confirmed = together(located_now, _identities(own, cycle.remembered()))
    yield Transition(
        "candidate of satellites", (lost, candidate), candidate, position.is_candidate, first, ("MRK-D6", "MRK-D1"), 7
    )
    yield Transition(
        "satellites confirm the candidate", candidate, front, position.accepted, confirmed, ("MRK-D6", "MRK-D1"), 7
    )


# ------------------------------------------------------------------ groups of updates: what the transitions set


def _seen(own: Parts, cycle: Judgement) -> Updates:
    """Set by every transition: the cycle's distances and readings with their verdicts, and the direction of travel."""
    verdicts: Updates = {reader.verdict: one.verdict for reader, one in zip(own.readers, cycle.readings, strict=True)}
    heading: Updates = {own.rolled: cycle.heading.rolled, own.backwards: cycle.heading.backwards}
    given: Updates = {}
    if own.satellites is not None and cycle.satellites is not None:
        given = {own.satellites.verdict: cycle.satellites.verdict}
    return together(*(_measured(moved) for moved in cycle.cycles), verdicts, given, heading)


def _measured(moved: Cycle) -> Updates:
    updates: dict[Var, Expr] = {}
    for unit, admitted in zip(moved.device.units, moved.admitted, strict=True):
        longer = minimum(unit.gap + 1, unit.limits.lone_limit + 1)
        updates[unit.last] = ite(admitted, unit.measured.value, unit.last)
        updates[unit.gap] = ite(admitted, as_num(0, COUNT), longer)
        updates[unit.last_verdict] = unit.verdict()
    return updates


def _set_or_prolonged(own: Parts, cycle: Judgement) -> Updates:
    """Each device is set by its accepted reading; without one its units move by the measured distances."""
    return together(*(_becomes(device, cycle.state_after(device)) for device in own.devices))


def _only_by(own: Parts, cycle: Judgement, reading: Reading) -> Updates:
    """The reading sets its device; any other device has no position."""
    fresh = cycle.state_set_by(reading)
    return together(*(_becomes(one, fresh if one is reading.device else nothing(one)) for one in own.devices))


def _prolonged(own: Parts, cycle: Judgement) -> Updates:
    """The units of each device move by the measured distances; no reading sets one."""
    return together(*(_becomes(device, cycle.moved(device).state) for device in own.devices))


def _no_position(own: Parts) -> Updates:
    """No device has a position."""
    return together(*(_becomes(device, nothing(device)) for device in own.devices))


def _becomes(device: Device, state: DeviceState) -> Updates:
    """The device takes that state; a dead unit holds zeros, and so do run and age without a living unit."""
    updates: dict[Var, Expr] = {}
    for unit, values in zip(device.units, state.values, strict=True):
        updates[unit.alive] = values.alive
        updates[unit.position] = ite(values.alive, values.position, 0)
        updates[unit.above] = ite(values.alive, values.above, 0)
        updates[unit.below] = ite(values.alive, values.below, 0)
    updates[device.run], updates[device.age] = ite(state.alive, state.run, 0), ite(state.alive, state.age, 0)
    updates[device.by_leading] = state.by_leading
    return updates


def _identities(own: Parts, found: Remembered) -> Updates:
    """The identities that wait for the trailing reader, and the marker that the leading reader read last."""
    waiting: Updates = dict(zip(own.pending.places, found.pending, strict=True))
    return together(waiting, {own.last_marker: found.last_marker, own.last_marker_position: found.last_place})


def _identities_unless_turned(own: Parts, cycle: Judgement) -> Updates:
    """Identities stay; none does where the direction of travel turns."""
    return {var: ite(cycle.reversed, 0, var) for var in (*own.pending.places, own.last_marker)}


def _candidate_of_satellites(own: Parts, is_so: Bool) -> Updates:
    """The candidate is, or is not, a position of satellites, where they give any."""
    if own.satellites is None or own.satellites.candidate_of_satellites is None:
        return {}
    return {own.satellites.candidate_of_satellites: is_so}


def _no_identities(own: Parts) -> Updates:
    """No identity is remembered."""
    return dict.fromkeys((*own.pending.places, own.last_marker), as_num(0, COUNT))


# ------------------------------------------------------------------ terms of the table


def _located_modes(own: Parts, mode: tuple[Lit, ...]) -> tuple[Lit, ...]:
    """Return the modes that report a position, one for each device."""
    return mode[-len(own.devices) :]


def _index(own: Parts, device: Device) -> int:
    return next(index for index, one in enumerate(own.devices) if one is device)


def _leads(own: Parts, cycle: Judgement, index: int) -> Bool:
    """Return whether the device at that index leads after the cycle.

    The smaller margin leads; of two equal ones the front device, unless a reading set the rear device alone in this cycle. Asked where a
    reading set a device; without one see `_takes_over`.
    """
    if len(own.devices) == 1:
        return cycle.any_alive
    front, rear = (cycle.says(device) for device in own.devices)
    equal = rear.alive & front.alive & rear.margin.eq(front.margin)
    fresh_rear = cycle.was_set(own.devices[1]) & ~cycle.was_set(own.devices[0])
    rear_leads = rear.better_than(front) | (equal & fresh_rear)
    return rear_leads if index else front.alive & ~rear_leads


def _takes_over(own: Parts, cycle: Judgement, index: int) -> Bool:
    """Return whether the device at that index takes over from the other one: only with a smaller margin; of equal ones that in use stays."""
    return cycle.says(own.devices[index]).better_than(cycle.says(own.devices[1 - index]))


def _definitions(own: Parts, cycle: Judgement) -> dict[str, Expr]:
    """Name the terms of the table."""
    named: dict[str, Expr] = {"devices exclude each other": cycle.clash, "some device is alive": cycle.any_alive}
    named["the candidate is alive"] = cycle.any_prolonged
    named["direction turned"] = cycle.reversed
    for moved in cycle.cycles:
        device = moved.device
        after = cycle.says(device)
        named |= {f"{device.name} sensors failed": moved.failed, f"{device.name} set now": cycle.was_set(device)}
        for unit, ok, values in zip(device.units, moved.admitted, cycle.after(device), strict=True):
            named |= {f"{unit.name} admitted": ok, f"verdict on {unit.name}": unit.verdict()}
            named |= {f"{unit.name} alive after": values.alive, f"{unit.name} position after": values.position}
            named |= {f"{unit.name} margin above after": values.above, f"{unit.name} margin below after": values.below}
        named |= {f"{device.name} alive after": after.alive, f"{device.name} margin after": after.margin}
    for index, device in enumerate(own.devices):
        named[f"{device.name} device has the smaller margin"] = _leads(own, cycle, index)
    for reading in cycle.readings:
        end = ENDS[reading.end]
        named |= {f"{end} reading accepted": reading.accepted, f"{end} reading is a candidate": reading.is_candidate}
        named |= {f"{end} reader leads": reading.leading, f"verdict on the {end} reading": reading.verdict}
    if cycle.satellites is not None:
        named["verdict on the position of satellites"] = cycle.satellites.verdict
    return named


# ------------------------------------------------------------------ what is reported


def lead(own: Parts, current: Num) -> Values:
    """Return the values of the device that the mode names."""
    if len(own.devices) == 1:
        return own.devices[0].values
    front, rear = own.devices
    return choose(_names_rear(own, current), rear.values, front.values)


def _names_rear(own: Parts, current: Num) -> Bool:
    if len(own.devices) == 1:
        return FALSE
    table = current.unit
    assert isinstance(table, Enumeration)
    return current.eq(Lit(table.index("REAR"), table))


def _outputs(own: Parts, current: Num, mode: tuple[Lit, ...]) -> dict[str, Expr]:
    valid = current.one_of(*_located_modes(own, mode))
    values = lead(own, current)
    rear = _names_rear(own, current)
    by_leading = _of_lead(rear, [ite(d.by_leading, M1, M2) for d in own.devices])
    speaks = _of_lead(rear, [ite(_second_speaks(d), SECOND_UNIT, FIRST_UNIT) for d in own.devices])
    givers = own.readers if own.satellites is None else (*own.readers, own.satellites)
    accepted = any_of(one.verdict.eq(ACCEPTED) for one in givers)
    return {
        "valid": valid,
        "position_mm": position_if(valid, values.position),
        "margin_above_mm": margin_if(valid, ceil_to(values.above, MM)),
        "margin_below_mm": margin_if(valid, ceil_to(values.below, MM)),
        "values": ite(valid, by_leading, NO_VALUES),
        "unit": ite(valid, speaks, NO_UNIT),
        "age_ms": ite(valid, _of_lead(rear, [d.age for d in own.devices]), 0),
        "distance_run_mm": ite(valid, _of_lead(rear, [d.run for d in own.devices]), 0),
        "reference_accepted": valid & accepted,
        "reason": own.reason,
    }


def _of_lead(rear: Bool, terms: list[Num]) -> Num:
    return terms[0] if len(terms) == 1 else ite(rear, terms[1], terms[0])


def _second_speaks(device: Device) -> Bool:
    first, second = device.units
    return second.values.better_than(first.values)
