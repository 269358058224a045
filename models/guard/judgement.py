"""One delivery judged: which gate it fails, and what the guard holds with it and without it."""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.expr import Bool, Expr, Num, Var, as_num, between, exact_to, ite, maximum, minimum
from safeloc.language.units import COUNT, NM, NM_PER_MM, UM_S
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
    told,
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
class Judged:
    """The terms of one step, built once and shared by table, law and properties.

    coasted    what is held without the delivery
    with_fix   what is held with it, where it keeps every gate
    fresh      what the fix says by itself, as a beginning
    verdict    of a delivery that is judged against what is held
    alone      of one that is judged by map and vehicle only
    fair       of one that is judged by its course and by the place last known besides
    near       where the vehicle is by now if the last fix near the way is true: from, to
    known      where the vehicle is by now by what was last known of it: from, to
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
        """It keeps every gate: map, place and speed."""
        return self.verdict.eq(PASSED)

    @property
    def begins(self) -> Bool:
        """By map, vehicle, course and the place last known it might be true."""
        return self.fair.eq(PASSED)

    @property
    def follows(self) -> Bool:
        """A vehicle can have run from the last fix near the way to this one, whatever became of that one."""
        fix, (low, high) = of_fix(self.own), self.near
        return (fix.low <= high) & (low <= fix.high)

    @property
    def near_after(self) -> dict[Var, Expr]:
        """The updates that hold this fix as the last one near the way, if it is one."""
        own, fix, (low, high) = self.own, of_fix(self.own), self.near
        heard = self.alone.eq(PASSED)
        return {own.near_low: ite(heard, fix.low, low), own.near_high: ite(heard, fix.high, high)}

    @property
    def known_after(self) -> dict[Var, Expr]:
        """The updates that count fixes in a row, and hold the place of one that fills the row as the place last known."""
        own, fix, (low, high), full = self.own, of_fix(self.own), self.known, self.own.config.confirmations
        ends = (self.alone.eq(PASSED) & ~self.begins) | self.alone.eq(OFF_TRACK)
        longer = ite(self.follows & ~own.elsewhere, minimum(own.fair + 1, full), as_num(1, COUNT))
        row = ite(self.begins, longer, ite(ends, as_num(0, COUNT), own.fair))
        fills = self.begins & row.eq(full)
        return {
            own.fair: row,
            own.known_low: ite(fills, maximum(fix.low, low), low),
            own.known_high: ite(fills, minimum(fix.high, high), high),
        }

    @property
    def confirmed(self) -> Bool:
        """With it, as many fixes in a row agree as are asked for."""
        return self.own.agreed + 1 >= self.own.config.confirmations

    @property
    def more(self) -> Num:
        """Fixes in a row with this one."""
        return minimum(self.own.agreed + 1, self.own.config.confirmations)

    @property
    def implausible(self) -> Bool:
        """It contradicts the map, or what a vehicle can do: the receiver is in doubt."""
        return self.verdict.one_of(OFF_TRACK, JUMP, SPEED_DISAGREES, ACROSS, AGAINST, OUT_OF_REACH)


def judge(own: Parts) -> Judged:
    """The terms of one step."""
    before = held(own)
    ahead = moved(own, before.box)
    with_fix = told(own, narrowed(own, ahead), before.anchor)
    alone, known = _alone(own), known_now(own)
    fair = ite(alone.eq(PASSED), _fair(own, known), alone)
    verdict = _verdict(own, fair, ahead, with_fix.box)
    coasted, fresh = told(own, ahead, before.anchor), begun(of_fix(own))
    return Judged(own, coasted, with_fix, fresh, verdict, alone, fair, near_now(own), known)


def _alone(own: Parts) -> Num:
    """Faults, then the map, then what the vehicle can do at all; PASSED where nothing speaks against it."""
    config = own.config
    fresh = of_fix(own)
    coarse = half_nm(own) > (config.tolerance_mm - 2) * NM_PER_MM
    too_fast = own.speed.present & (_least_speed(own) > config.max_speed_mm_s * 1_000)
    judged = ite(too_fast, SPEED_DISAGREES, ite(usable(config, fresh), PASSED, TOO_COARSE))
    judged = ite(own.ambiguous, AMBIGUOUS, ite(coarse, TOO_COARSE, judged))
    judged = ite(own.offset > config.offset_limit_mm, OFF_TRACK, judged)
    return ite(own.fault.ne(NO_FAULT), _of_fault(own), ite(own.fix.present, judged, NOTHING))


def _of_fault(own: Parts) -> Num:
    """The fault's own name among the reasons."""
    named: Num = NOTHING
    for fault in FAULT[1:]:
        named = ite(own.fault.eq(fault), next(reason for reason in JUDGED if reason.label == fault.label), named)
    return named


def _fair(own: Parts, known: tuple[Num, Num]) -> Num:
    """Return the verdict on a fix near the way by course and reach: it crosses the way, runs against it, or is out of reach."""
    fix, (low, high), limit = of_fix(own), known, own.config.course_limit_mrad
    back = own.course.value >= HALF_TURN_MRAD - limit
    along = (own.course.value <= limit) | (back & ~own.forwards_only)
    against = own.forwards_only & (own.course.value > QUARTER_TURN_MRAD)
    rolled = as_num(own.config.rollback_mm * NM_PER_MM, NM)
    reached = (fix.high >= low - rolled) & (fix.low <= high)
    place = ite(reached, PASSED, OUT_OF_REACH)
    return ite(own.course.present & ~along, ite(against, AGAINST, ACROSS), place)


def _verdict(own: Parts, fair: Num, ahead: Box, after: Box) -> Num:
    """Return the verdict by the held interval as well: the places and speeds that the vehicle can have now.

    A fix whose charge only just reaches where the vehicle can be might be true, and is withheld all the same.
    """
    fix, place = of_fix(own), exact_to(own.fix.value, NM)
    meets = (fix.low <= ahead.high) & (ahead.low <= fix.high)
    too_fast = own.speed.present & ((_least_speed(own) > ahead.fast) & (_least_speed(own) > -ahead.slow))
    disagrees = too_fast | (after.slow > after.fast)
    judged = ite(between(ahead.low, place, ahead.high), PASSED, DOUBTFUL)
    judged = ite(disagrees, SPEED_DISAGREES, judged)
    judged = ite(own.elsewhere | ~meets, JUMP, ite(fair.eq(OUT_OF_REACH), OUT_OF_REACH, judged))
    return ite(fair.one_of(PASSED, OUT_OF_REACH), judged, fair)


def _least_speed(own: Parts) -> Num:
    return exact_to(own.speed.value, UM_S) - own.config.speed_error_mm_s * 1_000
