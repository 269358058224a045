"""A line area between axle counters: its trains, the interval of each, and the stretch in which uncounted vehicles may be.

Axle counters at both ends of the area count trains in and out (ES fibre source, l. 479-546; FVA-2). In between, verified
reports of the fibre system follow each train. Vehicles that are in the area without having been counted (at the start, or
after a disturbance of a counter) are called loose. They may be anywhere until they are pushed out: no vehicle passes
another, so a train that came in at the low end has every loose vehicle above it.

    UNSWEPT   loose vehicles may be in [loose_low, loose_high]
    SWEPT     every vehicle in the area was counted in

Where borders report occupancy alone, vehicles may come in uncounted as well (safeloc.models.area.followers). Detection inside the area
shows where nobody is (safeloc.models.area.inner).

Positions are mm along the line, from the low end to the high end.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

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
    ite,
    maximum,
    minimum,
)
from safeloc.language.machine import Machine, Model, Transition, current_mode
from safeloc.language.nodes import Value
from safeloc.language.rows import Updates, together
from safeloc.language.units import COUNT, MM
from safeloc.models.area.inner import lowered, raised
from safeloc.models.area.laws import um
from safeloc.models.area.lemmas import ends_in_order, lemmas
from safeloc.models.area.slot import ACCEPTED, ENTERS_HIGH, ENTERS_LOW, LEAVES_HIGH, LEAVES_LOW, Slot
from safeloc.models.area.variables import AreaConfig, Parts, parts, refuse_inner_detection
from safeloc.models.area.world import left_law, moves_clause, report_law, reports_clause, world

__all__ = [
    "Area",
    "AreaConfig",
    "Parts",
    "build",
    "left_law",
    "machine",
    "moves_clause",
    "parts",
    "refuse_inner_detection",
    "report_law",
    "reports_clause",
    "um",
]
REQUIREMENTS = ("FVA-9",)


Area = Model[Parts]


def machine(config: AreaConfig | None = None) -> Machine:
    """Return the area machine (FVA-2, FVA-9)."""
    return build(parts(config or AreaConfig())).machine


def build(own: Parts, *, kept: Sequence[Slot] = (), counted_out: Sequence[Slot] = ()) -> Area:
    """Return the machine over the given variables.

    kept         slots whose reports an earlier machine guarantees, so they are not assumed
    counted_out  slots whose axles an earlier machine counts: it guarantees that all of the train left, so that is not assumed
    """
    table = own.modes
    current = current_mode(table)
    made = own.declared.machine(
        name="area",
        modes=table,
        outputs=_outputs(own, current, table),
        transitions=list(_table(own, table)),
        world=world(own, kept, counted_out),
        lemmas=lemmas(own, current, table),
        initially=ends_in_order(own),
        doc=_doc(own),
    )
    return Area(made, own)


def _doc(own: Parts) -> str:
    """Return what the machine follows and what is assumed."""
    counted = (
        "Trains between two axle counters, and vehicles that were never counted. Assumed: undisturbed "
        "counters count every vehicle that comes in and give it a free slot; a train that they count out has "
        "left completely, and an area that they report clear is empty; "
    )
    detected = (
        "Trains between two borders that report occupancy alone, and vehicles that nobody reports. Assumed: undisturbed "
        "detection is clear over nobody, and nobody comes in past a side that is clear; trains report when they come in, "
        "at the latest when entry_report_delay_ms ends, and get a free slot; "
    )
    inner = "detection inside the area is clear over nobody; " if own.inner else ""
    return (
        (counted if own.followers is None else detected) + inner + "a trusted report contains the leading "
        "end of the train, and both ends if the train is known to be whole and reports of that are trusted; "
        "nothing exceeds the top speed; no vehicle passes another."
    )


# ------------------------------------------------------------------ conditions of a cycle


def _leaves(own: Parts, one: Slot) -> Bool:
    """Return the condition that the train has left completely: undisturbed counters counted it out, and its interval allows it."""
    low, high = one.run_on
    at_low = one.event.eq(LEAVES_LOW) & (low <= own.low_end)
    at_high = one.event.eq(LEAVES_HIGH) & (high >= own.high_end)
    return own.healthy & one.present & (at_low | at_high)


def _gone(own: Parts, one: Slot) -> Bool:
    """Return the condition that the train is in the area no more: counted out, or, if nobody counts, surely beyond the end that it reports.

    Where nobody counts, detection that is clear shows it as well, but of a train that comes in now.
    """
    if own.followers is None:
        return _leaves(own, one)
    first, last = one.bounds(own.low_end, own.high_end)
    at_low = one.event.eq(LEAVES_LOW) & (last < own.low_end)
    at_high = one.event.eq(LEAVES_HIGH) & (first > own.high_end)
    return own.healthy & one.present & (at_low | at_high | (own.clear & ~one.enters))


def _empty(own: Parts) -> Bool:
    """Return the positive evidence of an empty area: clear counters, no train coming in, no report accepted.

    Train detection that is clear needs no more: a train that comes in now is not yet there.
    """
    if own.followers is not None:
        return own.healthy & own.clear
    seen = any_of(one.enters | one.accepted for one in own.slots)
    return own.healthy & own.clear & ~seen


def _uncounted(own: Parts) -> Bool:
    """Return the condition that vehicles may have come in uncounted: counters disturbed, or a train counted into a taken slot."""
    return ~own.healthy | any_of(one.enters & one.present for one in own.slots)


def _swept(own: Parts) -> tuple[Num, Num]:
    """Return the bounds of loose vehicles after the cycle: they run, but pass no train that has them on one side."""
    cycle, limit = own.config.reach.cycle_mm, own.config.limit_mm
    low, high = maximum(own.loose_low - cycle, -limit), minimum(own.loose_high + cycle, limit)
    low, high = raised(low, own.inner), lowered(high, own.inner)
    if own.followers is not None:
        low, high = own.followers.loose_bounds(own.slots, (own.low_end, own.high_end), own.unswept, (low, high))
    for one in own.slots:
        first, last = one.bounds(own.low_end, own.high_end)
        gone = _gone(own, one)
        pushed_up = ite(gone & one.event.eq(LEAVES_HIGH), as_num(limit, MM), ite(gone, low, first))
        pushed_down = ite(gone & one.event.eq(LEAVES_LOW), as_num(-limit, MM), ite(gone, high, last))
        has_below, has_above = _has_beside(own, one)
        low = ite(has_below, maximum(low, pushed_up), low)
        high = ite(has_above, minimum(high, pushed_down), high)
    return low, high


def _has_beside(own: Parts, one: Slot) -> tuple[Bool, Bool]:
    """Return the conditions that all loose vehicles are above the train, and that all are below it."""
    if own.followers is not None:
        return own.followers.beside(one, own.slots, own.unswept)
    has_below = (one.present & one.below_loose) | (~one.present & one.event.eq(ENTERS_LOW))
    has_above = (one.present & one.above_loose) | (~one.present & one.event.eq(ENTERS_HIGH))
    return has_below, has_above


# ------------------------------------------------------------------ the transition table


def _table(own: Parts, table: tuple[Lit, ...]) -> Iterator[Transition]:
    unswept, swept = table
    low, high = _swept(own)
    none_left = (low > own.high_end) | (high < own.low_end) | (low > high)
    limit, verdicts = own.config.limit_mm, _verdicts(own)
    anywhere: Updates = {own.loose_low: -limit, own.loose_high: limit}
    apart: Updates = {own.loose_low: low, own.loose_high: high}
    trains = together(verdicts, _trains(own), _rejected(own), _followers(own))
    followed = together(trains, _order(own))
    yield Transition(
        "something came in uncounted", table, unswept, _uncounted(own),
        together(trains, _no_order(own), anywhere), REQUIREMENTS, 0)  # fmt: skip
    yield Transition(
        "counters are clear", table, swept, _empty(own), together(_cleared(own), anywhere), REQUIREMENTS, 1
    )
    yield Transition(
        "everything loose is pushed out", unswept, swept, none_left, together(followed, anywhere), REQUIREMENTS, 2)  # fmt: skip
    yield Transition(
        "follow trains, loose vehicles apart", unswept, unswept, TRUE, together(followed, apart), REQUIREMENTS, 3)  # fmt: skip
    if own.followers is not None:
        yield Transition(
            "a train came in after followers", swept, unswept, ~none_left, together(followed, apart), REQUIREMENTS, 2)  # fmt: skip
    yield Transition("follow trains", swept, swept, TRUE, together(followed, anywhere), REQUIREMENTS, 3)


# ------------------------------------------------------------------ groups of updates


def _verdicts(own: Parts) -> Updates:
    return {one.last_verdict: one.verdict for one in own.slots}


def _cleared(own: Parts) -> Updates:
    """Clear every slot, and what is known of the order; where nobody counts, a train that comes in now stays."""
    verdicts = _verdicts(own)
    if own.followers is None:
        return together(verdicts, _no_trains(own), _no_order(own), {own.rejected_events: 0})
    return together(verdicts, _trains(own), _rejected(own), _followers(own), _order(own))


def _followers(own: Parts) -> Updates:
    """Set how far in followers can be: nowhere while detection is clear; in a disturbance every one of them is loose."""
    if own.followers is None:
        return {}
    ends, followers, slots = (own.low_end, own.high_end), own.followers, own.slots
    kept = own.healthy & ~own.clear
    return {
        side.bound: ite(kept, side.after(slots, followers.trains(side, slots, ends)), side.none)
        for side in followers.sides
    }


def _trains(own: Parts) -> Updates:
    """Set presence, interval and waiting times of every train."""
    return together(*(_train(own, one) for one in own.slots))


def _train(own: Parts, one: Slot) -> Updates:
    present, (low, high) = _present_after(own, one), one.bounds(own.low_end, own.high_end)
    taken = one.enters & one.present  # two trains in one slot: it covers both, wherever they are
    far, limit, none = own.config.limit_mm, own.config.count_limit, as_num(0, COUNT)
    silent = ite(one.accepted | one.enters, none, minimum(one.silent + 1, limit))
    unconfirmed = ite(one.confirmed | one.enters, none, minimum(one.unconfirmed + 1, limit))
    return {
        one.present: present,
        one.low: ite(present, ite(taken, as_num(-far, MM), low), 0),
        one.high: ite(present, ite(taken, as_num(far, MM), high), 0),
        one.silent: ite(present, silent, none),
        one.unconfirmed: ite(present, unconfirmed, none),
    }


def _no_trains(own: Parts) -> Updates:
    """Clear every slot."""
    numbers = [var for one in own.slots for var in (one.low, one.high, one.silent, one.unconfirmed)]
    return together({one.present: FALSE for one in own.slots}, dict.fromkeys(numbers, 0))


def _order(own: Parts) -> Updates:
    """Set which trains have all loose vehicles on one side: those that came in at that end."""
    updates: dict[Var, Expr | Value] = {}
    for one in own.slots:
        present = _present_after(own, one)
        below, above = _stays_beside(own, one)
        updates[one.below_loose] = present & below
        updates[one.above_loose] = present & above
        if own.followers is not None:
            updates[own.followers.ordered[one.number - 1]] = present & own.followers.stays_ordered(one)
    return updates


def _stays_beside(own: Parts, one: Slot) -> tuple[Bool, Bool]:
    """Return the same as `_has_beside` for a train that stays in the area."""
    if own.followers is not None:
        return _has_beside(own, one)
    below = ite(one.enters, one.event.eq(ENTERS_LOW), one.below_loose)
    above = ite(one.enters, one.event.eq(ENTERS_HIGH), one.above_loose)
    return below, above


def _no_order(own: Parts) -> Updates:
    """Allow loose vehicles on either side of any train."""
    ordered = () if own.followers is None else own.followers.ordered
    return dict.fromkeys((*(side for one in own.slots for side in (one.below_loose, one.above_loose)), *ordered), FALSE)


def _rejected(own: Parts) -> Updates:
    """Count the impossible events of this cycle: a train leaves where it is not, or enters a taken slot."""
    rejected = as_num(0, COUNT)
    for one in own.slots:
        strange = (one.leaves & ~_gone(own, one)) | (one.enters & one.present)
        rejected = rejected + ite(strange, as_num(1, COUNT), 0)
    return {own.rejected_events: rejected}


def _present_after(own: Parts, one: Slot) -> Bool:
    return (one.present & ~_gone(own, one)) | one.enters


# ------------------------------------------------------------------ outputs


def _outputs(own: Parts, current: Num, table: tuple[Lit, ...]) -> dict[str, Expr]:
    outputs: dict[str, Expr] = {"swept": current.eq(table[1]), "events_rejected": own.rejected_events}
    for one in own.slots:
        name = f"train_{one.number}"
        outputs |= {f"{name}_in_area": one.present, f"{name}_accepted": one.last_verdict.eq(ACCEPTED)}
    return outputs
