"""Properties of odometry between markers, in the words of the requirements (MRK-1 to MRK-5, MRK-D1 to MRK-D6)."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import (
    FALSE,
    Bool,
    Num,
    all_of,
    any_of,
    as_num,
    before,
    between,
    exact_to,
    ite,
    maximum,
    with_unit,
)
from safeloc.language.machine import Machine
from safeloc.language.spec import Property, always, earlier_bool, earlier_num, within
from safeloc.language.units import MM, NM, NM_PER_MM
from safeloc.models.odometry import M1, M2, NO_VALUES, Odometry
from safeloc.models.odometry.distance_device import Device, Unit
from safeloc.models.odometry.marker_reading import ACCEPTED, CANDIDATE, NOT_BETTER, OUT_OF_WINDOW, Reader
from safeloc.models.odometry.variables import OdometryConfig, Parts
from safeloc.models.vocabulary.measured import ADMITTED
from safeloc.models.vocabulary.reasons import LOCATED
from safeloc.properties.no_interval import no_interval
from safeloc.properties.odometry import reasons, satellites

LAW = (
    "distances obey their unit's error law or cannot have been run; readers stand over the marker that they give, but for one "
    "that lies far away, once in the age limit; the map's accuracy; the vehicle's length; top speed"
)

for_all_inputs = partial(always, requirements=("MRK-D1",), unconditional=True)


def properties(model: Odometry) -> list[Property]:
    """Return all properties of the odometry machine."""
    makers = (_safety, _references, _window, _selection, _rejection, _sensors, _ages, satellites.properties)
    return [*(prop for maker in makers for prop in maker(model)), *reasons.properties(model, LAW)]


def _safety(model: Odometry) -> Iterator[Property]:
    machine, own = model.machine, model.own
    valid, position = machine.flag("valid"), exact_to(machine.output("position_mm"), NM)
    above, below = exact_to(machine.output("margin_above_mm"), NM), exact_to(machine.output("margin_below_mm"), NM)
    yield always(
        "containment",
        valid.implies(between(position - below, own.ghosts.truth, position + above)),
        statement="the reported interval contains the true position of end A",
        requirements=("MRK-1", "MRK-4", "MRK-5", "MRK-D6"),
        assumption=LAW,
    )
    yield for_all_inputs(
        "tolerance",
        valid.implies(
            (machine.output("margin_above_mm") <= own.config.tolerance_mm)
            & (machine.output("margin_below_mm") <= own.config.tolerance_mm)
        ),
        statement="a reported interval is never wider than the tolerable error, on either side",
    )
    silent = no_interval(machine) & machine.output("distance_run_mm").eq(0)
    yield for_all_inputs(
        "no report when invalid",
        (~valid).implies(silent & machine.output("values").eq(NO_VALUES)),
        statement="without a valid position the machine reports none",
        requirements=("MRK-D1", "MRK-D2"),
    )
    yield for_all_inputs(
        "same-step loss",
        all_of(~unit.alive for unit in own.units).implies(~valid),
        statement="in the cycle in which the last usable value is lost, the machine stops reporting a position",
    )
    yield for_all_inputs(
        "reason stated",
        own.reason.eq(LOCATED).iff(valid),
        statement="the machine gives a reason exactly while it reports no position",
    )


def _references(model: Odometry) -> Iterator[Property]:
    machine, own = model.machine, model.own
    valid = machine.flag("valid")
    by_marker = "trusted marker" if own.config.trust_first_marker else "marker confirmed"
    confirmed = [*(f"{by_marker} at {end}" for end in ("front", "rear")), *satellites.returns(own)]
    yield for_all_inputs(
        "no resurrection",
        (valid & ~earlier_bool(valid)).implies(machine.fired(*confirmed) & machine.flag("reference_accepted")),
        statement="a position is reported again only through a marker that passed every check",
        requirements=("MRK-1", "MRK-D1"),
    )
    kept = all_of([valid, earlier_bool(valid), *(verdict.ne(ACCEPTED) for verdict in _verdicts(own))])
    yield for_all_inputs(
        "margin never shrinks",
        kept.implies(_margin(machine) >= earlier_num(_margin(machine))),
        statement="without an accepted reading the reported margin never shrinks",
        requirements=("MRK-D1", "MRK-D3"),
    )
    for end, reader in enumerate(own.readers):
        yield for_all_inputs(
            f"{('front', 'rear')[end]} reading pairs",
            reader.verdict.eq(ACCEPTED).implies(_entitled(model, end, reader)),
            statement="a reading counts only for a known marker: at the leading reader for a new marker ahead, at "
            "the trailing reader for a marker that the leading reader has read and the trailing one has "
            "not",
            requirements=("MRK-1", "MRK-5"),
        )
    yield from _waiting(model)
    yield from _waiting_ends(model)
    yield from _last_marker(model)
    yield from _last_marker_stays(model)


def _waiting(model: Odometry) -> Iterator[Property]:
    """Claim which identities wait for the trailing reader: those that the leading one read, until the trailing one reads them."""
    own, for_pairs = model.own, partial(for_all_inputs, requirements=("MRK-1", "MRK-5"))
    led = [(_leads_before(own, end) & _counts(reader), reader.marker.value) for end, reader in enumerate(own.readers)]
    passed = [
        (~_leads_before(own, end) & _counts(reader), reader.marker.value) for end, reader in enumerate(own.readers)
    ]
    waits = own.pending.places
    yield for_pairs(
        "an identity waits only once the leading reader has read it",
        all_of(
            one.ne(0).implies(
                any_of(one.eq(earlier_num(other)) for other in waits)
                | any_of(counts & one.eq(marker) for counts, marker in led)
            )
            for one in waits
        ),
        statement="an identity begins to wait for the trailing reader only in a cycle in which the leading reader reads it and the "
        "reading passes every check",
    )
    yield for_pairs(
        "an identity that the trailing reader has read waits no longer",
        all_of(
            (counts & all_of(~also | other.ne(marker) for also, other in led)).implies(
                all_of(one.ne(marker) for one in waits)
            )
            for counts, marker in passed
        ),
        statement="after the trailing reading of a marker its identity waits no longer, so that a second such reading does not count",
    )


def _waiting_ends(model: Odometry) -> Iterator[Property]:
    """Claim that an identity waits no longer after turning and after a loss."""
    own, for_pairs = model.own, partial(for_all_inputs, requirements=("MRK-1", "MRK-5"))
    turned = own.backwards.iff(~earlier_bool(own.backwards))
    waits = own.pending.places
    mode, lost, none_waits = model.machine.mode, model.machine.modes[0], all_of(one.eq(0) for one in waits)
    yield for_pairs(
        "no identity waits after turning",
        (turned & before(mode).ne(lost)).implies(none_waits),
        statement="when the direction of travel turns, and with it which reader leads, no identity waits",
    )
    yield for_pairs(
        "no identity waits after a loss",
        mode.eq(lost).implies(none_waits),
        statement="with neither position nor candidate no identity waits",
    )


def _last_marker(model: Odometry) -> Iterator[Property]:
    """Claim which marker counts as the last one: by it a repeated marker, or one that lies behind, is refused."""
    own, for_pairs = model.own, partial(for_all_inputs, requirements=("MRK-1", "MRK-5"))
    mode, lost, back, (front, rear) = (
        model.machine.mode,
        model.machine.modes[0],
        earlier_bool(own.backwards),
        own.readers,
    )
    read = own.last_marker.eq(ite(back, rear.marker.value, front.marker.value))
    there = own.last_marker_position.eq(ite(back, rear.place.value, front.place.value))
    yield for_pairs(
        "the marker that the leading reader read last is stored",
        (_leading_counts(own) & mode.ne(lost) & own.backwards.iff(back)).implies(read & there),
        statement="after a leading reading that passes every check its marker is the last one, with its place on the map",
    )


def _last_marker_stays(model: Odometry) -> Iterator[Property]:
    """Claim that the last marker stays without a leading reading."""
    own, for_pairs = model.own, partial(for_all_inputs, requirements=("MRK-1", "MRK-5"))
    mode, lost = model.machine.mode, model.machine.modes[0]
    same_place = own.last_marker_position.eq(earlier_num(own.last_marker_position))
    stays = own.last_marker.eq(earlier_num(own.last_marker)) | own.last_marker.eq(0)
    yield for_pairs(
        "without a leading reading the last marker stays",
        (~_leading_counts(own) & mode.ne(lost) & before(mode).ne(lost)).implies(stays & same_place),
        statement="without such a reading the last marker stays, or is forgotten",
    )


def _leads_before(own: Parts, end: int) -> Bool:
    """The reader at that end leads, by the direction of travel before the cycle."""
    back = earlier_bool(own.backwards)
    return back if end == 1 else ~back


def _leading_counts(own: Parts) -> Bool:
    """The reading of the reader that led before the cycle passed every check."""
    front, rear = own.readers
    return ite(earlier_bool(own.backwards), _counts(rear), _counts(front))


def _counts(reader: Reader) -> Bool:
    """The reading passed every check, whether or not it sets its device."""
    return reader.verdict.one_of(ACCEPTED, CANDIDATE, NOT_BETTER)


def _verdicts(own: Parts, of: Device | None = None) -> list[Num]:
    """The verdicts on all readings of the cycle, or on those that can set one device."""
    found: list[Num] = [reader.verdict for end, reader in enumerate(own.readers) if of is None or own.set_by(end) is of]
    if own.satellites is not None and of in (None, own.devices[0]):
        found.append(own.satellites.verdict)
    return found


def _margin(machine: Machine) -> Num:
    """The greater side of what is reported, mm."""
    return maximum(machine.output("margin_below_mm"), machine.output("margin_above_mm"))


def _entitled(model: Odometry, end: int, reader: Reader) -> Bool:
    """A leading marker is new and lies ahead of the last one; a trailing one was read by the leading reader."""
    own, marker, place = model.own, reader.marker.value, reader.place.value
    back = earlier_bool(own.backwards)
    last, last_place = earlier_num(own.last_marker), earlier_num(own.last_marker_position)
    ahead = ite(back, last_place > place, last_place < place)
    new = last.eq(0) | (last.ne(marker) & ahead)
    unknown = all_of(earlier_num(waiting).ne(marker) for waiting in own.pending.places)
    leading = _leads_before(own, end)
    return all_of([reader.marker.present, reader.place.present, leading.implies(new), leading | ~unknown])


def _window(model: Odometry) -> Iterator[Property]:
    """The window refuses no reading that is true; that it refuses what is far off is part of containment.

    Where the first marker is trusted, no reading is stray, so that none is refused; the same claim then speaks of every reading.
    """
    ghosts, trusting = model.own.ghosts, model.own.config.trust_first_marker
    no_slip = all_of(one.next_wander.eq(earlier_num(one.wander)) for one in ghosts.units)
    for end, reader in enumerate(model.own.readers):
        stray, outside = ghosts.readers[end].stray, reader.verdict.eq(OUT_OF_WINDOW)
        yield always(
            f"{('front', 'rear')[end]} reader over its marker is inside the window",
            (no_slip & ~stray).implies(~outside) if trusting else (no_slip & outside).implies(stray),
            statement="no reading of a marker that the reader stood over is refused as out of its window, in a cycle in "
            "which no unit slips (the one-off part of no unit's error changes)",
            requirements=("MRK-1", "MRK-5"),
            assumption=LAW,
        )


def _selection(model: Odometry) -> Iterator[Property]:
    machine, own = model.machine, model.own
    valid = machine.flag("valid")
    yield for_all_inputs(
        "the smallest margin leads",
        valid.implies(all_of(_no_worse(machine, unit) for unit in own.units)),
        statement="the reported margin is the smallest of all usable ones: the machine never changes to a value with a greater margin",
        requirements=("MRK-D3", "MRK-D4"),
    )
    of_front = own.devices[0].units
    candidate = FALSE if own.config.trust_first_marker else machine.mode.eq(machine.modes[1])
    better = [unit.alive.implies(valid & _no_worse(machine, unit)) for unit in of_front]
    yield for_all_inputs(
        "never worse than the front device alone",
        candidate | all_of(better),
        statement="whenever the front device alone would have a position, one is reported, with a margin that is not "
        "greater than the front device's (which no reading of the other device touches)",
        requirements=("MRK-1", "MRK-D3", "MRK-D5"),
    )
    yield from _takes_over(model)
    leading = [f"leading reading at {end}" for end in ("front", "rear")]
    trailing = [f"trailing reading at {end}" for end in ("front", "rear")]
    yield for_all_inputs(
        "M1 after the leading reading",
        machine.fired(*leading).implies(machine.output("values").eq(M1)),
        statement="after a leading reading that sets its device the values M1 are used",
        requirements=("MRK-1", "MRK-5"),
    )
    yield for_all_inputs(
        "M2 after the trailing reading",
        machine.fired(*trailing).implies(machine.output("values").eq(M2)),
        statement="after the trailing reading of the same marker the values M2 are used",
        requirements=("MRK-1", "MRK-5"),
    )


def _takes_over(model: Odometry) -> Iterator[Property]:
    """Claim when the other device's values are used without a reading; none of a machine with one device."""
    machine, own = model.machine, model.own
    unset = all_of(verdict.ne(ACCEPTED) for verdict in _verdicts(own))
    for front, rear in zip(own.devices, own.devices[1:], strict=False):
        *_, front_leads, rear_leads = machine.modes
        to_rear = unset & before(machine.mode).eq(front_leads) & machine.mode.eq(rear_leads)
        to_front = unset & before(machine.mode).eq(rear_leads) & machine.mode.eq(front_leads)
        yield for_all_inputs(
            "the rear device takes over only with a smaller margin",
            to_rear.implies(any_of(_narrower(one, front) for one in rear.units)),
            statement="without a reading the rear device takes over only if its margin is smaller than the front device's, or if "
            "the front device has no position",
            requirements=("MRK-1", "MRK-D3"),
        )
        yield for_all_inputs(
            "the front device takes over only with a smaller margin",
            to_front.implies(any_of(_narrower(one, rear) for one in front.units)),
            statement="without a reading the front device takes over only if its margin is smaller than the rear device's, or if "
            "the rear device has no position",
            requirements=("MRK-1", "MRK-D3"),
        )


