"""The machine's verdict on a received pattern, and the times at which a pattern is due or overdue."""

from __future__ import annotations

from safeloc.language.expr import Bool, Num, abs_, ite
from safeloc.models.emitter.variables import ELSEWHERE, FOREIGN, NO_PLACE, NOT_DUE, NOTHING, PASSED, Parts


def due(own: Parts) -> Bool:
    """Return the condition that a pattern may come now: at its regular time, or because a request is open."""
    return (own.since_passed + 1 >= own.config.due_cycles - own.config.window_cycles) | (own.since_request > 0)


def late(own: Parts) -> Bool:
    """Return the condition that the regular pattern is late in this cycle."""
    return own.since_passed >= own.config.due_cycles


def overdue(own: Parts) -> Bool:
    """Return the condition that the regular pattern, or the answer to a request, is late in this cycle."""
    return late(own) | (own.since_request >= own.config.answer_cycles)


def near(own: Parts) -> Bool:
    """Return the condition that the reported place is that of this emitter."""
    return abs_(own.place.value - own.config.place_mm) <= own.config.place_tolerance_mm


def verdict(own: Parts) -> Num:
    """Return the verdict on the received pattern."""
    in_place = ite(near(own), ite(due(own), PASSED, NOT_DUE), ELSEWHERE)
    placed = ite(own.place.present, in_place, NO_PLACE)
    return ite(own.pattern.present, ite(own.pattern.value.eq(own.config.pattern), placed, FOREIGN), NOTHING)
