"""Claims on what the axle counters at both ends say, and on whom: this train, its axles, and the pattern that is its own (FVA-2, FVA-4, FVA-9).

The axle section, the order of trains and the entry of this train act in one step; these claims read the counters' inputs themselves.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import Bool, all_of, any_of, between, exact_to
from safeloc.language.spec import Property, always, earlier_bool, earlier_num
from safeloc.language.units import UM
from safeloc.models.area.slot import ACCEPTED, ENTERS_HIGH, ENTERS_LOW, LEAVES_HIGH, LEAVES_LOW
from safeloc.models.fibre_area import FibreArea
from safeloc.models.verification.variables import NOBODY
from safeloc.properties import axle_section, train_order
from safeloc.properties.fibre_area.counters import Counted

LAW = (
    "undisturbed counters count every axle and report every train that comes in; no train passes another; if there are as many patterns "
    "as trains, lying apart, each contains a train; a vehicle between the counters has an axle there"
)
_STAY = ("FVA-2", "FVA-11")
_COUNTER = ("FVA-4", "FVA-13")
_CLEAR = ("FVA-9", "FVA-18")
for_all_inputs = partial(always, unconditional=True)


def counted(model: FibreArea) -> Iterator[Property]:
    """Yield the claims."""
    seen = Counted(model)
    yield from _of_machines(model)
    yield from _its_pattern(seen)
    yield from _left(seen)
    yield from _first(seen)
    yield from _events(seen)
    yield _order_hears(seen)
    yield from _in_order(seen)
    yield from _area(seen)
    yield from _there(seen)
    yield from _ghosts(seen)
    yield _axle_between(seen)
    yield _hears_clear(seen)


# ------------------------------------------------------------------ claims of the machines themselves


def _of_machines(model: FibreArea) -> Iterator[Property]:
    """Yield what the axle section and the order of trains claim of themselves: their laws are laws of the whole."""
    for machine, claims in (
        (model.axle_section.machine, axle_section.properties(model.axle_section)),
        (model.order.machine, train_order.properties(model.order)),
    ):
        for claim in claims:
            if claim.kind == "always":
                yield model.composition.inherited(machine, claim)


# ------------------------------------------------------------------ patterns


def _its_pattern(seen: Counted) -> Iterator[Property]:
    model, own = seen.model, seen.model.order.own
    verification, report = model.verification.machine, model.composition.of(model.report.machine)
    trusted = model.composition.of(verification).bool(verification.flag("trusted"))
    inside = seen.order.bool(own.trains[0].inside)
    yield always(
        "a trusted train is in its pattern",
        trusted.implies(inside & _held(seen)),
        statement="while the train is trusted it is between the counters, and in the pattern that is taken for its own, whatever other "
        "patterns there are",
        requirements=_STAY,
        assumption=LAW,
    )
    yield for_all_inputs(
        "the train's pattern is one that holds it",
        report.bool(model.report.own.pattern_is_the_trains).implies(_held(seen)),
        statement="what is assumed of the train's own pattern is assumed of a pattern that holds the train, and that is taken for its own",
        requirements=_STAY,
    )


def _held(seen: Counted) -> Bool:
    """This train is in a pattern that is taken for its own."""
    own, of = seen.model.order.own, seen.order
    place = of.num(own.trains[0].place)
    return any_of(
        of.num(train).eq(1) & between(of.num(exact_to(low, UM)), place, of.num(exact_to(high, UM)))
        for train, low, high in zip(own.belongs, own.lows, own.highs, strict=True)
    )


# ------------------------------------------------------------------ axles of this train


def _left(seen: Counted) -> Iterator[Property]:
    model, own = seen.model, seen.model.entry.own
    present = seen.area.bool(model.area.own.slots[0].present)
    inside, sure = seen.entry.num(own.inside), seen.entry.bool(own.sure)
    yield for_all_inputs(
        "a train that leaves a part behind has not left",
        all_of([earlier_bool(present), seen.surplus.ne(earlier_num(inside)), ~seen.enters, ~seen.is_clear]).implies(
            present & ~seen.all_left
        ),
        statement="while the axles counted out of a train differ from those counted in, it stays in the area and keeps its "
        "sections: no event of leaving clears them, only counters that report an empty area",
        requirements=(*_STAY, *_CLEAR),
    )
    unsure = ~seen.counting | ~seen.was_ordered | (~seen.enters & ~earlier_bool(sure))
    yield for_all_inputs(
        "a train of which axles were not counted is not counted out",
        (unsure & ~seen.is_clear).implies(~sure & ~seen.all_left),
        statement="from a cycle on in which a counter was disturbed, or the order of trains was not known, a train does not leave until "
        "another one enters in its place, or the counters report an empty area: its balance of axles is no longer sure",
        requirements=(*_STAY, *_CLEAR),
    )
    yield for_all_inputs(
        "a train leaves by a reported exit or by an empty area",
        seen.all_left.implies(_passes_out(seen) | seen.is_clear),
        statement="a train has left only in a cycle in which its exit is reported where it is the outermost, or in which the counters report an empty area",
        requirements=(*_STAY, *_CLEAR),
    )
    yield for_all_inputs(
        "clear counters let the train go",
        (seen.is_clear & _was_here(seen) & ~seen.enters).implies(_gone(seen)),
        statement="a train is gone in the cycle in which undisturbed counters report that no axle is in the area, unless it comes in then: it is neither awaited, nor "
        "verified against its record any more, also not against one that came after it had left",
        requirements=_STAY,
    )
    yield for_all_inputs(
        "a train of which all axles went out has left",
        all_of(
            [
                seen.counting,
                seen.was_ordered,
                earlier_bool(sure),
                ~seen.enters,
                _passes_out(seen),
                seen.surplus.eq(earlier_num(inside)),
                ~seen.more,
            ]
        ).implies(seen.all_left),
        statement="a train that passes out where it is the outermost, and of which as many axles have been counted out as in, has left in "
        "that cycle, unless axles came in beside it that are not its own",
        requirements=_STAY,
    )


def _was_here(seen: Counted) -> Bool:
    """The train was counted in, or its record came."""
    machine = seen.model.entry.machine
    return ~earlier_bool(seen.entry.num(machine.mode).eq(machine.modes[0]))


def _gone(seen: Counted) -> Bool:
    """The entry waits for no train, and no reference is stored."""
    entry, verification = seen.model.entry.machine, seen.model.verification.machine
    away = seen.entry.num(entry.mode).eq(entry.modes[0])
    none = seen.model.composition.of(verification).num(verification.mode).eq(verification.modes[0])
    return away & none


def _first(seen: Counted) -> Iterator[Property]:
    """Claim what is known of a train that comes in, before its own record."""
    entry, verification = seen.model.entry, seen.model.verification.machine
    verified = seen.model.composition.of(verification)
    nobody_sends = seen.entry.num(entry.own.comes).eq(NOBODY)
    mode, waited = seen.entry.num(entry.machine.mode), seen.entry.num(entry.own.waited)
    yield for_all_inputs(
        "a train that comes in is verified against no earlier record",
        (seen.enters & nobody_sends).implies(verified.num(verification.mode).eq(verification.modes[0])),
        statement="in the cycle in which a train comes in, no reference is stored but one that comes in that cycle",
        requirements=_STAY,
    )
    yield for_all_inputs(
        "the wait for a reference begins with the entry and grows",
        all_of(
            [
                (seen.enters & nobody_sends).implies(mode.eq(entry.machine.modes[1]) & waited.eq(0)),
                (mode.eq(entry.machine.modes[1]) & ~seen.enters).implies(waited > earlier_num(waited)),
            ]
        ),
        statement="a train that comes in without a record is awaited, and the time grows in every cycle in which none comes",
        requirements=("FVA-D1", *_STAY),
    )
    part = seen.entry.bool(entry.own.in_part)
    yield for_all_inputs(
        "a train that left a part behind is named",
        (_passes_out(seen) & ~seen.enters & ~seen.all_left).implies(part),
        statement="a train that passes out with fewer axles than came in is reported as having left a part behind",
        requirements=_STAY,
    )


def _passes_out(seen: Counted) -> Bool:
    """The running part of this train passes out, at an end at which it is the outermost."""
    ends = zip(seen.model.entry.own.leaves, seen.was_outermost, strict=True)
    return any_of(seen.entry.bool(out) & last.eq(1) for out, last in ends)


# ------------------------------------------------------------------ events


def _events(seen: Counted) -> Iterator[Property]:
    """Claim at which end, and of which train, the area hears that one comes or goes: else everything is proved of a wrong one."""
    own = seen.model.entry.own
    comes = [seen.entry.num(one) for one in own.enters]
    goes = [seen.entry.bool(one) for one in own.leaves]
    terms = list[Bool]()
    for slot in seen.model.area.own.slots:
        event, number = seen.area.num(slot.event), slot.number
        others = [seen.entry.bool(one) & comes[0].ne(n) & comes[1].ne(n) for n, one in enumerate(own.all_left, 2)]
        left = [seen.all_left, *others][number - 1]
        at = [going & last.eq(number) & left for going, last in zip(goes, seen.was_outermost, strict=True)]
        terms += [
            event.eq(ENTERS_LOW).iff(comes[0].eq(number)),
            event.eq(ENTERS_HIGH).iff(comes[1].eq(number) & comes[0].ne(number)),
            event.eq(LEAVES_LOW).iff(at[0]),
            event.eq(LEAVES_HIGH).iff(at[1] & ~at[0]),
        ]
    yield for_all_inputs(
        "the area hears of a train at the end where it is counted",
        all_of(terms),
        statement="the area hears that a train comes in, and that all of the outermost train has left, in the cycle in which the counters "
        "report it, and at the same end",
        requirements=_CLEAR,
    )


def _order_hears(seen: Counted) -> Property:
    entry, order, of = seen.model.entry.own, seen.model.order.own, seen.order
    heard = [
        of.num(mine).eq(seen.entry.num(reported))
        for mine, reported in zip((order.enters_low, order.enters_high), entry.enters, strict=True)
    ]
    for mine, out, last in zip((order.leaves_low, order.leaves_high), entry.leaves, seen.was_outermost, strict=True):
        here = [
            last.eq(1) & seen.all_left,
            *(last.eq(n) & seen.entry.bool(left) for n, left in enumerate(entry.all_left, 2)),
        ]
        heard.append((seen.entry.bool(out) & any_of(here)).implies(of.bool(mine)))
        heard.append((of.bool(mine) & (last > 0)).implies(any_of(here)))
    return for_all_inputs(
        "the order hears each train at its end",
        all_of(heard),
        statement="the order of trains hears that a train comes in at the end at which it does, and that the outermost one at an end is gone only "
        "when all of it has left",
        requirements=_STAY,
    )


def _in_order(seen: Counted) -> Iterator[Property]:
    """Claim what the order of trains hears of this one."""
    known = seen.was_ordered & seen.believed
    yield for_all_inputs(
        "a train that left a part behind stays in the order",
        all_of(
            [known, ~_any_event_but_this(seen), ~seen.all_left, ~seen.is_clear, earlier_bool(_listed(seen))]
        ).implies(_listed(seen)),
        statement="a train is taken out of the order of trains only when all of it has left, or the counters report an empty area",
        requirements=_STAY,
    )
    yield for_all_inputs(
        "a train that has left is in the order no more",
        all_of([seen.was_ordered, seen.all_left, _passes_out(seen), ~seen.enters]).implies(~_listed(seen)),
        statement="a train of which all axles have left is taken out of the order of trains in that cycle",
        requirements=_STAY,
    )
    own = seen.model.entry.own
    others = all_of(~seen.entry.bool(one) for one in own.leaves) & _one_enters(seen)
    yield for_all_inputs(
        "a train that comes in is in the order",
        all_of([known, seen.enters, others, earlier_bool(seen.order.num(seen.model.order.own.order[0]).eq(0))]).implies(
            _listed(seen)
        ),
        statement="a train that is counted into an empty area is in the order of trains from that cycle on",
        requirements=_STAY,
    )
    quiet = ~seen.enters & ~_any_event_but_this(seen) & all_of(~seen.entry.bool(one) for one in own.leaves)
    yield for_all_inputs(
        "clear counters make the order known",
        (seen.is_clear & quiet).implies(seen.is_ordered & ~_listed(seen)),
        statement="in a cycle in which the counters report an empty area and no train comes or goes, the order of trains is known: none is there",
        requirements=_STAY,
    )


def _hears_clear(seen: Counted) -> Property:
    hears = any_of(seen.order.bool(one) for one in (seen.model.order.own.leaves_low, seen.model.order.own.leaves_high))
    return for_all_inputs(
        "the order hears that clear counters let the train go",
        all_of([seen.is_clear, seen.was_outermost[0].eq(1), _was_here(seen), ~seen.anyone_enters]).implies(hears),
        statement="the order of trains hears that a train which was first at the low end is gone in the cycle in which the counters report an empty area and none comes in, though nobody reported its "
        "exit: what is assumed of a train that was not reported as gone is not assumed of this one",
        requirements=_STAY,
    )


def _listed(seen: Counted) -> Bool:
    """This train is in the order of trains."""
    return any_of(seen.order.num(one).eq(1) for one in seen.model.order.own.order)


def _one_enters(seen: Counted) -> Bool:
    """A train comes in at one end at most."""
    low, high = (seen.entry.num(one) for one in seen.model.entry.own.enters)
    return (low < 1) | (high < 1)


def _any_event_but_this(seen: Counted) -> Bool:
    """A train comes in, or another one than this goes out."""
    own = seen.model.entry.own
    return seen.anyone_enters | any_of(
        seen.entry.bool(out) & last.ne(1) for out, last in zip(own.leaves, seen.was_outermost, strict=True)
    )


# ------------------------------------------------------------------ the area


def _area(seen: Counted) -> Iterator[Property]:
    area, machine = seen.model.area.own, seen.model.area.machine
    swept = seen.area.bool(machine.flag("swept"))
    busy = any_of(seen.area.bool(one.enters | one.last_verdict.eq(ACCEPTED)) for one in area.slots)
    yield for_all_inputs(
        "disturbed counters leave the area unswept",
        (~seen.counting | seen.of_nobody | seen.more).implies(~swept & ~seen.is_ordered),
        statement="in a cycle in which the counters do not count, or count in axles of which no train is known, or more beside this train than are its own, vehicles may have come in "
        "uncounted: the area is not swept, and no order of trains is known",
        requirements=(*_COUNTER, *_CLEAR),
    )
    yield for_all_inputs(
        "clear counters sweep the area",
        (seen.is_clear & ~busy).implies(swept),
        statement="in a cycle in which every axle that was counted in is out, the area is swept, unless a train comes in or is reported",
        requirements=(*_COUNTER, *_CLEAR),
    )


def _there(seen: Counted) -> Iterator[Property]:
    slot, entry = seen.model.area.own.slots[0], seen.model.entry.own
    there, leaves = seen.area.bool(slot.there), seen.area.bool(slot.leaves)
    axles = seen.heads.num(seen.model.axle_section.own.axles) > 0
    yield for_all_inputs(
        "axles between the counters keep the train there",
        (earlier_bool(there) & ~leaves & axles).implies(there),
        statement="in the world of these claims, a train is in the area for as long as an axle is between the counters and it is not counted out",
        requirements=_CLEAR,
    )
    counted_in = seen.entry.bool(entry.there) & seen.counting & ~seen.is_clear
    yield for_all_inputs(
        "nothing but axles or a count keeps a train there",
        there.implies(any_of([axles, counted_in, seen.area.bool(slot.enters)])),
        statement="in the world of these claims, a train is in the area no longer than an axle is between the counters, or the counters count and it came in and has not left",
        requirements=_CLEAR,
    )


def _ghosts(seen: Counted) -> Iterator[Property]:
    """Claim what the ghosts of later machines stand for: a wire that hears more of them would assume what is to be proved."""
    slot, entry = seen.model.area.own.slots[0], seen.model.entry.own
    yield for_all_inputs(
        "a train is all out when none of its axles is inside",
        seen.area.bool(slot.next_all_out).iff(seen.entry.num(entry.true_axles_inside).eq(0)),
        statement="what is assumed of a train that has left is assumed of one of which no axle is in the area",
        requirements=_CLEAR,
    )
    own, verified = seen.model.report.own, seen.model.verification
    of, report = seen.model.composition.of(verified.machine), seen.model.composition.of(seen.model.report.machine)
    stored = of.num(verified.machine.mode).one_of(*verified.machine.modes[1:3])
    yield for_all_inputs(
        "all axles are counted of a train that had as many as its reference",
        report.bool(own.count_had_all_axles).implies(
            stored & of.num(verified.own.axles).eq(of.num(verified.own.stored_axles))
        ),
        statement="what is assumed of a count is assumed of one with as many axles as the reference that is stored",
        requirements=_CLEAR,
    )


def _axle_between(seen: Counted) -> Property:
    """Claim the same of the entry's ghost."""
    return for_all_inputs(
        "the entry's axle between is an axle between the counters",
        seen.entry.bool(seen.model.entry.own.axle_between).iff(seen.heads.num(seen.model.axle_section.own.axles) > 0),
        statement="what is assumed of an area without an axle is assumed of one in which no axle is between the counters",
        requirements=_CLEAR,
    )
