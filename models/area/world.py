"""The world of a line area: trains and vehicles that were never counted, and the laws of counters and reports.

    trains    run no faster than the top speed, and are on the line
    counters  undisturbed, count every train in and out at its end, into a free slot, and are clear only if no axle is between them
    reports   of a train, if trusted, contain its leading end, and both ends if it is known to be whole
    others    vehicles that were never counted come in only while a counter is disturbed, and no vehicle passes another

A train that came in at the low end, with undisturbed counters ever since, has every such vehicle above it: the world
remembers the end at which each train came in, and forgets it in a disturbance.
"""

from __future__ import annotations

from collections.abc import Sequence

from safeloc.language.expr import Bool, Expr, Num, Var, abs_, all_of, between, with_unit
from safeloc.language.units import UM, UM_PER_MM
from safeloc.language.world import Law, World
from safeloc.models.area import followers_world, inner_world
from safeloc.models.area.laws import came_in, um
from safeloc.models.area.slot import ENTERS_HIGH, ENTERS_LOW, LEAVES_HIGH, LEAVES_LOW, Slot
from safeloc.models.area.variables import Parts

CLEAR_CLAUSE = "clear counters have no axle between them"


def world(own: Parts, kept: Sequence[Slot], counted_out: Sequence[Slot]) -> World:
    """Return the world: trains and uncounted vehicles.

    kept         slots whose reports an earlier machine guarantees
    counted_out  slots for which an earlier machine guarantees that all of the train left
    """
    moves: dict[Var, Expr] = {
        own.loose_there: own.next_loose_there,
        own.loose_rear: own.next_loose_rear,
        own.loose_front: own.next_loose_front,
    }
    for one in own.slots:
        moves |= _train_moves(own, one)
        if own.inner:
            moves |= {one.part_rear: one.next_part_rear, one.part_front: one.next_part_front}
    if own.followers is not None:
        moves |= followers_world.moves(own, own.followers)
    choices = [*(one.next_all_out for one in counted_out), *own.declared.choices]
    return World(own.declared.ghosts, choices, moves, _laws(own, kept, counted_out))


def _train_moves(own: Parts, one: Slot) -> dict[Var, Expr]:
    stays, (low, high) = _stays(own, one), came_in(one)
    return {
        one.there: stays,
        one.true_rear: one.next_rear,
        one.true_front: one.next_front,
        one.from_low: all_of([low, stays, own.healthy]),
        one.from_high: all_of([high, stays, own.healthy]),
    }


def _stays(own: Parts, one: Slot) -> Bool:
    """Return the condition that the train is in the area after the cycle: until undisturbed counters count it out, or no axle is there.

    Where nobody counts it is so until it has reported that it left, or detection was clear, and it is really outside.
    """
    if own.followers is not None:
        return followers_world.stays(own, one)
    return (one.there & ~(own.healthy & one.leaves) & own.axle_between) | one.enters


def moves_clause(one: Slot) -> str:
    """Return the name of the law of this train's motion."""
    return f"train {one.number} moves as one"


def reports_clause(one: Slot) -> str:
    """Return the name of the law of this train's reports."""
    return f"reports of train {one.number} are true"


def _laws(own: Parts, kept: Sequence[Slot], counted_out: Sequence[Slot]) -> dict[str, Law]:
    moves = {moves_clause(one): _movement_law(own, one) for one in own.slots}
    moves |= _inner_laws(own)
    reports = {reports_clause(one): _reports_law(one) for one in own.slots if one not in kept}
    if own.followers is not None:
        line = {"uncounted vehicles stay on the line": _line_law(own)}
        return {**line, **moves, **reports, **followers_world.laws(own, own.followers)}
    counted = {
        f"train {one.number} is counted": _counting_law(own, one, by_axles=one in counted_out) for one in own.slots
    }
    return {
        "uncounted vehicles stay on the line": _line_law(own),
        **moves,
        **counted,
        **reports,
        CLEAR_CLAUSE: _clear_law(own),
        **_loose_laws(own),
    }


def _inner_laws(own: Parts) -> dict[str, Law]:
    """Return the laws of detection inside the area, and of the vehicle of each train that stands for all of them."""
    if not own.inner:
        return {}
    parts = {f"vehicles of train {one.number}": inner_world.part_law(one, one.there | one.enters) for one in own.slots}
    clear = {
        f"inner detection {number} is clear over nobody": inner_world.detection_law(own, number, inner)
        for number, inner in enumerate(own.inner, 1)
    }
    return parts | clear


# ------------------------------------------------------------------ trains


def _on_the_line(own: Parts, *places: Num) -> Bool:
    far = own.config.limit_mm * UM_PER_MM
    return all_of(between(-far, place, far) for place in places)


def _line_law(own: Parts) -> Law:
    return Law(
        _on_the_line(own, own.next_loose_rear, own.next_loose_front),
        "The coordinates of the line do not end before an uncounted vehicle does.",
        ("limit_mm",),
        "[D] 100 km to either side",
        "infrastructure",
        "when the map is made",
    )


def _movement_law(own: Parts, one: Slot) -> Law:
    step, known = own.config.reach.cycle_mm * UM_PER_MM, one.there | one.enters
    rear, front = one.next_rear, one.next_front
    runs = (abs_(front - one.true_front) <= step) & (abs_(rear - one.true_rear) <= step)
    return Law(
        all_of([_on_the_line(own, rear, front), known.implies(rear <= front), one.there.implies(runs)]),
        "A train is on the line, its rear end behind its front end; while it is in the area, both run no faster "
        "than the top speed.",
        ("limit_mm", "max_speed_mm_s", "period_ms"),
        "[D] 160 km/h",
        "operator",
        "speed supervision",
    )


