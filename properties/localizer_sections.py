"""Properties of a train that is located on board and followed in virtual sections (RFL-13, RFL-14, FVA-9, FVA-18).

All that holds of the localizer and of the sections holds here, and what the area assumes of this train's reports is proved.
Beside it stands what only the whole can keep: that both views hold one truth, and that a section which is reported clear does
not hold any part of this train.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

from safeloc.language.absence import zero_while_absent
from safeloc.language.expr import Bool, Num, all_of, between, exact_to, maximum, minimum
from safeloc.language.spec import Property, always, earlier_bool, earlier_num
from safeloc.language.units import NM
from safeloc.models.area.slot import ACCEPTED
from safeloc.models.localizer_sections import LocalizerSections
from safeloc.models.sections import Section
from safeloc.properties import localizer as localizer_properties
from safeloc.properties import sections as sections_properties
from safeloc.properties.hearing import hears_interval, hears_value

LAW = (
    "each source's own law; a train confirmed to be whole has its length, and nothing of it is ahead of its front end; "
    "undisturbed counters count every vehicle; reports of other trains are true; top speed; no vehicle passes another"
)
REQUIREMENTS = ("RFL-14", "FVA-9", "FVA-18")


SENT = {"position": "position_mm", "below": "margin_below_mm", "above": "margin_above_mm"}
"""Values of an interval in a report: their name in the link -> the output that they come from."""
for_all_inputs = partial(always, requirements=REQUIREMENTS, unconditional=True)
under_assumption = partial(always, requirements=REQUIREMENTS, assumption=LAW)


def properties(model: LocalizerSections) -> list[Property]:
    """Return all properties of the localizer, of the sections, and of both together."""
    parts = [
        *localizer_properties.properties(model.localizer),
        *sections_properties.properties(model.area_and_sections),
    ]
    found = [replace(prop, assumption=LAW) if prop.assumption else prop for prop in parts]
    found += [*_one_truth(model), *_radio(model), *_heard(model)]
    for one in model.sections:
        found += [*_this_train(model, one)]
    return found


def _on_board(model: LocalizerSections) -> tuple[Bool, Num, Num]:
    guard = model.localizer.guard
    of = model.composition.of(guard)
    position, below, above = (
        of.num(guard.output(f"{what}_mm")) for what in ("position", "margin_below", "margin_above")
    )
    return ~of.bool(guard.flag("restrictive")), position - below, position + above


def _by_radio(model: LocalizerSections) -> tuple[Bool, Num, Num]:
    machine = model.localizer.uplink.machine
    of = model.composition.of(machine)
    position, below, above = (
        of.num(machine.output(f"{what}_mm")) for what in ("position", "margin_below", "margin_above")
    )
    return of.bool(machine.flag("valid")), position - below, position + above


def _one_truth(model: LocalizerSections) -> Iterator[Property]:
    (here, low, high), (there, seen_low, seen_high) = _on_board(model), _by_radio(model)
    yield under_assumption(
        "both views agree",
        (here & there).implies((low <= seen_high) & (seen_low <= high)),
        statement="where the vehicle passes on a position and the trackside sees one, both intervals have the true place in common",
    )
    machine, own = model.far_uplink.machine, model.far_uplink.own
    of = model.composition.of(machine)
    position, below, above = (
        of.num(machine.output(f"{what}_mm")) for what in ("position", "margin_below", "margin_above")
    )
    yield under_assumption(
        "the far end is inside its interval",
        of.bool(machine.flag("valid")).implies(
            between(exact_to(position - below, NM), of.num(own.truth), exact_to(position + above, NM))
        ),
        statement="the interval of the train's far end that the trackside gets, widened by its age, holds that end",
    )


def _radio(model: LocalizerSections) -> Iterator[Property]:
    uplink, of = model.localizer.uplink, model.composition.of(model.localizer.uplink.machine)
    guard = model.composition.of(model.localizer.guard)
    landed, valid = of.bool(uplink.machine.fired("report arrives")), of.bool(uplink.machine.flag("valid"))
    flying, held = uplink.own.flying, uplink.own.held
    alike, kept, widened = list[Bool](), list[Bool](), list[Bool]()
    for what, name in SENT.items():
        sent, way, arrived = (
            guard.num(zero_while_absent(model.localizer.guard.output(name))),
            getattr(flying, what),
            getattr(held, what),
        )
        alike.append(of.bool(uplink.own.sent).implies(of.num(way).eq(sent)))
        kept.append(landed.implies(of.num(arrived).eq(earlier_num(of.num(way)))))
        kept.append((valid & ~landed).implies(of.num(arrived).eq(earlier_num(of.num(arrived)))))
    for what in ("below", "above"):
        widened.append(valid.implies(of.num(uplink.machine.output(SENT[what])) >= of.num(getattr(held, what))))
    yield for_all_inputs(
        "the trackside's view is never the narrower one",
        all_of([*alike, *kept, *widened]),
        statement="the interval sent is the one passed on on board; it arrives as it was sent, and is reported no narrower",
    )
    yield for_all_inputs(
        "a report counts once",
        _counted_once(model),
        statement="the area gets a report of a train only in a cycle in which it arrives: a stored report is not repeated",
    )


def _heard(model: LocalizerSections) -> Iterator[Property]:
    """Claims about the inputs of the machines behind the localizer: another interval that holds the truth would keep every other claim."""
    uplink, guard, of = model.localizer.uplink, model.localizer.guard, model.composition.of
    ends, far, told = of(model.ends.machine), of(model.far_uplink.machine), of(uplink.machine)
    here, sent = model.ends.own, model.far_uplink.own
    passed = ~of(guard).bool(guard.flag("restrictive"))
    both = ends.bool(model.ends.machine.flag("valid"))
    on_board = [
        ends.bool(here.valid).iff(passed),
        passed.implies(hears_interval(ends, (here.position, here.below, here.above), of(guard), guard)),
        far.bool(sent.sent).iff(told.bool(uplink.own.sent)),
        far.bool(sent.arrived).iff(told.bool(uplink.own.arrived)),
        far.bool(sent.valid).iff(both),
        both.implies(hears_interval(far, (sent.position, sent.below, sent.above), ends, model.ends.machine)),
    ]
    yield for_all_inputs(
        "both ends are sent together",
        all_of(on_board),
        statement="the far end is reckoned from the interval that the host gets in this cycle; it is sent, and arrives, with the report of the front end",
    )
    yield for_all_inputs(
        "the trackside hears both links",
        all_of(_arrives(model)),
        statement="the trackside has of each end the interval that its link reports, with the age of the report and the way that the train faces",
    )
    yield for_all_inputs(
        "the area hears the trackside",
        all_of(_reaches_the_area(model)),
        statement="the area gets a report of the train in exactly the cycles in which the trackside has a new one, with its bounds, and whole only "
        "with both ends",
    )


def _arrives(model: LocalizerSections) -> Iterator[Bool]:
    side, of, own = model.composition.of(model.trackside.machine), model.composition.of, model.trackside.own
    for end, link in ((own.front, model.localizer.uplink.machine), (own.far, model.far_uplink.machine)):
        valid = of(link).bool(link.flag("valid"))
        yield side.bool(end.valid).iff(valid)
        yield valid.implies(hears_interval(side, (end.position, end.below, end.above), of(link), link))
    uplink, ends = model.localizer.uplink.machine, model.ends.machine
    yield side.num(own.age).eq(of(uplink).num(uplink.output("age_ms")))
    yield side.bool(own.upwards).iff(of(ends).bool(ends.flag("faces_upwards")))


def _reaches_the_area(model: LocalizerSections) -> Iterator[Bool]:
    slot, machine = model.area.own.slots[0], model.trackside.machine
    area, side = model.composition.of(model.area.machine), model.composition.of(machine)
    told = side.bool(machine.flag("reported"))
    yield hears_value(area, slot.rear, told, side.num(machine.output("low_mm")))
    yield hears_value(area, slot.front, told, side.num(machine.output("high_mm")))
    yield area.bool(slot.trusted).iff(told)
    yield area.bool(slot.integer).iff(side.bool(machine.flag("integer")))
    yield area.bool(slot.downwards).iff(side.bool(machine.flag("downwards")))
    yield area.num(slot.age).eq(0)


def _counted_once(model: LocalizerSections) -> Bool:
    """The trackside learns of the train only by a report that arrives; with its state of the cycle before."""
    uplink, seen = model.localizer.uplink.machine, model.trackside
    link, side = model.composition.of(uplink), model.composition.of(seen.machine)
    remembers = side.bool(seen.own.known).iff(link.bool(uplink.flag("valid")))
    age = side.num(seen.own.known_age).eq(link.num(uplink.output("age_ms")))
    return side.bool(seen.machine.flag("reported")).implies(link.bool(uplink.fired("report arrives"))) & remembers & age


def _this_train(model: LocalizerSections, one: Section) -> Iterator[Property]:
    name, slots = one.machine.name, model.area.own.slots
    of, there = model.composition.of(one.machine), model.composition.of(model.area.machine)
    free = of.bool(one.machine.flag("clear"))
    truth, far = (
        model.localizer.motion.own.ghosts.truth,
        model.composition.of(model.ends.machine).num(model.ends.own.far_end),
    )
    start, end = exact_to(of.num(one.start), NM), exact_to(of.num(one.end), NM)
    inside = (minimum(truth, far) <= end) & (maximum(truth, far) >= start)
    yield under_assumption(
        f"{name} is never clear with this train in it",
        (free & there.bool(slots[0].there)).implies(~inside),
        statement="no part of the train that the localizer locates, counted into the area, is in a section that is reported clear",
    )
    link = model.localizer.uplink.machine
    landed = model.composition.of(link).bool(link.fired("report arrives"))
    others = all_of(there.bool(train.last_verdict.ne(ACCEPTED)) for train in slots[1:])
    counted = all_of(~there.bool(train.leaves) for train in slots)
    swept = there.bool(model.area.machine.fired("counters are clear", "everything loose is pushed out"))
    yield for_all_inputs(
        f"{name} is not cleared by a silent uplink",
        (~landed & others & counted & ~swept & ~earlier_bool(free)).implies(~free),
        statement="while no report of this train arrives, only axle counters and reports of other trains can clear a section",
    )
