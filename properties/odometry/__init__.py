"""What must hold of odometry between markers, in the words of the requirements (MRK-1 to MRK-5, MRK-D1 to MRK-D6)."""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.language.expr import Bool, all_of, any_of, as_num, between, exact_to, ite, with_unit
from safeloc.language.spec import Property, always, earlier_bool, earlier_num, within
from safeloc.language.units import MM, NM
from safeloc.models.odometry import M1, M2, NO_VALUES, Odometry
from safeloc.models.odometry.distance_device import Unit
from safeloc.models.odometry.marker_reading import ACCEPTED, Reader
from safeloc.models.vocabulary.measured import ADMITTED
from safeloc.models.vocabulary.reasons import LOCATED

LAW = "admitted distances obey their unit's error law; accepted readings are true within accuracy; top speed"


def properties(model: Odometry) -> list[Property]:
    """Every property of the odometry machine."""
    makers = (_safety, _references, _selection, _rejection, _sensors)
    return [prop for maker in makers for prop in maker(model)]


def _safety(model: Odometry) -> Iterator[Property]:
    machine, own = model.machine, model.own
    valid, position = machine.flag("valid"), exact_to(machine.output("position_mm"), NM)
    over, under = exact_to(machine.output("over_mm"), NM), exact_to(machine.output("under_mm"), NM)
    yield always(
        "containment",
        valid.implies(between(position - under, own.truth, position + over)),
        statement="the reported interval holds the true position of end A",
        requirements=("MRK-1", "MRK-4", "MRK-5", "MRK-D6"),
        assumption=LAW,
    )
    yield always(
        "tolerance",
        (machine.output("over_mm") <= own.config.tolerance_mm)
        & (machine.output("under_mm") <= own.config.tolerance_mm),
        statement="a reported interval is never wider than the tolerable error, on either side",
        requirements=("MRK-D1",),
        unconditional=True,
    )
    silent = all_of(machine.output(f"{name}_mm").eq(0) for name in ("position", "over", "under", "distance_run"))
    yield always(
        "no report when invalid",
        (~valid).implies(silent & machine.output("values").eq(NO_VALUES)),
        statement="nothing is reported without a valid position",
        requirements=("MRK-D1", "MRK-D2"),
        unconditional=True,
    )
    alive = any_of(unit.alive for unit in own.units)
    yield always(
        "same-step loss",
        (~alive).implies(~valid),
        statement="the cycle in which the last usable value is lost is the cycle in which nothing is reported any more",
        requirements=("MRK-D1",),
        unconditional=True,
    )
    yield always(
        "reason stated",
        own.reason.eq(LOCATED).iff(valid),
        statement="a reason is stated exactly while nothing is reported",
        requirements=("MRK-D1",),
        unconditional=True,
    )


def _references(model: Odometry) -> Iterator[Property]:
    machine, own = model.machine, model.own
    valid = machine.flag("valid")
    confirmed = [f"marker confirmed at {end}" for end in ("front", "rear")]
    if own.config.trust_first_marker:
        confirmed += [f"trusted marker at {end}" for end in ("front", "rear")]
    yield always(
        "no resurrection",
        (valid & ~earlier_bool(valid)).implies(machine.fired(*confirmed) & machine.flag("reference_accepted")),
        statement="a position is reported again only through a marker that passed every check",
        requirements=("MRK-1", "MRK-D1"),
        unconditional=True,
    )
    accepted = any_of(reader.verdict.eq(ACCEPTED) for reader in own.readers)
    yield always(
        "margin never shrinks",
        (valid & earlier_bool(valid) & ~accepted).implies(model.lead.margin >= earlier_num(model.lead.margin)),
        statement="without an accepted reading the reported margin never shrinks",
        requirements=("MRK-D1", "MRK-D3"),
        unconditional=True,
    )
    for end, reader in enumerate(own.readers):
        yield always(
            f"{('front', 'rear')[end]} reading pairs",
            reader.verdict.eq(ACCEPTED).implies(_entitled(model, end, reader)),
            statement="a reading counts only for a known marker: a leading one for a new marker ahead, a trailing one for "
            "a marker that the leading reader has read and the trailing one has not",
            requirements=("MRK-1", "MRK-5"),
            unconditional=True,
        )


def _entitled(model: Odometry, end: int, reader: Reader) -> Bool:
    own, marker, place = model.own, reader.marker.value, reader.place.value
    leads = earlier_bool(own.leads(end))
    last, last_place = earlier_num(own.last_marker), earlier_num(own.last_place)
    ahead = ite(earlier_bool(own.backwards), place < last_place, place > last_place)
    new = marker.ne(last) & (last.eq(0) | ahead)
    waited = any_of(earlier_num(waiting).eq(marker) for waiting in own.pending.places)
    return reader.marker.present & reader.place.present & ite(leads, new, waited)


