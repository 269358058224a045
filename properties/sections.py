"""Properties of virtual sections and of their line area (FVA-2, FVA-9, FVA-18)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

from safeloc.language.expr import Bool, Num, all_of, any_of, maximum, minimum, with_unit
from safeloc.language.spec import Property, always, earlier_bool, earlier_num
from safeloc.language.terms import Substitution
from safeloc.language.units import UM
from safeloc.models.area import um
from safeloc.models.area.judgement import (
    NO_TRAIN,
    PART_LEFT_BEHIND,
    TRAIN_FOLLOWED,
    TRAIN_SILENT,
    TRAINS_ELSEWHERE,
    UNCOUNTED,
    VERIFIED,
)
from safeloc.models.area.slot import ACCEPTED, Slot
from safeloc.models.sections import RULES, Section, Sections
from safeloc.properties import area, followers, section_report

LAW = (
    "undisturbed counters count every vehicle; trusted reports contain the train, its rear end only if it is "
    "whole; top speed; no vehicle passes another"
)
_DETECTED = (
    "detection is clear over nobody, and nobody comes in past a side that is clear; trains report when they come in, at the latest when entry_report_delay_ms ends; "
    "trusted reports contain the train, its rear end only if it is whole; top speed; no vehicle passes another"
)
REQUIREMENTS = ("FVA-9", "FVA-18")
for_all_inputs = partial(always, requirements=REQUIREMENTS, unconditional=True)
under_assumption = partial(always, requirements=("FVA-9",), assumption=LAW)


def properties(model: Sections) -> list[Property]:
    """Return every property of the area and its sections, over the whole composition."""
    found = _all(model)
    if model.area.own.followers is None:
        return found
    return [replace(prop, assumption=_DETECTED) if prop.assumption == LAW else prop for prop in found]


def of_each_machine(model: Sections) -> Iterator[Property]:
    """Yield what holds of the area by itself, and of each section by itself."""
    for claim in area.properties(model.area):
        yield model.composition.inherited(model.area.machine, claim)
    for one in model.sections:
        for claim in section_report.properties(one):
            yield model.composition.inherited(one.machine, claim)


def _all(model: Sections) -> list[Property]:
    found = [*_area(model)]
    for one in model.sections:
        found += [
            *_safety(model, one),
            *_evidence(model, one),
            *_silence(model, one),
            *_rule(model, one),
            *_reported(model, one),
            *_timed(model, one),
        ]
    return found


def _area(model: Sections) -> Iterator[Property]:
    for one in model.area.own.slots:
        yield from _interval(model, one)
        yield from _narrowed(model, one)
    yield from _loose(model)
    yield from followers.properties(model.area, model.composition.of(model.area.machine))


def _interval(model: Sections, one: Slot) -> Iterator[Property]:
    """Claim that the interval of a train contains it, and becomes narrower only by an accepted report."""
    of = model.composition.of(model.area.machine)
    inside = (um(one.low) <= one.true_rear) & (one.true_front <= um(one.high))
    yield under_assumption(
        f"train {one.number} containment",
        of.bool(one.there.implies(one.present & inside)),
        statement="a train in the area is in its slot's interval, from rear end to front end",
    )
    yield for_all_inputs(
        f"train {one.number} narrows only by an accepted report",
        _widens(of, one),
        statement="a report that is withheld, untrusted, stale, incomplete or contradicted narrows nothing",
        requirements=("FVA-9",),
    )


def _narrowed(model: Sections, one: Slot) -> Iterator[Property]:
    """Claim the limits within which a report narrows the interval."""
    of, own = model.composition.of(model.area.machine), model.area.own
    yield for_all_inputs(
        f"train {one.number} report is widened by its age",
        _aged(of, one),
        statement="a report narrows a train's interval no further than to the stretch that the train can have reached since, at top speed",
        requirements=("FVA-9",),
    )
    yield for_all_inputs(
        f"train {one.number} that may be split is believed at its leading end only",
        _leads(of, one),
        statement="a report of a train that is not known to be whole, or whose report of integrity is not trusted, narrows nothing at the trailing end",
        requirements=("FVA-9",),
    )
    yield for_all_inputs(
        f"only trusted reports confirm the integrity of train {one.number}",
        _confirmed(of, one, own.config.integrity_is_trusted),
        statement="the time without confirmed integrity ends by an accepted report of a train that is whole, if such "
        "reports are trusted, and never otherwise while the train is in the area",
        requirements=("FVA-9",),
    )


def _loose(model: Sections) -> Iterator[Property]:
    machine, own = model.area.machine, model.area.own
    of = model.composition.of(machine)
    within = [
        machine.mode.eq(machine.modes[0])
        & (um(own.loose_low) <= own.loose_rear)
        & (own.loose_front <= um(own.loose_high))
    ]
    if own.followers is not None:
        within += [own.loose_front <= um(own.followers.low.bound), own.loose_rear >= um(own.followers.high.bound)]
    loose = own.loose_there.implies(any_of(within))
    yield under_assumption(
        "loose vehicles are accounted for",
        of.bool(loose),
        statement="a vehicle that was never counted is only within the area's bounds for such vehicles",
    )


def _widens(of: Substitution, one: Slot) -> Bool:
    """Return the condition that both bounds move outward without an accepted report or an event (except at the ends of the world)."""
    limit, present = one.reach.limit_mm, of.bool(one.present)
    low, high = of.num(one.low), of.num(one.high)
    quiet = of.bool(one.last_verdict.ne(ACCEPTED) & ~one.enters) & earlier_bool(present) & present
    lower = (low <= earlier_num(low)) | low.eq(-limit) | _raised(of, one, low)
    higher = (high >= earlier_num(high)) | high.eq(limit) | _lowered(of, one, high)
    return quiet.implies(lower & higher)


def _aged(of: Substitution, one: Slot) -> Bool:
    """Return bounds after an accepted report, in figures of their own, since the law uses the run that the machine adds."""
    low, high = of.num(um(one.low)), of.num(um(one.high))
    run = with_unit(one.age * one.reach.max_speed_mm_s, UM)
    lowest = maximum(earlier_num(low), of.num(um(one.rear.value) - run))
    highest = minimum(earlier_num(high), of.num(um(one.front.value) + run))
    accepted = of.bool(one.last_verdict.eq(ACCEPTED) & ~one.enters & one.present)
    lower = (low <= lowest) | _raised(of, one, of.num(one.low))
    higher = (high >= highest) | _lowered(of, one, of.num(one.high))
    return accepted.implies(lower & higher)


def _raised(of: Substitution, one: Slot, low: Num) -> Bool:
    """Return the condition that the bound is at the end of a detection section inside the area that is clear."""
    return any_of(of.bool(inner.clear) & low.eq(of.num(inner.end)) for inner in one.inner)


def _lowered(of: Substitution, one: Slot, high: Num) -> Bool:
    """Return the condition that the bound is at the start of such a section."""
    return any_of(of.bool(inner.clear) & high.eq(of.num(inner.start)) for inner in one.inner)


def _leads(of: Substitution, one: Slot) -> Bool:
    low, high = of.num(one.low), of.num(one.high)
    parted = one.present & ~one.integer if one.integrity_is_trusted else one.present
    split = of.bool(one.last_verdict.eq(ACCEPTED) & ~one.enters & parted)
    lower = (low <= earlier_num(low)) | _raised(of, one, low)
    higher = (high >= earlier_num(high)) | _lowered(of, one, high)
    return (split & of.bool(~one.downwards)).implies(lower) & (split & of.bool(one.downwards)).implies(higher)


def _confirmed(of: Substitution, one: Slot, trusted: bool) -> Bool:
    waited, present = of.num(one.unconfirmed), of.bool(one.present)
    stays = earlier_bool(present) & present & of.bool(~one.enters)
    longer = (waited > earlier_num(waited)) | waited.eq(one.unconfirmed.high)
    word = of.bool(one.last_verdict.eq(ACCEPTED) & one.integer)
    return stays.implies(longer | (word & waited.eq(0)) if trusted else longer)


def _rule(model: Sections, one: Section) -> Iterator[Property]:
    """Claim the rule that led to the state."""
    machine, name = one.machine, one.machine.name
    of = model.composition.of(machine)
    mode, rule = of.num(machine.mode), of.num(machine.output("rule"))
    by_label = {member.label: member for member in machine.modes}
    changed = [
        (earlier_num(mode).eq(by_label[source]) & mode.eq(by_label[target])).implies(rule.eq(number))
        for (source, target), number in RULES.items()
    ]
    stays = earlier_num(mode).eq(mode).implies(rule.eq(earlier_num(rule)))
    yield for_all_inputs(
        f"{name} names the rule",
        all_of([*changed, stays]),
        statement="the reported rule is that of the change of state that happened, and stays while the state does",
    )


def _reported(model: Sections, one: Section) -> Iterator[Property]:
    """Claim the evidence of the state, and its trust."""
    machine, name, config = one.machine, one.machine.name, one.config
    of = model.composition.of(machine)
    mode = of.num(machine.mode)
    evidence, trust = of.num(machine.output("evidence")), of.num(machine.output("trust"))
    age = of.num(machine.output("evidence_age_cycles"))
    _, free, occupied, _ = machine.modes
    yield for_all_inputs(
        f"{name} names its evidence",
        mode.eq(free).iff(evidence.one_of(NO_TRAIN, TRAINS_ELSEWHERE))
        & mode.eq(occupied).iff(evidence.eq(TRAIN_FOLLOWED)),
        statement="FREE rests on trains that are elsewhere or on there being none, OCCUPIED on a train with recent reports "
        "that is whole, and neither on anything else",
    )
    yield for_all_inputs(
        f"{name} is trusted as far as its reports are fresh",
        trust.eq(VERIFIED).implies((age <= config.mute_limit_cycles) & evidence.ne(UNCOUNTED))
        & mode.eq(occupied).implies(trust.eq(VERIFIED)),
        statement="a state reported as verified rests on trusted reports within the mute timer, and OCCUPIED always does",
    )


def _timed(model: Sections, one: Section) -> Iterator[Property]:
    machine, name = one.machine, one.machine.name
    of = model.composition.of(machine)
    mode = of.num(machine.mode)
    _, _, occupied, _ = machine.modes
    yield for_all_inputs(
        f"{name} obeys its timers",
        mode.eq(occupied).implies(all_of(_in_time(model, one))),
        statement="the state is no longer OCCUPIED from the cycle on in which the mute timer or the integrity timer of a "
        "train in the section ends",
    )
    evidence = of.num(machine.output("evidence"))
    yield for_all_inputs(
        f"{name} doubts no train within its timers",
        all_of(_in_time(model, one)).implies(~evidence.one_of(TRAIN_SILENT, PART_LEFT_BEHIND)),
        statement="while every train that may be in the section is within its mute timer and its integrity timer, as the area counts "
        "them, the state rests neither on a silent train nor on a part that a train may have lost",
    )


def _in_time(model: Sections, one: Section) -> Iterator[Bool]:
    """Yield the condition that a train is within both timers, for every train that may be in the section."""
    of, there = model.composition.of(one.machine), model.composition.of(model.area.machine)
    for train in model.area.own.slots:
        low, high = there.num(train.low), there.num(train.high)
        here = there.bool(train.present) & _overlaps(low, high, of.num(one.start), of.num(one.end))
        here = here & ~_detected_clear(model, one) if model.area.own.inner else here
        recent = there.num(train.silent) <= one.config.mute_limit_cycles
        yield here.implies(recent & (there.num(train.unconfirmed) <= one.config.integrity_limit_cycles))


def _safety(model: Sections, one: Section) -> Iterator[Property]:
    own, name = model.area.own, one.machine.name
    of, there = model.composition.of(one.machine), model.composition.of(model.area.machine)
    free = of.bool(one.machine.flag("clear"))
    start, end = of.num(um(one.start)), of.num(um(one.end))
    ends = [(one.part_rear, one.part_front) if one.inner else (one.true_rear, one.true_front) for one in own.slots]
    trains = [
        there.bool(train.there) & _overlaps(there.num(rear), there.num(front), start, end)
        for train, (rear, front) in zip(own.slots, ends, strict=True)
    ]
    loose = there.bool(own.loose_there) & _overlaps(there.num(own.loose_rear), there.num(own.loose_front), start, end)
    yield under_assumption(
        f"{name} is never clear with a train in it",
        free.implies(~any_of(trains)),
        statement="a section that contains any part of any train, from min safe rear to max safe front, is never FREE: "
        "with several trains, entering, leaving, reversing, lost and coming back",
        requirements=REQUIREMENTS,
    )
    yield under_assumption(
        f"{name} is never clear with a vehicle that was not counted",
        free.implies(~loose),
        statement="a vehicle that was never counted never stands in a FREE section",
        requirements=REQUIREMENTS,
    )


def _overlaps(rear: Num, front: Num, start: Num, end: Num) -> Bool:
    return (rear <= end) & (front >= start)


def _evidence(model: Sections, one: Section) -> Iterator[Property]:
    """Claim that a section is clear only on evidence."""
    name = one.machine.name
    of, there = model.composition.of(one.machine), model.composition.of(model.area.machine)
    free = of.bool(one.machine.flag("clear"))
    slots = model.area.own.slots
    apart = []
    for train in slots:
        low, high = there.num(train.low), there.num(train.high)
        apart.append(~there.bool(train.present) | (high < of.num(one.start)) | (low > of.num(one.end)))
    detected = ", or detection inside the area says that nobody is there" if model.area.own.inner else ""
    yield for_all_inputs(
        f"{name} is clear only on evidence",
        free.implies(all_of(apart) | _detected_clear(model, one)),
        statement="a section is FREE only if every counted train is known to be elsewhere" + detected,
    )


def _detected_clear(model: Sections, one: Section) -> Bool:
    """Return the condition that the section is in a detection section inside the area that is clear."""
    of, there = model.composition.of(one.machine), model.composition.of(model.area.machine)
    start, end = of.num(one.start), of.num(one.end)
    return any_of(
        there.bool(inner.clear) & (there.num(inner.start) <= start) & (end <= there.num(inner.end))
        for inner in model.area.own.inner
    )


def _silence(model: Sections, one: Section) -> Iterator[Property]:
    """Claim that missing reports clear no section."""
    name = one.machine.name
    of, there = model.composition.of(one.machine), model.composition.of(model.area.machine)
    free = of.bool(one.machine.flag("clear"))
    slots = model.area.own.slots
    silent = all_of(there.bool(train.last_verdict.ne(ACCEPTED) & ~train.leaves) for train in slots)
    swept = model.area.machine
    silent = silent & ~any_of(there.bool(inner.clear) for inner in model.area.own.inner)
    quiet = silent & ~there.bool(swept.fired("counters are clear", "everything loose is pushed out"))
    yield for_all_inputs(
        f"{name} is not cleared by silence",
        (quiet & ~earlier_bool(free)).implies(~free),
        statement="withheld, stale or missing reports never move a section towards FREE",
        requirements=("FVA-9",),
    )