def _narrower(unit: Unit, other: Device) -> Bool:
    """The unit has a position, with a smaller margin than each unit of the other device that has one."""
    margin = maximum(unit.above, unit.below)
    return unit.alive & all_of(one.alive.implies(margin < maximum(one.above, one.below)) for one in other.units)


def _no_worse(machine: Machine, unit: Unit) -> Bool:
    """The reported margins, rounded up to whole mm, are no greater than the unit's, while that unit has a position."""
    reported = exact_to(_margin(machine), NM) - (NM_PER_MM - 1)
    return unit.alive.implies((reported <= unit.above) | (reported <= unit.below))


def _rejection(model: Odometry) -> Iterator[Property]:
    own = model.own
    valid = model.machine.flag("valid")
    for device in own.devices:
        rejected = all_of(verdict.ne(ACCEPTED) for verdict in _verdicts(own, device))
        for unit, other in (device.units, device.units[::-1]):
            kept = rejected & valid & earlier_bool(valid) & unit.alive
            yield for_all_inputs(
                f"{unit.name} ignores rejected readings",
                kept.implies(_ran_on(unit, other)),
                statement="a foreign, repeated, unpaired or implausible marker, or one of the other device, narrows no margin: "
                "the position moves by the measured distance alone, and both margins grow alike",
                requirements=("MRK-1", "MRK-D1", "MRK-4"),
            )
            silent = unit.last_verdict.ne(ADMITTED) & other.last_verdict.ne(ADMITTED)
            farthest = own.config.max_speed_mm_s * own.config.period_ms * 1_000
            yield for_all_inputs(
                f"silence of {unit.name} widens the margins",
                (kept & silent).implies(unit.above - earlier_num(unit.above) >= farthest),
                statement="in a cycle without an admitted distance of the device the margins grow by the run at the highest speed",
                requirements=("MRK-D1", "MRK-4"),
            )


