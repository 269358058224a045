"""The transition table of the stop-point machine, in order of priority."""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.language.expr import TRUE, Lit, ite
from safeloc.language.machine import Transition
from safeloc.language.rows import Updates, together
from safeloc.models.stop_point.cycle import Judgement
from safeloc.models.stop_point.variables import (
    NO_POSITION,
    NO_REASON,
    NOT_AHEAD,
    TOO_COARSE,
    TOO_FAR,
    UNKNOWN_STOP,
    Parts,
)

REQUIREMENTS = ("RFL-D7",)


def rows(own: Parts, cycle: Judgement, table: tuple[Lit, ...]) -> Iterator[Transition]:
    """Yield all transitions."""
    yield from _ending(own, table)
    yield from _selecting(own, cycle, table)
    yield from _approaching(own, cycle, table)
    yield from _standing(own, cycle, table)
    yield from _moving(own, cycle, table)
    yield from _waiting(own, cycle, table)


def _ending(own: Parts, table: tuple[Lit, ...]) -> Iterator[Transition]:
    """Yield the rows that end a stop, and of a lost position."""
    idle, approach, braking, stopped, short, creeping, overrun, repositioning, held = table
    pending = (approach, braking, stopped, short, creeping, overrun, repositioning)
    over = together(_no_stop(own), {own.served_number: own.pending_number, own.reason: NO_REASON})
    yield Transition("released", (short, overrun, held), idle, own.released, over, REQUIREMENTS, 0)
    yield Transition("departs", stopped, idle, own.departure & own.valid, over, REQUIREMENTS, 0)
    lost: Updates = {own.reason: NO_POSITION, own.to_go: 0}
    yield Transition("position lost", pending, held, ~own.valid, lost, REQUIREMENTS, 1)


def _selecting(own: Parts, cycle: Judgement, table: tuple[Lit, ...]) -> Iterator[Transition]:
    """Yield the rows of the selection of a stop point; the mission may change it until the brake order."""
    idle, approach, *_ = table
    chosen: Updates = {
        own.stop: cycle.chosen.stop,
        own.before: cycle.chosen.before,
        own.after: cycle.chosen.after,
        own.pending_number: own.selected_stop.value,
        own.served_number: 0,
        own.to_go: cycle.chosen.stop - own.position,
        own.reason: NO_REASON,
    }
    yield Transition("stop selected", idle, approach, cycle.selectable, chosen, REQUIREMENTS, 2)
    yield Transition("another stop selected", approach, approach, cycle.changed, chosen, REQUIREMENTS, 2)
    dropped = together(_no_stop(own), {own.served_number: 0, own.reason: NO_REASON})
    yield Transition("no stop selected", (idle, approach), idle, ~cycle.named, dropped, REQUIREMENTS, 2)
    refused: Updates = {own.reason: UNKNOWN_STOP}
    yield Transition("stop not on the map", idle, idle, ~cycle.known, refused, REQUIREMENTS, 3)
    behind: Updates = {own.reason: NOT_AHEAD}
    missed = own.valid & (cycle.high > cycle.chosen.ends) & own.selected_stop.value.ne(own.served_number)
    yield Transition("stop not ahead", idle, idle, missed, behind, REQUIREMENTS, 4)


def _approaching(own: Parts, cycle: Judgement, table: tuple[Lit, ...]) -> Iterator[Transition]:
    """Yield the rows up to the brake order, and of an overrun."""
    _, approach, braking, stopped, short, creeping, overrun, *_ = table
    near = together(_to_go(cycle), _fit(cycle))
    ahead, measured_beyond = (approach, braking, creeping), own.precise & cycle.beyond
    yield Transition("overruns", ahead, overrun, measured_beyond, near, REQUIREMENTS, 4)
    yield Transition("brakes", approach, braking, cycle.brake_now | ~cycle.short, near, REQUIREMENTS, 5)
    yield Transition("proceeds", approach, approach, TRUE, near, REQUIREMENTS, 6)
    measured = cycle.standing & own.precise
    yield Transition("stops in place", braking, stopped, measured & cycle.inside, near, REQUIREMENTS, 5)
    yield Transition("stops short", braking, short, measured & cycle.short, near, REQUIREMENTS, 5)
    yield Transition("brakes on", braking, braking, TRUE, near, REQUIREMENTS, 6)


