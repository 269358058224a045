"""What the machine makes of a pattern that it heard: its verdict, and when a pattern is due or overdue."""

from __future__ import annotations

from safeloc.language.expr import Bool, Num, abs_, ite
from safeloc.models.emitter.variables import ELSEWHERE, FOREIGN, NO_PLACE, NOT_DUE, NOTHING, PASSED, Parts


def due(own: Parts) -> Bool:
    """A pattern may come now: its regular time, or a request is open."""
    return (own.since + 1 >= own.config.due_cycles - own.config.window_cycles) | (own.asked > 0)


def late(own: Parts) -> Bool:
    """The regular pattern is too late in this cycle."""
    return own.since >= own.config.due_cycles


def overdue(own: Parts) -> Bool:
    """The regular pattern, or the answer to a request, is too late in this cycle."""
    return late(own) | (own.asked >= own.config.answer_cycles)


def near(own: Parts) -> Bool:
    """The place told is that of this emitter."""
    return abs_(own.place.value - own.config.place_mm) <= own.config.place_tolerance_mm


def verdict(own: Parts) -> Num:
    """What becomes of what was heard."""
    in_place = ite(near(own), ite(due(own), PASSED, NOT_DUE), ELSEWHERE)
    placed = ite(own.place.present, in_place, NO_PLACE)
    return ite(own.pattern.present, ite(own.pattern.value.eq(own.config.pattern), placed, FOREIGN), NOTHING)
