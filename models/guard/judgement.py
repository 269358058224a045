"""The verdict on one delivery: the check it fails, and the intervals that the guard stores with it and without it."""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.expr import Bool, Num, as_num, between, exact_to, ite, minimum
from safeloc.language.units import NM, NM_PER_MM, UM_S
from safeloc.models.guard.box import (
    Box,
    Held,
    begun,
    half_nm,
    held,
    known_now,
    moved,
    narrowed,
    near_now,
    of_fix,
    speed_by_distance,
    usable,
)
from safeloc.models.guard.variables import (
    ACROSS,
    AGAINST,
    AMBIGUOUS,
    DOUBTFUL,
    FAULT,
    HALF_TURN_MRAD,
    JUDGED,
    JUMP,
    NO_FAULT,
    NOTHING,
    OFF_TRACK,
    OUT_OF_REACH,
    PASSED,
    QUARTER_TURN_MRAD,
    SPEED_DISAGREES,
    TOO_COARSE,
    Parts,
)


@dataclass(frozen=True, eq=False)
class Judgement:
    """The terms of one step, built once for all transitions.

    coasted    the stored intervals moved on, without the delivery
    with_fix   the stored intervals moved on and narrowed by the fix
    fresh      the intervals of the fix alone, with a new anchor
    verdict    the verdict by all checks, those against the stored intervals included
    alone      the verdict by map and vehicle limits only
    fair       the verdict by map, vehicle limits, course and the last known place
    near       where the vehicle is by now if the last fix near the way is true: from, to; nm
    known      where the vehicle is by now, starting from its last known place: from, to; nm
    """

    own: Parts
    coasted: Held
    with_fix: Held
    fresh: Held
    verdict: Num
    alone: Num
    fair: Num
    near: tuple[Num, Num]
    known: tuple[Num, Num]

    @property
    def agrees(self) -> Bool:
        """The fix passes every check."""
        return self.verdict.eq(PASSED)

    @property
    def begins(self) -> Bool:
        """Map, vehicle limits, course and the last known place do not contradict the fix, so it can begin a row."""
        return self.fair.eq(PASSED)

    @property
    def follows(self) -> Bool:
        """The vehicle can have run from the last fix near the way to this one, whatever the verdict on that one was."""
        fix, (low, high) = of_fix(self.own), self.near
        return (fix.low <= high) & (low <= fix.high)

    @property
    def confirmed(self) -> Bool:
        """With this fix, the row of agreeing fixes is full."""
        return self.own.agreed_fixes + 1 >= self.own.config.confirmations

    @property
    def more(self) -> Num:
        """Number of agreeing fixes in a row with this one, up to the configured number."""
        return minimum(self.own.agreed_fixes + 1, self.own.config.confirmations)

    @property
    def implausible(self) -> Bool:
        """The fix contradicts the map or the vehicle's possible motion, which ends the trust in the receiver."""
        return self.verdict.one_of(OFF_TRACK, JUMP, SPEED_DISAGREES, ACROSS, AGAINST, OUT_OF_REACH)


def judge(own: Parts) -> Judgement:
    """Build the terms of one step."""
    before = held(own)
    ahead = moved(own, before.box)
    with_fix = speed_by_distance(own, narrowed(own, ahead), before.anchor)
    alone, known = _alone(own), known_now(own)
    fair = ite(alone.eq(PASSED), _fair(own, known), alone)
    verdict = _verdict(own, fair, ahead, with_fix.box)
    coasted, fresh = speed_by_distance(own, ahead, before.anchor), begun(of_fix(own))
    return Judgement(own, coasted, with_fix, fresh, verdict, alone, fair, near_now(own), known)


def _alone(own: Parts) -> Num:
    """Return the verdict by fault, map and vehicle limits, in this order; PASSED if none of them contradicts the fix."""
    config = own.config
    fresh = of_fix(own)
    coarse = half_nm(own) > (config.tolerance_mm - 2) * NM_PER_MM
    too_fast = own.speed.present & (_least_speed(own) > config.max_speed_mm_s * 1_000)
    verdict = ite(too_fast, SPEED_DISAGREES, ite(usable(config, fresh), PASSED, TOO_COARSE))
    verdict = ite(own.ambiguous, AMBIGUOUS, ite(coarse, TOO_COARSE, verdict))
    verdict = ite(own.offset > config.offset_limit_mm, OFF_TRACK, verdict)
    return ite(own.fault.ne(NO_FAULT), _of_fault(own), ite(own.fix.present, verdict, NOTHING))


def _of_fault(own: Parts) -> Num:
    """Return the reason that has the fault's name."""
    named: Num = NOTHING
    for fault in FAULT[1:]:
        named = ite(own.fault.eq(fault), next(reason for reason in JUDGED if reason.label == fault.label), named)
    return named


def _fair(own: Parts, known: tuple[Num, Num]) -> Num:
    """Return the verdict on a fix near the way by its course and by the last known place: ACROSS, AGAINST, OUT_OF_REACH or PASSED."""
    fix, (low, high), limit = of_fix(own), known, own.config.course_limit_mrad
    back = own.course.value >= HALF_TURN_MRAD - limit
    along = (own.course.value <= limit) | (back & ~own.forwards_only)
    against = own.forwards_only & (own.course.value > QUARTER_TURN_MRAD)
    rolled = as_num(own.config.rollback_mm * NM_PER_MM, NM)
    reached = (fix.high >= low - rolled) & (fix.low <= high)
    place = ite(reached, PASSED, OUT_OF_REACH)
    return ite(own.course.present & ~along, ite(against, AGAINST, ACROSS), place)


def _verdict(own: Parts, fair: Num, ahead: Box, after: Box) -> Num:
    """Return the verdict by the stored intervals as well: the places and speeds that the vehicle can have now.

    A fix outside the moved interval is DOUBTFUL if its error bound reaches into it: it might be true, but is withheld.
    """
    fix, place = of_fix(own), exact_to(own.fix.value, NM)
    meets = (fix.low <= ahead.high) & (ahead.low <= fix.high)
    too_fast = own.speed.present & ((_least_speed(own) > ahead.fast) & (_least_speed(own) > -ahead.slow))
    disagrees = too_fast | (after.slow > after.fast)
    verdict = ite(between(ahead.low, place, ahead.high), PASSED, DOUBTFUL)
    verdict = ite(disagrees, SPEED_DISAGREES, verdict)
    verdict = ite(own.elsewhere | ~meets, JUMP, ite(fair.eq(OUT_OF_REACH), OUT_OF_REACH, verdict))
    return ite(fair.one_of(PASSED, OUT_OF_REACH), verdict, fair)


def _least_speed(own: Parts) -> Num:
    return exact_to(own.speed.value, UM_S) - own.config.speed_error_mm_s * 1_000