def _standing(own: Parts, cycle: Judgement, table: tuple[Lit, ...]) -> Iterator[Transition]:
    """Yield the rows of a vehicle that stands in the window, before it or beyond it."""
    _, _, braking, stopped, short, _, overrun, _, held = table
    near, measured = together(_to_go(cycle), _fit(cycle)), cycle.standing & own.precise
    yield Transition("rolls away", stopped, braking, ~cycle.standing, near, REQUIREMENTS, 5)
    yield Transition("found in place", (short, overrun), stopped, measured & cycle.inside, near, REQUIREMENTS, 5)
    yield Transition(
        "found short", (stopped, overrun), short, measured & cycle.short & ~cycle.beyond, near, REQUIREMENTS, 5
    )
    far = together(_to_go(cycle), {own.reason: TOO_FAR})
    yield Transition("too far to reposition", overrun, held, measured & cycle.too_far, far, REQUIREMENTS, 5)
    yield Transition("not beyond after all", overrun, braking, own.precise & ~cycle.beyond, near, REQUIREMENTS, 7)
    yield Transition(
        "found beyond", (stopped, short), overrun, measured & cycle.beyond & ~cycle.short, near, REQUIREMENTS, 7
    )


def _moving(own: Parts, cycle: Judgement, table: tuple[Lit, ...]) -> Iterator[Transition]:
    """Yield the rows of creeping forward into the window, and of repositioning backwards into it."""
    _, _, braking, _, short, creeping, overrun, repositioning, _ = table
    near, may = together(_to_go(cycle), _fit(cycle)), cycle.standing & own.precise & own.permitted
    yield Transition("creeps forward", short, creeping, may & cycle.short & ~cycle.beyond, near, REQUIREMENTS, 8)
    yield Transition("repositions", overrun, repositioning, may & cycle.beyond & ~cycle.short, near, REQUIREMENTS, 8)
    unsafe = ~own.precise | ~own.permitted
    again = own.valid & own.precise & cycle.standing & own.reason.eq(NO_POSITION)
    yield Transition("stops creeping", creeping, braking, unsafe | cycle.forwards_too_fast, near, REQUIREMENTS, 8)
    yield Transition(
        "stops reversing", repositioning, overrun, unsafe | cycle.backwards_too_fast, near, REQUIREMENTS, 8
    )
    yield Transition(
        "creeps into the window", creeping, braking, ~cycle.short | (cycle.to_go <= 0), near, REQUIREMENTS, 9
    )
    yield Transition(
        "backs into the window", repositioning, braking, ~cycle.beyond | cycle.short, near, REQUIREMENTS, 9
    )
    yield Transition("measured again", table[8], braking, again, near, REQUIREMENTS, 9)


def _waiting(own: Parts, cycle: Judgement, table: tuple[Lit, ...]) -> Iterator[Transition]:
    """Yield the rows in which the order stays."""
    _, _, _, stopped, short, creeping, overrun, repositioning, held = table
    near = together(_to_go(cycle), _fit(cycle))
    yield Transition("stands in place", stopped, stopped, TRUE, near, REQUIREMENTS, 10)
    yield Transition("stands short", short, short, TRUE, near, REQUIREMENTS, 10)
    yield Transition("creeps on", creeping, creeping, TRUE, near, REQUIREMENTS, 10)
    yield Transition("stands beyond", overrun, overrun, TRUE, near, REQUIREMENTS, 10)
    yield Transition("reverses on", repositioning, repositioning, TRUE, near, REQUIREMENTS, 10)
    yield Transition("held", held, held, TRUE, {own.to_go: 0}, REQUIREMENTS, 10)


# ------------------------------------------------------------------ groups of updates


def _to_go(cycle: Judgement) -> Updates:
    """Return the update of the shown distance."""
    return {cycle.own.to_go: cycle.pending.stop - cycle.own.position}


def _fit(cycle: Judgement) -> Updates:
    """Return the update of the reason: is the interval too coarse for the window?"""
    return {cycle.own.reason: ite(cycle.short & cycle.beyond, TOO_COARSE, NO_REASON)}


def _no_stop(own: Parts) -> Updates:
    """Return the updates after which no stop is pending: place, window, distance and number are 0."""
    return {own.stop: 0, own.before: 0, own.after: 0, own.to_go: 0, own.pending_number: 0}