def _selection(model: Odometry) -> Iterator[Property]:
    machine, own = model.machine, model.own
    valid, lead = machine.flag("valid"), model.lead
    units = [unit.values for unit in own.units]
    yield always(
        "the smallest margin leads",
        valid.implies(all_of(value.alive.implies(lead.margin <= value.margin) for value in units)),
        statement="the reported margin is the smallest of all usable ones: no switch is ever to a worse one",
        requirements=("MRK-D3", "MRK-D4"),
        unconditional=True,
    )
    front = any_of(unit.alive for unit in own.devices[0].units)
    candidate = machine.mode.eq(machine.modes[1])
    best = [unit.alive.implies(lead.margin <= unit.values.margin) for unit in own.devices[0].units]
    yield always(
        "never worse than the front device alone",
        (front & ~candidate).implies(valid & all_of(best)),
        statement="whenever the front device alone would have a position, one is reported, with a margin that is not "
        "greater than the front device's (which no reading of the other device touches)",
        requirements=("MRK-1", "MRK-D3", "MRK-D5"),
        unconditional=True,
    )
    leading = [f"leading reading at {end}" for end in ("front", "rear")]
    trailing = [f"trailing reading at {end}" for end in ("front", "rear")]
    yield always(
        "M1 after the leading reading",
        machine.fired(*leading).implies(machine.output("values").eq(M1)),
        statement="a leading reading that sets its device makes values M1 count",
        requirements=("MRK-1", "MRK-5"),
        unconditional=True,
    )
    yield always(
        "M2 after the trailing reading",
        machine.fired(*trailing).implies(machine.output("values").eq(M2)),
        statement="the trailing reading of the same marker makes values M2 count",
        requirements=("MRK-1", "MRK-5"),
        unconditional=True,
    )


def _rejection(model: Odometry) -> Iterator[Property]:
    own = model.own
    valid = model.machine.flag("valid")
    for device in own.devices:
        setting = [reader for end, reader in enumerate(own.readers) if own.set_by(end) is device]
        rejected = ~any_of(reader.verdict.eq(ACCEPTED) for reader in setting)
        for unit, other in (device.units, device.units[::-1]):
            kept = rejected & valid & earlier_bool(valid) & unit.alive
            yield always(
                f"{unit.name} ignores rejected readings",
                kept.implies(_ran_on(unit, other)),
                statement="a foreign, repeated, unpaired or implausible marker, or one of the other device, narrows no margin: "
                "the position moves by the measured distance alone, and both margins grow alike",
                requirements=("MRK-1", "MRK-D1", "MRK-4"),
                unconditional=True,
            )


def _ran_on(unit: Unit, other: Unit) -> Bool:
    heard, other_heard = unit.judged.eq(ADMITTED), other.judged.eq(ADMITTED)
    if unit.limits.single_fault_safe:  # a lone distance moves nothing
        heard = other_heard = heard & other_heard
    moved = ite(heard, unit.step.value, ite(other_heard, other.step.value, as_num(0, MM)))
    growth = unit.over - earlier_num(unit.over)
    return all_of(
        [
            earlier_bool(unit.alive),
            unit.position.eq(earlier_num(unit.position) + moved),
            growth >= 0,
            growth.eq(unit.under - earlier_num(unit.under)),
        ]
    )


def _sensors(model: Odometry) -> Iterator[Property]:
    own, machine = model.own, model.machine
    heard = any_of(unit.step.present for unit in own.units)
    yield within(
        "silence delocalizes",
        own.config.gap_limit_cycles,
        ~heard,
        heard | ~machine.flag("valid"),
        statement="when no unit delivers a distance, nothing is reported after the permitted gap at the latest",
        requirements=("MRK-D1",),
        unconditional=True,
        helper=lambda waited: all_of(waited <= unit.gap for unit in own.units),
    )
    for unit in own.units:
        yield always(
            f"{unit.name} gate",
            unit.judged.eq(ADMITTED).implies(unit.step.present & _within_gate(unit)),
            statement="a distance is admitted only below the top speed, and within the greatest change of speed since the "
            "last one",
            requirements=("MRK-4", "MRK-D1"),
            unconditional=True,
        )


def _within_gate(unit: Unit) -> Bool:
    limits, gap = unit.limits, earlier_num(unit.gap)
    change = unit.step.value - earlier_num(unit.last)
    allowed = with_unit((gap + 1) * limits.max_step_change_mm, MM)
    near = between(-allowed, change, allowed)
    return between(-limits.max_step_mm, unit.step.value, limits.max_step_mm) & ((gap > limits.gap_limit) | near)