def _ran_on(unit: Unit, other: Unit) -> Bool:
    delivered, other_delivered = unit.last_verdict.eq(ADMITTED), other.last_verdict.eq(ADMITTED)
    if unit.limits.single_fault_safe:  # a lone distance moves nothing
        delivered = other_delivered = delivered & other_delivered
    moved = ite(delivered, unit.measured.value, ite(other_delivered, other.measured.value, as_num(0, MM)))
    growth = unit.above - earlier_num(unit.above)
    return all_of(
        [
            earlier_bool(unit.alive),
            unit.position.eq(earlier_num(unit.position) + moved),
            growth >= 0,
            growth.eq(unit.below - earlier_num(unit.below)),
        ]
    )


def _sensors(model: Odometry) -> Iterator[Property]:
    own, machine = model.own, model.machine
    delivered = any_of(unit.measured.present for unit in own.units)
    yield within(
        "silence delocalizes",
        own.config.gap_limit_cycles,
        ~delivered,
        delivered | ~machine.flag("valid"),
        statement="when no unit delivers a distance, the machine reports no position after the permitted gap at the latest",
        requirements=("MRK-D1",),
        unconditional=True,
        helper=lambda waited: all_of(waited <= unit.gap for unit in own.units),
    )
    for device in own.devices:
        for unit in device.units:
            yield _unchecked(model, device, unit)
    for unit in own.units:
        yield for_all_inputs(
            f"{unit.name} gate",
            unit.last_verdict.eq(ADMITTED).iff(unit.measured.present & _within_gate(own.config, unit)),
            statement="a distance is admitted exactly if it is below the top speed, and within the greatest change of speed since the last one",
            requirements=("MRK-4", "MRK-D1"),
        )