def left_law(own: Parts, one: Slot) -> Bool:
    """Return the condition that a train counted out by undisturbed counters has left completely, at the end that they report."""
    out_low, out_high = one.next_front < um(own.low_end), one.next_rear > um(own.high_end)
    gone = one.there & own.healthy
    return (gone & one.event.eq(LEAVES_LOW)).implies(out_low) & (gone & one.event.eq(LEAVES_HIGH)).implies(out_high)


def _counting_law(own: Parts, one: Slot, *, by_axles: bool) -> Law:
    step = own.config.reach.cycle_mm * UM_PER_MM
    at_low, at_high = one.next_front <= um(own.low_end) + step, one.next_rear >= um(own.high_end) - step
    left = left_law(own, one)
    term = all_of(
        [
            one.enters.implies(~one.there),
            one.event.eq(ENTERS_LOW).implies(at_low),
            one.event.eq(ENTERS_HIGH).implies(at_high),
            one.next_all_out.implies(left) if by_axles else left,
        ]
    )
    enters = "A train that is counted in gets a slot that no train in the area has, and is no farther in than it runs in a cycle; "
    leaves = (
        "one that leaves, with no axle of it or of a part that it lost between undisturbed counters, is beyond "
        "the end that they report."
        if by_axles
        else "one that undisturbed counters count out has left completely, at the end that they report: as many axles "
        "as came in."
    )
    return Law(
        term,
        enters + leaves,
        ("max_speed_mm_s", "period_ms"),
        "[S] ES fibre source, l. 479-546; FVA-2"
        + ("" if by_axles else "; [D] proved of the axles' balance in fibre_area"),
        "supplier",
        "counts at both ends agree whenever the area is empty",
    )


def report_law(one: Slot) -> Bool:
    """Return the condition that a trusted, complete and recent report is true of the ends that it bounds."""
    ran = with_unit(one.age * one.reach.max_speed_mm_s, UM)
    seen = all_of(
        [
            one.there,
            one.trusted,
            one.front.present,
            one.rear.present,
            one.age <= one.reach.report_age_limit_ms,
        ]
    )
    return all_of(
        [
            (seen & one.holds_high).implies(one.next_front <= um(one.front.value) + ran),
            (seen & one.holds_low).implies(one.next_rear >= um(one.rear.value) - ran),
        ]
    )


def _reports_law(one: Slot) -> Law:
    both = "and both ends where the train is known to be whole" if one.integrity_is_trusted else "which it tells truly"
    return Law(
        report_law(one),
        f"A trusted report, complete and recent, contained the train's leading end when it was measured, {both}; "
        "since then the train ran no faster than the top speed.",
        ("max_speed_mm_s", "report_age_limit_ms"),
        "[D] proved of the fibre's machines and their verification, under their own laws",
        "supplier",
        "place and length at every counter that the train passes",
    )


# ------------------------------------------------------------------ vehicles that were never counted


def _clear_law(own: Parts) -> Law:
    return Law(
        (own.healthy & own.clear).implies(~own.axle_between),
        "Undisturbed counters report an empty area only if no axle is between them.",
        source="[S] FVA-4: the sensor is safe; [D] proved of the axle section under its own laws",
        owner="supplier",
        check="safety case of the counters",
    )


def _loose_laws(own: Parts) -> dict[str, Law]:
    """Return the laws of a vehicle that was never counted."""
    there, rear, front = own.next_loose_there, own.next_loose_rear, own.next_loose_front
    step = own.config.reach.cycle_mm * UM_PER_MM
    runs = (abs_(front - own.loose_front) <= step) & (abs_(rear - own.loose_rear) <= step)
    inside = (rear <= front) & (front >= um(own.low_end)) & (rear <= um(own.high_end))
    return {
        "vehicles come in uncounted only in a disturbance": Law(
            there.implies(own.loose_there | ~own.healthy),
            "A vehicle that was never counted was there at the start, or came in while a counter was disturbed.",
            source="[S] FVA-4; [M] every train that comes in is announced, and gets a slot",
            owner="supplier",
            check="safety case of the counters; axles counted in without a train that is announced",
        ),
        "an uncounted vehicle in the area is between the counters": Law(
            there.implies(inside & own.axle_between),
            "A vehicle in the area reaches in between the counters, and has an axle there.",
            source="[D] a vehicle's axle is over a counter before its end reaches into what the area protects",
            owner="infrastructure",
            check="place of the counters against the fouling point, with the longest overhang",
        ),
        "uncounted vehicles keep to the top speed": Law(
            (there & own.loose_there).implies(runs),
            "A vehicle that was never counted runs no faster than the top speed.",
            ("max_speed_mm_s", "period_ms"),
            "[D] line speed",
            "operator",
            "speed supervision",
        ),
        "no uncounted vehicle passes a train": Law(
            all_of((there & own.healthy).implies(_beside(own, one)) for one in own.slots),
            "A vehicle that was never counted stays above a train that came in at the low end, and below one from the high end, for "
            "as long as the counters are undisturbed.",
            source="[D] one track: no vehicle passes another",
            owner="infrastructure",
            check="no switch between the counters",
        ),
    }


def _beside(own: Parts, one: Slot) -> Bool:
    """Return the condition that a loose vehicle stays above a train that came in at the low end, and below one from the high end."""
    rear, front = own.next_loose_rear, own.next_loose_front
    low, high = came_in(one)
    return low.implies(rear >= one.next_front) & high.implies(front <= one.next_rear)
