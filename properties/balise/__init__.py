"""Properties of the balise machine, in the words of the requirements (RFL-5, RFL-9, RFL-D4)."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import (
    Bool,
    Optional,
    all_of,
    any_of,
    as_num,
    between,
    exact_to,
    ite,
    maximum,
    with_unit,
)
from safeloc.language.spec import Property, always, earlier_bool, earlier_num, within
from safeloc.language.units import MM, NM
from safeloc.models.balise import Balise
from safeloc.models.balise import variables as v
from safeloc.models.balise.linking import Record
from safeloc.models.balise.telegram import FAILED, UNLINKED
from safeloc.models.vocabulary.measured import ADMITTED
from safeloc.models.vocabulary.reasons import LOCATED
from safeloc.properties.balise.layout import layout_properties
from safeloc.properties.balise.linking import linking_properties
from safeloc.properties.balise.refusals import refusal_properties
from safeloc.properties.balise.step import LAW, Step
from safeloc.properties.no_interval import no_interval

for_all_inputs = partial(always, requirements=("RFL-D4",), unconditional=True)


def properties(model: Balise) -> list[Property]:
    """Return every property of the balise machine."""
    makers = (
        _safety,
        _invalid,
        _references,
        _added_error,
        _facing,
        _resets,
        _reflector_ahead,
        _rejection,
        linking_properties,
        refusal_properties,
        layout_properties,
        _sensors,
    )
    return [prop for maker in makers for prop in maker(model)]


def _safety(model: Balise) -> Iterator[Property]:
    """Properties of the reported interval: it contains the true position, and is not wider than tolerable."""
    machine, own = model.machine, model.own
    valid, tolerance = machine.flag("valid"), own.config.tolerance_mm
    position, above, below = (
        exact_to(machine.output(f"{name}_mm"), NM) for name in ("position", "margin_above", "margin_below")
    )
    yield always(
        "containment",
        valid.implies(between(position - below, own.world.truth, position + above)),
        statement="the reported interval contains the true position of the front end",
        requirements=("RFL-5", "RFL-D4"),
        assumption=LAW,
    )
    yield for_all_inputs(
        "tolerance",
        valid.implies(
            (machine.output("margin_above_mm") <= tolerance) & (machine.output("margin_below_mm") <= tolerance)
        ),
        statement="a reported interval is never wider than the tolerable error, on either side",
    )


def _invalid(model: Balise) -> Iterator[Property]:
    """Properties of an invalid position: when it is invalid, and that nothing is reported then."""
    machine, own = model.machine, model.own
    valid = machine.flag("valid")
    nothing = [
        no_interval(machine),
        *(machine.output(name).eq(0) for name in ("reflector_mm", "search_mm")),
        ~machine.flag("reflector_known"),
        ~machine.flag("wants_linking"),
        machine.output("expected").eq(0),
    ]
    yield for_all_inputs(
        "no report when invalid",
        (~valid).implies(all_of(nothing)),
        statement="without a valid position the machine reports none and expects no group",
        requirements=("RFL-D4", "RFL-9"),
    )
    yield for_all_inputs(
        "reason stated",
        own.memory.reason.eq(LOCATED).iff(valid),
        statement="the machine gives a reason exactly while it reports no position",
    )
    yield for_all_inputs(
        "contradiction delocalizes",
        own.memory.verdict.eq(v.CONTRADICTED).implies(~valid),
        statement="when a group and the interval cannot both be true, the machine stops reporting a position in the same step",
    )


# ------------------------------------------------------------------ references


def _references(model: Balise) -> Iterator[Property]:
    machine, own, step = model.machine, model.own, Step(model)
    valid, config = machine.flag("valid"), own.config
    confirmed = "first group is trusted" if config.trust_first_group else "group confirms the candidate"
    yield for_all_inputs(
        "no resurrection",
        (valid & ~earlier_bool(valid)).implies(machine.fired(confirmed) & machine.flag("reference_accepted")),
        statement="a position is reported again only through a group that passed every check",
        requirements=("RFL-5", "RFL-D4"),
    )
    accepted = own.memory.verdict.eq(v.ACCEPTED)
    yield for_all_inputs(
        "only complete and undamaged groups count",
        own.memory.verdict.one_of(v.ACCEPTED, v.CANDIDATE).implies(step.complete),
        statement="the machine uses a group only if every balise of it was read, with right check bits, no longer "
        "ago than permitted, while running forwards",
    )
    if not config.free_references:
        yield for_all_inputs(
            "only announced groups reset",
            (accepted & earlier_bool(valid)).implies(any_of(_entitled(step, slot) for slot in own.linking.slots)),
            statement="a located vehicle takes a position only from a group that was announced, in the announced "
            "orientation, and inside its window: the max safe front end has reached the first place where it can be "
            "read, and the min safe front end had not passed the last one",
        )
    expected, placed = own.linking.slots[0], own.read.place.present
    right = [step.expecting, step.read_of(expected), ~step.against(expected), step.inside(expected), ~placed]
    yield for_all_inputs(
        "the expected group counts",
        all_of([earlier_bool(valid), step.well_formed, step.complete, *right]).implies(
            own.memory.verdict.one_of(v.ACCEPTED, v.CONTRADICTED)
        ),
        statement="the machine accepts the expected group if it was read completely, in the announced orientation "
        "and inside its window, unless it and the interval exclude each other",
    )


def _added_error(model: Balise) -> Iterator[Property]:
    machine, own, step = model.machine, model.own, Step(model)
    accepted, valid = own.memory.verdict.eq(v.ACCEPTED), machine.flag("valid")
    yield for_all_inputs(
        "accuracy by precedence",
        (accepted & valid).implies(own.memory.accuracy.eq(step.accuracy_by_precedence)),
        statement="the location accuracy of an accepted group is that of linking, else the national one, else the default",
    )
    national = own.national
    as_received = national.known & national.stored.eq(national.national_accuracy.value)
    as_before = national.stored.eq(earlier_num(national.stored)) & (national.known | ~earlier_bool(national.known))
    yield for_all_inputs(
        "a national value stays",
        ite(national.national_accuracy.present, as_received, as_before),
        statement="a national location accuracy is in force from its reception on, until another one is received",
    )


def _facing(model: Balise) -> Iterator[Property]:
    """Properties of the direction of travel by balises."""
    machine, own, step = model.machine, model.own, Step(model)
    along, was_along = own.memory.direction.eq(v.ALONG), earlier_num(own.memory.direction).eq(v.ALONG)
    yield for_all_inputs(
        "direction by orientation",
        (along & ~was_along).implies(step.counts & (own.read.total.value.ne(1) | earlier_num(own.memory.group).ne(0))),
        statement="the machine reports the direction of travel only after a group of two or more balises, or after a second group",
    )
    remembers = own.memory.group.ne(0)
    now = step.counts & (step.oriented | step.surely_ahead)
    yield for_all_inputs(
        "only balise groups set the reported direction",
        along.iff(remembers & (was_along | now)),
        statement="the machine reports the direction from a group on that was passed in the announced orientation, "
        "or that surely lies beyond the group before, as long as it stores a group; nothing else sets it",
    )
    yield for_all_inputs(
        "the stored direction is reported",
        machine.output("direction").eq(own.memory.direction),
        statement="the machine reports the direction that it has stored",
    )


def _entitled(step: Step, slot: Record) -> Bool:
    """The group that was in a slot was read in the announced orientation and inside its window."""
    held = earlier_num(slot.group).ne(0)
    return all_of([held, step.read_of(slot), ~step.against(slot), step.inside(slot)])


# ------------------------------------------------------------------ what a telegram does to the interval


def _resets(model: Balise) -> Iterator[Property]:
    own, step = model.own, Step(model)
    accepted, valid = own.memory.verdict.eq(v.ACCEPTED), model.machine.flag("valid")
    interval, moved, kept = own.held.interval, step.moved, step.kept
    yield for_all_inputs(
        "a reset never widens",
        kept.implies((interval.low >= moved.low) & (interval.high <= moved.high) & (interval.margin <= moved.margin)),
        statement="no telegram moves an end of the interval outward or makes the margin greater than odometry alone had it",
    )
    yield always(
        "a reset interval contains the true position",
        (accepted & valid).implies(between(interval.low, own.world.truth, interval.high)),
        statement="the part that telegram and interval have in common contains the true position",
        requirements=("RFL-5", "RFL-D4"),
        assumption=LAW,
    )
    advance = interval.low - step.old.low
    estimated = exact_to(maximum(step.distance, 0), NM)
    yield for_all_inputs(
        "min safe front end",
        (kept & ~accepted).implies(advance <= estimated),
        statement="without an accepted group the min safe front end advances by no more than the distance estimated (OCORA 7244)",
    )
    yield for_all_inputs(
        "margins never shrink",
        (kept & ~accepted).implies((interval.above >= step.old.above) & (interval.below >= step.old.below)),
        statement="without an accepted group neither margin shrinks",
    )


def _reflector_ahead(model: Balise) -> Iterator[Property]:
    """Properties of the next reflector that a telegram gives, and of the place from where to search for it."""
    own, step = model.own, Step(model)
    as_received = own.reflector.known & ~earlier_bool(own.reflector.known)
    new = own.reflector.place.ne(earlier_num(own.reflector.place)) & own.reflector.known
    reach = own.read.reflector.value
    yield for_all_inputs(
        "only an accepted telegram gives a reflector",
        (as_received | new).implies(step.counts & own.reflector.place.eq(own.memory.last_group_position + reach)),
        statement="the machine takes the distance to the next reflector only from an accepted telegram, and measures it from that group's place",
        requirements=("RFL-9",),
    )
    for name, distance in (("reflector", own.read.reflector), ("search", own.read.search)):
        yield _distance_of(model, name, distance)
    memory = own.memory
    read = memory.group.eq(own.read.group.value) & memory.last_group_position.eq(step.place_as_announced)
    before_it = memory.group.eq(earlier_num(memory.group)) & memory.last_group_position.eq(
        earlier_num(memory.last_group_position)
    )
    yield for_all_inputs(
        "a group is kept where linking or its telegram has it",
        memory.group.ne(0).implies(ite(step.counts, read, before_it)),
        statement="the group that the position refers to is the last one that was accepted, or the candidate, and its place is that of "
        "linking, else that of its telegram",
        requirements=("RFL-9", "RFL-D4"),
    )


def _distance_of(model: Balise, name: str, distance: Optional) -> Property:
    machine, own, step = model.machine, model.own, Step(model)
    known, place = machine.flag(f"{name}_known"), machine.output(f"{name}_mm")
    valid, zero = machine.flag("valid"), as_num(0, MM)
    afresh = [
        known.iff(distance.present),
        place.eq(ite(distance.present, step.place_as_announced + distance.value, zero)),
    ]
    was = earlier_num(place)
    still = earlier_bool(known) & (exact_to(was, NM) >= own.held.interval.low)
    kept = [known.iff(still), place.eq(ite(still, was, zero))]
    counted = own.memory.verdict.eq(v.ACCEPTED)
    return for_all_inputs(
        f"the telegram's {name} distance is reported",
        valid.implies(ite(counted, all_of(afresh), (~earlier_bool(valid)) | all_of(kept))),
        statement=f"from an accepted telegram with a {name} distance on, the place so far beyond its group is told, until the "
        "min safe front end is beyond it or another group counts; without that distance nothing is told",
        requirements=("RFL-9",),
    )


def _rejection(model: Balise) -> Iterator[Property]:
    own, step = model.own, Step(model)
    interval, moved, kept = own.held.interval, step.moved, step.kept
    pairs = zip(
        (interval.position, interval.above, interval.below), (moved.position, moved.above, moved.below), strict=True
    )
    as_odometry = all_of(now.eq(alone) for now, alone in pairs)
    yield for_all_inputs(
        "rejected telegrams change nothing",
        (kept & own.memory.verdict.ne(v.ACCEPTED)).implies(as_odometry),
        statement="after a telegram that is not accepted, position and margins are those that odometry alone gives",
    )
    yield _of_unlinked(step, as_odometry)
    for name, fault in _faults(step).items():
        yield for_all_inputs(
            f"{name} changes nothing",
            (kept & fault).implies(as_odometry),
            statement=f"a telegram that is {name} leaves the interval as odometry alone gives it",
        )


def _of_unlinked(step: Step, as_odometry: Bool) -> Property:
    """Claim that an unlinked group leaves the position and its reference alone; with free references, one that is refused."""
    own, memory = step.model.own, step.model.own.memory
    announced = any_of(earlier_num(slot.group).ne(0) & step.read_of(slot) for slot in own.linking.slots)
    unlinked = own.read.link.present & own.read.link.value.eq(UNLINKED) & ~announced
    reference = (memory.group, memory.last_group_position, memory.accuracy, memory.direction, memory.refused_in_row)
    same = all_of(one.eq(earlier_num(one)) for one in reference)
    refused = memory.verdict.ne(v.ACCEPTED) if own.config.free_references else unlinked
    return for_all_inputs(
        "an unlinked group leaves the position alone",
        (step.kept & unlinked & refused).implies(as_odometry & same),
        statement="a group marked as unlinked that is not announced neither narrows nor widens the interval of a located vehicle, and "
        "never takes the place of the group that the position refers to; with free references this holds of those refused",
    )


def _faults(step: Step) -> dict[str, Bool]:
    """Return the kinds of telegrams that are never accepted, in terms of the reading."""
    own, expected = step.model.own, step.model.own.linking.slots[0]
    read = own.read
    known = any_of(step.read_of(slot) for slot in own.linking.slots)
    faults = {
        "corrupted": read.check.present & read.check.value.eq(FAILED),
        "incomplete": read.read.present & read.total.present & (read.read.value < read.total.value),
        "stale": read.age.present & (read.age.value > own.config.telegram_age_limit_ms),
        "without an identity": ~read.group.present,
    }
    if own.config.free_references:
        return faults
    passed = {
        "of the expected group but outside its window": step.read_of(expected) & ~step.inside(expected),
        "of the expected group but passed the wrong way": step.read_of(expected) & step.against(expected),
    }
    return {**faults, "foreign": read.group.present & ~known, **passed}


# ------------------------------------------------------------------ the odometer


def _sensors(model: Balise) -> Iterator[Property]:
    own, machine = model.own, model.machine
    odometer = own.odometer
    yield within(
        "silence delocalizes",
        own.config.gap_limit_cycles,
        ~odometer.measured.present,
        odometer.measured.present | ~machine.flag("valid"),
        statement="when the odometer is silent, the machine reports no position after the permitted gap at the latest",
        requirements=("RFL-D4",),
        unconditional=True,
        helper=lambda waited: waited <= odometer.gap,
    )
    limits = own.config.limits
    possible = between(-limits.max_cycle_distance_mm, odometer.measured.value, limits.max_cycle_distance_mm)
    gate = possible if own.config.checked_distance else possible & _may_have_changed(model)
    yield for_all_inputs(
        "odometer gate",
        odometer.last_verdict.eq(ADMITTED).implies(odometer.measured.present & gate),
        statement="a distance is admitted only below the top speed, and, unless a second unit has checked it, within "
        "the greatest change of speed since the last one",
    )


def _may_have_changed(model: Balise) -> Bool:
    """A vehicle can have changed its speed so much since the last distance."""
    odometer, limits = model.own.odometer, model.own.config.limits
    gap, change = earlier_num(odometer.gap), odometer.measured.value - earlier_num(odometer.last)
    most = _change_mm(model.own.config)
    allowed = with_unit(gap * most, MM) + most
    return (gap > limits.gap_limit) | between(-allowed, change, allowed)


def _change_mm(config: v.BaliseConfig) -> int:
    """The most by which distances of successive cycles differ, in whole mm: acceleration, and a measuring step at either end."""
    millionths = config.max_acceleration_mm_s2 * config.period_ms * config.period_ms
    return math.ceil(millionths / 1_000_000) + config.measuring_step_mm * 2