def _unchecked(model: Odometry, device: Device, unit: Unit) -> Property:
    """While one unit is silent, nothing checks the other one: not for longer than the lone limit."""
    own = model.own
    read = any_of(verdict.one_of(ACCEPTED, CANDIDATE) for verdict in _verdicts(own, device))
    delivered, dead = unit.last_verdict.eq(ADMITTED), all_of(~one.alive for one in device.units)
    return within(
        f"{device.name} device loses its position without {unit.name}",
        own.config.lone_limit_cycles,
        ~delivered,
        delivered | dead | read,
        statement="when one unit of a device delivers no distance that is admitted, the device has no position after the "
        "permitted time with the other unit alone, unless a reading sets it in that cycle",
        requirements=("MRK-D1", "MRK-D4"),
        unconditional=True,
        helper=lambda waited: waited <= unit.gap,
    )


def _within_gate(config: OdometryConfig, unit: Unit) -> Bool:
    """In figures of the requirement: top speed and greatest acceleration, rounded up to mm, and steps of the measurement."""
    farthest = config.measuring_step_mm + math.ceil(config.max_speed_mm_s * config.period_ms / 1_000)
    change = 2 * config.measuring_step_mm + math.ceil(config.max_acceleration_mm_s2 * config.period_ms**2 / 1_000_000)
    step, last, silent = unit.measured.value, earlier_num(unit.last), earlier_num(unit.gap)
    while_silent = with_unit(silent * change, MM)
    near = (step - last <= while_silent + change) & (last - step <= while_silent + change)
    return (step <= farthest) & (step >= -farthest) & ((silent > config.gap_limit_cycles) | near)


def _ages(model: Odometry) -> Iterator[Property]:
    machine, config = model.machine, model.own.config
    yield for_all_inputs(
        "age limit",
        machine.output("age_ms") <= config.age_limit_ms,
        statement="no position is reported whose reference is older than the age limit",
    )
    for device in model.own.devices:
        running = [one for unit in device.units for one in (unit.alive, earlier_bool(unit.alive))]
        older = device.age - earlier_num(device.age)
        fresh = device.age.eq(config.period_ms)
        yield for_all_inputs(
            f"{device.name} device grows older",
            all_of(running).implies(older.eq(config.period_ms) | fresh),
            statement="in every cycle without a reference the device's age grows by the cycle",
        )
        rejected = all_of(verdict.ne(ACCEPTED) & verdict.ne(CANDIDATE) for verdict in _verdicts(model.own))
        yield for_all_inputs(
            f"{device.name} device is set by a reading alone",
            (all_of(running) & rejected).implies(older.eq(config.period_ms)),
            statement="only a reading that was accepted, or is a candidate, makes the device's reference young again",
            requirements=("MRK-1", "MRK-D1"),
        )
