"""Lemmas for the proofs of the entry record: its bounds contain the truth, in the direction in which the train came."""

from __future__ import annotations

from safeloc.language.expr import Bool, Lit, Num, NumVar, between, exact_to, ite
from safeloc.language.units import NM, UM_S
from safeloc.models.axle_counter.passage import SOUND, Parts
from safeloc.models.axle_head import NO_AXLE, UP


def lemmas(own: Parts, current: NumVar, table: tuple[Lit, ...]) -> dict[str, Bool]:
    """Return the lemmas: while a passage is followed and no axle was missed, and in the cycle of its record."""
    spoilt, idle, passing, done = table
    recorded = current.eq(done) & own.flaw.eq(SOUND)
    followed = (current.eq(passing) | recorded) & ~own.missed
    run = between(exact_to(own.run_low, NM), _ahead(own, own.run), exact_to(own.run_high, NM))
    length = between(exact_to(own.length_low, NM), _ahead(own, own.length), exact_to(own.length_high, NM))
    speed = between(exact_to(own.speed_low, UM_S), _ahead(own, own.speed), exact_to(own.speed_high, UM_S))
    return {
        "the run is within its bounds": followed.implies(run),
        "the length is within its bounds": followed.implies(length),
        "the speed is within its bounds": followed.implies(speed),
        "the run since the last axle is within its bound": followed.implies(
            (_ahead(own, own.run - own.length) >= exact_to(own.past_low, NM)) | _too_slow_to_pass(own)
        ),
        "the count is true": followed.implies(own.axles_counted.eq(own.axles)),
        "no axle is missed in a record": recorded.implies(~own.missed),
        "a spoilt passage has a flaw": current.eq(spoilt).implies(own.flaw.ne(SOUND)),
        "a train has a direction": current.eq(passing).implies(own.direction.ne(NO_AXLE) & (own.axles_counted > 0)),
        "between passages the next axle begins one": current.one_of(idle, done).implies(own.away | own.missed),
        "the last axle came as the first one": (current.eq(passing) & ~own.missed).implies(
            own.last_axle_upwards.iff(own.direction.eq(UP))
        ),
        "the pause is counted": (current.eq(passing) & (own.pause < own.pause.high) & ~own.missed).implies(
            own.pause.eq(own.true_pause)
        ),
    }


def _too_slow_to_pass(own: Parts) -> Bool:
    """Return the condition that the bound of the run since the last axle cannot grow before the next axle.

    If a passage is reported as over while its train runs on, the next axle counts as a first one. A slow train may have turned in that
    cycle, as no first one does, and be a few centimetres short of the bound; but by that bound it never passes.
    """
    return (own.past_low <= 0) & (own.speed_low <= own.config.change_mm_s)


def _ahead(own: Parts, along: Num) -> Num:
    """Return an upward distance as a distance in the direction in which the train came."""
    return ite(own.direction.eq(UP), along, -along)
