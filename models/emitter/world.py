"""The world of a test emitter: the times at which it sends, and other sources of the same pattern.

The emitter's own timer starts with the evaluation, and again with every pattern of its own that comes through. It then stays
silent for a while, unless its pattern is requested. In that time the detector may still receive the pattern: repeated from a
memory, as an echo, or from somebody who recorded it. Such a pattern shows nothing, and no law speaks of it.
"""

from __future__ import annotations

from safeloc.language.expr import Bool, Num, any_of, as_num, between, ite, maximum
from safeloc.language.units import COUNT
from safeloc.language.world import Law, World
from safeloc.models.emitter.variables import Parts


def world(own: Parts) -> World:
    """Return the world: the chain's health, and the times at which the emitter sends."""
    return own.declared.world(
        moves={
            own.works: own.next_works,
            own.silent: ite(_comes_through(own), own.silent.high, maximum(own.silent - 1, 0)),
            own.may_answer: ite(_comes_through(own), as_num(0, COUNT), _asked(own)),
        },
        clauses={"nothing else makes the pattern while the emitter is to send": _pattern_law(own)},
    )


def _pattern_law(own: Parts) -> Law:
    return Law(
        _comes_through(own).implies(own.next_works),
        "A pattern that is reported as this emitter's, from its place, while the emitter is to send, was made by the emitter "
        "and came through the whole chain: pulse, fibre, detector and evaluation.",
        ("pattern", "place_mm", "place_tolerance_mm", "due_cycles", "window_cycles", "answer_cycles"),
        "[S] the test signal is specific to its emitter, so that no other can be taken for it",
        "infrastructure",
        "patterns are allotted once per line; a memory of the evaluation is shorter than due_cycles less "
        "window_cycles (type test) and emptied by a request; own patterns that are not due are counted and "
        "investigated",
    )


def _may_send(own: Parts) -> Bool:
    """Return the condition that the emitter may send in this cycle: its silence is over, or a request is open."""
    return any_of([own.silent.eq(0), own.may_answer > 0])


def _sends_from_its_place(own: Parts) -> Bool:
    """Return the condition that the front end reports this emitter's pattern, from within its error around the emitter's place."""
    config = own.config
    there = between(
        config.place_mm - config.place_tolerance_mm, own.place.value, config.place_mm + config.place_tolerance_mm
    )
    return own.pattern.present & own.pattern.value.eq(config.pattern) & own.place.present & there


def _comes_through(own: Parts) -> Bool:
    return _may_send(own) & _sends_from_its_place(own)


def _asked(own: Parts) -> Num:
    """Return the cycles left for an answer. A request while the emitter sends, or while another one is open, adds nothing."""
    fresh = ite(own.requested, as_num(own.config.answer_cycles, COUNT), 0)
    return ite(own.may_answer <= 1, fresh, own.may_answer - 1)


def lemmas(own: Parts) -> dict[str, Bool]:
    """Return the lemmas: the machine's clocks and those of the emitter run together."""
    since_heard = own.silent.high - own.since_passed
    answers = own.config.answer_cycles + 1 - own.since_request
    return {
        "the machine knows for how long the emitter is silent": own.silent.eq(maximum(since_heard, 0)),
        "the machine knows whether the emitter may answer": own.may_answer.eq(ite(own.since_request > 0, answers, 0)),
    }
