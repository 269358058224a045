"""Properties of the reference: which group it is, when it must be taken, when it must be withdrawn, and that nothing else moves it."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import Bool, Num, all_of, as_num, ite
from safeloc.language.spec import Property, always, earlier_bool, earlier_num, within
from safeloc.language.units import COUNT, MM, MS
from safeloc.models.balise.telegram import FAILED, LINKED, NOMINAL, REVERSE, UNKNOWN
from safeloc.models.unlinked_group import UnlinkedGroup
from safeloc.models.unlinked_group import variables as v
from safeloc.models.vocabulary.absent import NO_MARGIN_MM, NO_POSITION_MM
from safeloc.properties.unlinked_group.step import Step

for_all_inputs = partial(always, requirements=("RFL-D4",), unconditional=True)


def reference_properties(model: UnlinkedGroup) -> Iterator[Property]:
    """Return every property of the reference."""
    yield from _taking(model)
    yield from _told_of(model)
    yield from _grows_older(model)
    yield from _accuracy(model)
    yield from _verdict(model)
    yield from _nothing(model)
    yield from _stated(model)
    yield from _withdrawing(model)
    yield from _silence(model)


def _taking(model: UnlinkedGroup) -> Iterator[Property]:
    machine, own, step = model.machine, model.own, Step(model)
    group, taken = machine.output("group"), machine.output("telegram").eq(v.TAKEN)
    yield for_all_inputs(
        "a whole unlinked group is taken",
        step.serves.implies(all_of([step.valid, taken, group.eq(own.read.group.value)])),
        statement="an unlinked group of two or more balises that was read completely, with right check bits, recently, while running "
        "forwards, is the reference from that cycle on, whatever was before",
    )
    anew = step.valid & (~step.was_valid | group.ne(earlier_num(group)))
    yield for_all_inputs(
        "only a whole unlinked group is taken",
        (taken | anew).implies(step.serves),
        statement="nothing else becomes the reference: no group that is marked as linked, no single balise, none that is damaged, "
        "incomplete, old, or read while running backwards",
    )


def _told_of(model: UnlinkedGroup) -> Iterator[Property]:
    machine, own, step = model.machine, model.own, Step(model)
    passed = machine.output("passed")
    first, last = own.read.first.value, own.read.last.value
    same = [machine.output(name).eq(earlier_num(machine.output(name))) for name in ("group", "location_accuracy_mm")]
    yield for_all_inputs(
        "the orientation is the one read",
        step.serves.implies(passed.eq(NOMINAL).iff(last > first) & passed.eq(REVERSE).iff(last < first)),
        statement="the orientation in which the group was passed is nominal if the numbers of its balises rose, else reverse",
        requirements=("RFL-9",),
    )
    yield for_all_inputs(
        "the reference stays as it was read",
        (step.valid & ~step.serves).implies(all_of([step.was_valid, passed.eq(earlier_num(passed)), *same])),
        statement="without another unlinked group, identity, orientation and location accuracy stay those of the reading; no other "
        "telegram and no later national value changes them (SUBSET-026 3.6.4.1.4)",
    )


def _grows_older(model: UnlinkedGroup) -> Iterator[Property]:
    """Claim that the age counts from the reading."""
    machine, own, step = model.machine, model.own, Step(model)
    age = machine.output("age_ms")
    older = earlier_num(age) + own.config.period_ms
    later = ite(older > v.LONGEST_AGE_MS, as_num(v.LONGEST_AGE_MS, MS), older)
    yield for_all_inputs(
        "the age counts from the reading",
        step.valid.implies(age.eq(ite(step.serves, own.read.age.value, later))),
        statement="the age of the reference is that of its telegram, and grows by a cycle in each cycle",
        requirements=("RFL-9",),
    )


def _accuracy(model: UnlinkedGroup) -> Iterator[Property]:
    own, step, national = model.own, Step(model), model.own.national
    in_force = ite(national.known, national.stored, as_num(own.config.default_accuracy_mm, MM))
    yield for_all_inputs(
        "the location accuracy is the national one",
        step.serves.implies(model.machine.output("location_accuracy_mm").eq(in_force)),
        statement="the location accuracy of an unlinked group is the national value when it is read, else the default: no linking "
        "gives one (SUBSET-026 3.6.4.1.3)",
    )
    told = national.known & national.stored.eq(national.national_accuracy.value)
    as_before = national.stored.eq(earlier_num(national.stored)) & national.known.iff(earlier_bool(national.known))
    yield for_all_inputs(
        "a national value stays",
        ite(national.national_accuracy.present, told, as_before),
        statement="a national location accuracy is in force from its reception on, until another one is received",
    )


def _verdict(model: UnlinkedGroup) -> Iterator[Property]:
    yield for_all_inputs(
        "the verdict names the flaw",
        model.machine.output("telegram").eq(_expected(model)),
        statement="the verdict on a reading is its first flaw in this order: malformed, corrupted, old, read while running "
        "backwards, marked as linked, of a single balise, incomplete; a reading without a flaw is taken",
    )


def _expected(model: UnlinkedGroup) -> Num:
    own, step, read = model.own, Step(model), model.own.read
    flaws: list[tuple[Bool, Num]] = [
        (~step.any_given, v.NONE),
        (~step.given, v.MALFORMED),
        (read.check.value.eq(FAILED), v.CORRUPTED),
        (read.age.value >= own.config.telegram_age_limit_ms + 1, v.STALE),
        (own.heading.backwards, v.REVERSING),
        (read.link.value.eq(LINKED), v.MARKED_LINKED),
        (read.total.value < 2, v.SINGLE),
        (read.read.value < read.total.value, v.INCOMPLETE),
    ]
    verdict: Num = v.TAKEN
    for flaw, named in reversed(flaws):
        verdict = ite(flaw, named, verdict)
    return verdict


def _nothing(model: UnlinkedGroup) -> Iterator[Property]:
    machine, step = model.machine, Step(model)
    margins = [machine.output(name).eq(NO_MARGIN_MM) for name in ("margin_above_mm", "margin_below_mm")]
    zero = [
        machine.output("group").eq(as_num(0, COUNT)),
        machine.output("location_accuracy_mm").eq(as_num(0, MM)),
        machine.output("age_ms").eq(as_num(0, MS)),
        machine.output("passed").eq(UNKNOWN),
    ]
    yield for_all_inputs(
        "no report without a reference",
        (~step.valid).implies(all_of([machine.output("distance_mm").eq(NO_POSITION_MM), *margins, *zero])),
        statement="without a reference the machine reports no group and no distance",
    )


def _stated(model: UnlinkedGroup) -> Iterator[Property]:
    """Claim that a reference has an identity, and each loss a reason."""
    machine, step = model.machine, Step(model)
    yield for_all_inputs(
        "a reference has an identity",
        step.valid.implies(machine.output("group").ne(as_num(0, COUNT))),
        statement="a distance is reported only together with the group that it counts from",
    )
    yield for_all_inputs(
        "reason stated",
        machine.output("reason").eq(v.HELD).iff(step.valid),
        statement="the machine gives a reason exactly while it reports no reference",
    )


def _withdrawing(model: UnlinkedGroup) -> Iterator[Property]:
    own, step, reason = model.own, Step(model), model.machine.output("reason")
    carried = step.was_valid & ~step.serves
    yield for_all_inputs(
        "withdrawn where the distance is lost, and only there",
        carried.implies(step.valid.iff(~step.lost)),
        statement="a reference is withdrawn in the cycle in which the odometer is silent for longer than permitted, in which the "
        "vehicle has run backwards for more than D_NVROLL, or in which a margin exceeds the tolerance or the distance what a packet "
        "can tell; in any other cycle it is kept",
    )
    turned = ite(own.heading.backwards, v.REVERSED, v.TOLERANCE)
    why = ite(step.silent_too_long, v.SENSOR_FAILURE, turned)
    stays = reason.eq(earlier_num(reason))
    yield for_all_inputs(
        "the reason is the one of the loss",
        (~step.valid).implies(ite(step.was_valid, reason.eq(why), stays)),
        statement="the reason names what ended the reference, the odometer first, then the direction of running; it stays until the next reference",
    )


def _silence(model: UnlinkedGroup) -> Iterator[Property]:
    """Claim that silence withdraws."""
    own, step = model.own, Step(model)
    odometer = own.odometer
    yield within(
        "silence withdraws",
        own.config.gap_limit_cycles,
        ~odometer.measured.present & ~step.serves,
        odometer.measured.present | step.serves | ~step.valid,
        statement="when the odometer is silent, and no further unlinked group is read, there is no reference after the permitted gap at the latest",
        requirements=("RFL-D4",),
        unconditional=True,
        helper=lambda waited: waited <= odometer.gap,
    )
