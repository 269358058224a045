"""Properties of the machine of a line area: what becomes of each report, interval and event (FVA-2, FVA-9, FVA-18).

That an interval holds its train, and that no vehicle is forgotten, is claimed of the sections (`properties/sections.py`). Here stands the
other direction: no report is refused without its reason, no interval is wider than it needs to be, and no train or vehicle is kept
longer than it needs to be.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import Bool, Lit, Num, all_of, any_of, as_num, before, ite, minimum, was, with_unit
from safeloc.language.spec import Property, always
from safeloc.language.units import COUNT, MM, UM
from safeloc.models.area import Area, AreaConfig, um
from safeloc.models.area.slot import (
    ACCEPTED,
    CONTRADICTED,
    ENTERS_HIGH,
    ENTERS_LOW,
    INCOMPLETE,
    LEAVES_HIGH,
    LEAVES_LOW,
    NO_REPORT,
    NOBODY,
    STALE,
    UNTRUSTED,
    Slot,
)
from safeloc.properties.how_many import how_many

for_all_inputs = partial(always, requirements=("FVA-9", "FVA-18"), unconditional=True)


def properties(area: Area) -> list[Property]:
    """Return the properties of the machine by itself; those of trains that are counted out only where axle counters count."""
    found = [*_swept(area)]
    for one in area.own.slots:
        found += [*_verdict(area, one), *_wide(area, one), *_comes(area, one), *_nothing_left(one), *_waits(area, one)]
    if area.own.followers is None:
        found += [*_events(area), *_loose(area), *_pushed_out(area)]
        found += [prop for one in area.own.slots for prop in _sides(area, one)]
    return found


# ------------------------------------------------------------------ terms from the inputs


def _run_mm(config: AreaConfig, ms: int) -> int:
    """Return how far a vehicle runs at the top speed, whole mm, rounded up."""
    return -(config.max_speed_mm_s * ms // -1_000)


def _cycle_mm(area: Area) -> int:
    return _run_mm(area.own.config, area.own.config.period_ms)


def _comes_in(one: Slot) -> Bool:
    return one.event.eq(ENTERS_HIGH) | one.event.eq(ENTERS_LOW)


def _bounded(area: Area, one: Slot) -> tuple[Bool, Bool]:
    """Return whether a report is believed at the low end, and at the high end."""
    trusted = area.own.config.integrity_is_trusted
    whole = [one.integer] if trusted else []
    return any_of([one.downwards, *whole]), any_of([~one.downwards, *whole])


def _since_report_um(one: Slot) -> Num:
    return with_unit(one.age * one.reach.max_speed_mm_s, UM)


def _verdicts(area: Area, one: Slot) -> dict[Lit, Bool]:
    """Return when each verdict is due. A bound of a report moves by the run since, rounded up to a whole millimetre: less than 1 000 um."""
    config, cycle = area.own.config, _cycle_mm(area)
    limit, rounded_um = as_num(config.limit_mm, MM), _since_report_um(one) + 1_000
    above = any_of(um(one.rear.value) - um(bound) >= rounded_um for bound in (before(one.high) + cycle, limit))
    below = any_of(um(bound) - um(one.front.value) >= rounded_um for bound in (before(one.low) - cycle, -limit))
    told = ~(~one.front.present & ~one.rear.present)
    usable = ~any_of([~one.rear.present, ~one.front.present, one.rear.value > one.front.value])
    old, elsewhere, known = one.age > config.report_age_limit_ms, above | below, told & was(one.present)
    return {
        NO_REPORT: ~told,
        NOBODY: told & ~was(one.present),
        UNTRUSTED: known & ~one.trusted,
        INCOMPLETE: known & one.trusted & ~usable,
        STALE: known & one.trusted & usable & old,
        CONTRADICTED: known & one.trusted & usable & ~old & elsewhere,
        ACCEPTED: known & one.trusted & usable & ~old & ~elsewhere,
    }


# ------------------------------------------------------------------ reports and intervals


def _verdict(area: Area, one: Slot) -> Iterator[Property]:
    cases = _verdicts(area, one)
    yield for_all_inputs(
        f"each report of train {one.number} has its verdict",
        all_of(one.last_verdict.eq(verdict).iff(case) for verdict, case in cases.items()),
        statement="a report is accepted, or refused with the first reason against it: no train in the slot, untrusted, incomplete, "
        "too old, or farther from the interval than the train can have run since",
    )
    yield for_all_inputs(
        f"an accepted report of train {one.number} is told",
        area.machine.flag(f"train_{one.number}_accepted").iff(one.last_verdict.eq(ACCEPTED)),
        statement="the area tells of each train whether its report was accepted",
    )


def _wide(area: Area, one: Slot) -> Iterator[Property]:
    """Claim that an interval is no wider than run and report permit."""
    cycle, run_um, (low_end, high_end) = _cycle_mm(area), _since_report_um(one), _bounded(area, one)
    stays = was(one.present) & one.present & ~_comes_in(one)
    yield for_all_inputs(
        f"train {one.number} widens by its run alone",
        stays.implies((before(one.low) - one.low <= cycle) & (one.high - before(one.high) <= cycle)),
        statement="in one cycle the interval of a train widens by no more than the train can run, at either end",
    )
    accepted = stays & one.last_verdict.eq(ACCEPTED)
    yield for_all_inputs(
        f"an accepted report narrows the interval of train {one.number}",
        (accepted & low_end).implies(um(one.rear.value) - um(one.low) < run_um + 1_000)
        & (accepted & high_end).implies(um(one.high) - um(one.front.value) < run_um + 1_000),
        statement="after an accepted report the interval reaches no farther beyond it than the train can have run since, at both ends of "
        "a train that is whole, else at its leading end",
    )


def _comes(area: Area, one: Slot) -> Iterator[Property]:
    """Claim the interval of a train that comes in."""
    own, config = area.own, area.own.config
    late_ms = config.entry_report_delay_ms if config.borders == "occupancy" else 0
    inside = _cycle_mm(area) + _run_mm(config, late_ms)
    ends = {ENTERS_LOW: one.high - own.low_end, ENTERS_HIGH: own.high_end - one.low}
    yield for_all_inputs(
        f"train {one.number} comes in at its end",
        all_of(
            one.event.eq(event).implies(was(one.present) | (one.present & (far_in <= inside)))
            for event, far_in in ends.items()
        ),
        statement="a train that comes in is no farther inside the area than it can have run since",
    )
    everywhere = one.low.eq(-config.limit_mm) & one.high.eq(config.limit_mm)
    yield for_all_inputs(
        f"two trains in slot {one.number} may be anywhere",
        (_comes_in(one) & was(one.present)).implies(one.present & everywhere),
        statement="if a train comes in while another one has its slot, the interval is the whole line",
    )


def _nothing_left(one: Slot) -> Iterator[Property]:
    numbers = (one.low, one.high, one.silent, one.unconfirmed)
    yield for_all_inputs(
        f"nothing is left of train {one.number} when it is gone",
        one.present | (all_of(number.eq(0) for number in numbers) & ~one.below_loose & ~one.above_loose),
        statement="a slot without a train holds neither an interval nor waiting times",
    )


def _waits(area: Area, one: Slot) -> Iterator[Property]:
    most, accepted = area.own.config.count_limit, one.last_verdict.eq(ACCEPTED)
    confirmed = [accepted & one.integer] if area.own.config.integrity_is_trusted else []
    anew = {one.silent: [accepted], one.unconfirmed: confirmed}
    counted = [
        time.eq(ite(any_of([*begins, _comes_in(one)]), as_num(0, COUNT), minimum(before(time) + 1, most)))
        for time, begins in anew.items()
    ]
    yield for_all_inputs(
        f"the waiting times of train {one.number} are counted",
        one.present.implies(all_of(counted)),
        statement="the cycles since the last accepted report, and since the last one of a train that is known to be whole, are counted",
    )


def _swept(area: Area) -> Iterator[Property]:
    _, swept = area.machine.modes
    yield for_all_inputs(
        "a swept area is told",
        area.machine.flag("swept").iff(area.machine.mode.eq(swept)),
        statement="the area tells that no vehicle can be in it that nobody counted, exactly while that is so",
    )


# ------------------------------------------------------------------ events, where every vehicle is counted


def _cleared(area: Area) -> Bool:
    """Return whether undisturbed counters report a clear area, no train comes in, and no report is accepted."""
    own = area.own
    busy = any_of(_comes_in(one) | one.last_verdict.eq(ACCEPTED) for one in own.slots)
    return own.clear & own.healthy & ~busy


def _uncounted(area: Area) -> Bool:
    """Return whether counters are disturbed, or a train comes in while another one has its slot."""
    return any_of([~area.own.healthy, *(was(one.present) & _comes_in(one) for one in area.own.slots)])


def _left(area: Area, one: Slot) -> tuple[Bool, Bool]:
    """Return whether the train has left at the low end, and at the high end: counted out there, and so near that it can be."""
    own, cycle = area.own, _cycle_mm(area)
    known = own.healthy & was(one.present)
    at_low = one.event.eq(LEAVES_LOW) & (before(one.low) - own.low_end <= cycle)
    at_high = one.event.eq(LEAVES_HIGH) & (own.high_end - before(one.high) <= cycle)
    return known & at_low, known & at_high


def _events(area: Area) -> Iterator[Property]:
    own, cleared = area.own, _cleared(area)
    gone = {one: any_of(_left(area, one)) for one in own.slots}
    stays = [one.present.iff(~cleared & (_comes_in(one) | (was(one.present) & ~gone[one]))) for one in own.slots]
    yield for_all_inputs(
        "a train is in the area until it is counted out",
        all_of(stays),
        statement="a slot has a train from the cycle in which it is counted in, until it is counted out at an end that it can have reached, "
        "or the area is reported clear",
    )
    rejected = [
        (one.event.one_of(LEAVES_HIGH, LEAVES_LOW) & ~gone[one]) | (was(one.present) & _comes_in(one))
        for one in own.slots
    ]
    yield for_all_inputs(
        "impossible events are counted",
        area.machine.output("events_rejected").eq(ite(cleared, as_num(0, COUNT), how_many(rejected))),
        statement="the area tells how many trains left where they cannot be, or came in while another train had their slot",
    )


def _loose(area: Area) -> Iterator[Property]:
    own, cycle, unswept = area.own, _cycle_mm(area), area.machine.mode.eq(area.machine.modes[0])
    yield for_all_inputs(
        "vehicles that nobody counted have room",
        unswept.implies(all_of([own.loose_low <= own.loose_high, own.loose_low <= own.high_end, own.low_end <= own.loose_high])),
        statement="the area is swept as soon as there is no place in it left where a vehicle can be that nobody counted",
    )  # fmt: skip
    follows = unswept & before(area.machine.mode).eq(area.machine.modes[0]) & ~_uncounted(area)
    yield for_all_inputs(
        "vehicles that nobody counted run no faster than others",
        follows.implies(
            (before(own.loose_low) - own.loose_low <= cycle) & (own.loose_high - before(own.loose_high) <= cycle)
        ),
        statement="in one cycle the bounds for vehicles that nobody counted widen by no more than such a vehicle can run",
    )


def _pushed_out(area: Area) -> Iterator[Property]:
    swept, counted = area.machine.mode.eq(area.machine.modes[1]), ~_uncounted(area)
    pushed = list[Bool]()
    for one in area.own.slots:
        at_low, at_high = _left(area, one)
        pushed += [was(one.below_loose) & at_high, was(one.above_loose) & at_low]
    yield for_all_inputs(
        "a train that runs through sweeps the area",
        (counted & any_of(pushed)).implies(swept),
        statement="when a train that had all uncounted vehicles ahead of it is counted out at the far end, the area is swept",
    )


def _sides(area: Area, one: Slot) -> Iterator[Property]:
    anew, (low, high) = _comes_in(one), (one.event.eq(ENTERS_LOW), one.event.eq(ENTERS_HIGH))
    known = one.present & ~_uncounted(area)
    yield for_all_inputs(
        f"it is known on which side of train {one.number} uncounted vehicles are",
        known.implies(
            one.below_loose.iff(low | (was(one.below_loose) & ~anew))
            & one.above_loose.iff(high | (was(one.above_loose) & ~anew))
        ),
        statement="uncounted vehicles are above a train that came in at the low end, and below one that came in at the high end, until a "
        "counter is disturbed",
    )
