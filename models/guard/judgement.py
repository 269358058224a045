"""One delivery judged: which gate it fails, and what the guard holds with it and without it."""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.expr import Bool, Expr, Num, Var, between, exact_to, ite, minimum
from safeloc.language.units import NM, NM_PER_MM, UM_S
from safeloc.models.guard.box import Box, Held, begun, half_nm, held, moved, narrowed, near_now, of_fix, told, usable
from safeloc.models.guard.variables import (
    AMBIGUOUS,
    DOUBTFUL,
    FAULT,
    JUDGED,
    JUMP,
    NO_FAULT,
    NOTHING,
    OFF_TRACK,
    PASSED,
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
    near       where the vehicle is by now if the last fix near the way is true: from, to
    """

    own: Parts
    coasted: Held
    with_fix: Held
    fresh: Held
    verdict: Num
    alone: Num
    near: tuple[Num, Num]

    @property
    def agrees(self) -> Bool:
        """It keeps every gate: map, place and speed."""
        return self.verdict.eq(PASSED)

    @property
    def begins(self) -> Bool:
        """By map and vehicle alone it might be true."""
        return self.alone.eq(PASSED)

    @property
    def follows(self) -> Bool:
        """A vehicle can have run from the last fix near the way to this one, whatever became of that one."""
        fix, (low, high) = of_fix(self.own), self.near
        return (fix.low <= high) & (low <= fix.high)

    @property
    def near_after(self) -> dict[Var, Expr]:
        """The updates that hold this fix as the last one near the way, if it is one."""
        own, fix, (low, high) = self.own, of_fix(self.own), self.near
        return {own.near_low: ite(self.begins, fix.low, low), own.near_high: ite(self.begins, fix.high, high)}

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
        return self.verdict.one_of(OFF_TRACK, JUMP, SPEED_DISAGREES)


def judge(own: Parts) -> Judged:
    """The terms of one step."""
    before = held(own)
    ahead = moved(own, before.box)
    with_fix = told(own, narrowed(own, ahead), before.anchor)
    alone = _alone(own)
    verdict = _verdict(own, alone, ahead, with_fix.box)
    return Judged(
        own, told(own, ahead, before.anchor), with_fix, begun(of_fix(own)), verdict, alone, near_now(own)
    )  # fmt: skip


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


def _verdict(own: Parts, alone: Num, ahead: Box, after: Box) -> Num:
    """What speaks against it beside map and vehicle: where the vehicle can be now, and how fast.

    A fix whose charge only just reaches where the vehicle can be might be true, and is withheld all the same.
    """
    fix, place = of_fix(own), exact_to(own.fix.value, NM)
    meets = (fix.low <= ahead.high) & (ahead.low <= fix.high)
    too_fast = own.speed.present & ((_least_speed(own) > ahead.fast) & (_least_speed(own) > -ahead.slow))
    disagrees = too_fast | (after.slow > after.fast)
    judged = ite(between(ahead.low, place, ahead.high), PASSED, DOUBTFUL)
    judged = ite(own.elsewhere | ~meets, JUMP, ite(disagrees, SPEED_DISAGREES, judged))
    return ite(alone.eq(PASSED), judged, alone)


def _least_speed(own: Parts) -> Num:
    return exact_to(own.speed.value, UM_S) - own.config.speed_error_mm_s * 1_000
