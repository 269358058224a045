"""The world of the guard: the vehicle's motion, the host's choice of an origin, and the receiver's errors.

    the vehicle   moves within its configured speed, acceleration and brake
    the host      may count places from another origin while the guard stores no interval
    the receiver  may report anything in a row shorter than `confirmations`. A row consists of fixes near the way, each on a
                  course along the way in a permitted direction, each reachable from the one before, and each reachable from
                  the vehicle's place when such a row was last full. The fix that fills a row, and every further one in it, is
                  wrong by no more than its error bound

Nothing is assumed of a fix in a shorter row, of one that runs across or against the way, of one at a place that the vehicle
cannot have reached since a row was last full, nor of quality flags. The error of a fix and the distance that a vehicle can run
are computed here independently: the machine's terms are not used.
"""

from __future__ import annotations

from safeloc.language.expr import (
    Bool,
    Expr,
    Lit,
    Num,
    Var,
    abs_,
    all_of,
    as_num,
    between,
    exact_to,
    ite,
    maximum,
    minimum,
    with_unit,
)
from safeloc.language.units import COUNT, MM, MS, NM, NM_PER_MM, UM, UM_PER_MM, UM_S
from safeloc.language.world import Law
from safeloc.models.guard.variables import FAULT, HALF_TURN_MRAD, NO_FAULT, GuardConfig, Parts

_FAR_OFF = next(fault for fault in FAULT if fault.label == "OFF_TRACK")


def clauses(own: Parts, holding: Bool) -> dict[str, Law]:
    """Return the laws: the vehicle's motion, and the receiver's place and speed once a row is full."""
    long_enough = _promised(own)
    return {
        "the vehicle moves within its figures": Law(
            (holding & ~own.start_anew).implies(_motion(own)),
            "The vehicle changes its speed by no more than acceleration and brake allow, and the way follows from the speed. The "
            "host counts places along the way from another origin only with a new start, or while the guard reports that it holds none.",
            ("acceleration_mm_s2", "brake_mm_s2", "max_speed_mm_s", "period_ms"),
            "[D] acceleration of passenger trains; [M] the strongest brake",
            "operator",
            "the rates of the vehicle class, emergency brake included, against the recorded speed",
        ),
        "a long row of fixes is true": Law(
            long_enough.implies(_place_true(own)),
            "Fixes near the way that each follow from the one before, as a vehicle can run at its highest speed, with courses along "
            "the way in a permitted direction, and where the vehicle can have come since such a row was last full, are not false "
            "for long: the one that makes the row as long as asked for, and every further one, is wrong by no more than its "
            "error, its distance off the track, and the run in its age at the highest speed allow.",
            (
                "fix_error_mm", "offset_charge_permille", "offset_limit_mm", "max_speed_mm_s", "tolerance_mm", "confirmations",
                "course_limit_mrad", "rollback_mm",
            ),
            "[M] errors of a receiver along the track",
            "supplier",
            "the receiver's fixes against marks of known place",
        ),
        "a long row of fixes has true speeds": Law(
            (long_enough & own.speed.present).implies(_speed_true(own)),
            "The speed that comes with such a fix is wrong by no more than the receiver's speed error.",
            ("speed_error_mm_s", "confirmations"),
            "[M] Doppler speed of a receiver",
            "supplier",
            "the receiver's speed against wheel and radar",
        ),
    }  # fmt: skip


def moves(own: Parts, holding: Bool) -> dict[Var, Expr]:
    """Return the moves of the ghosts. `run` is the distance since the machine's anchor; it is 0 while no interval is stored."""
    ran = own.run + own.next_truth - own.truth
    anchored = own.advance & (own.anchor_steps + 1).eq(own.config.speed_window_ms // own.config.period_ms)
    return {
        own.truth: own.next_truth,
        own.true_speed: own.next_speed,
        own.run: ite(holding & ~anchored & ~own.start_anew, ran, as_num(0, NM)),
        **{
            ghost: ite(own.start_anew, value, after)
            for (ghost, after), value in zip(_recorded(own).items(), _nothing_recorded(own), strict=True)
        },
    }


def _recorded(own: Parts) -> dict[Var, Num]:
    """Return the next values of the ghosts that record the receiver's fixes."""
    (low, high), (surely, at_most) = _reach(own), _sure_reach(own)
    place, error, promised = _place(own), _error(own), _promised(own)
    return {
        own.last_fix_low: ite(near(own), place - error, low),
        own.last_fix_high: ite(near(own), place + error, high),
        own.row_fixes: _row_after(own),
        own.sure_low: ite(promised, maximum(surely, place - error), surely),
        own.sure_high: ite(promised, minimum(at_most, place + error), at_most),
    }


def _nothing_recorded(own: Parts) -> tuple[Num, ...]:
    """Return their values after a new start, in the same order: as if no fix had come yet."""
    low, high = as_num(own.last_fix_low.low, NM), as_num(own.last_fix_low.high, NM)
    return low, high, as_num(0, COUNT), low, high


# ------------------------------------------------------------------ the receiver


def near(own: Parts) -> Bool:
    """Return whether a fix comes that lies near the way, clearly on one track, with a speed that the vehicle can have."""
    config = own.config
    possible = own.speed.value <= config.max_speed_mm_s + config.speed_error_mm_s
    return all_of(
        [
            own.fix.present,
            own.fault.eq(NO_FAULT),
            own.offset <= config.offset_limit_mm,
            ~own.ambiguous,
            _error(own) <= exact_to(Lit(config.tolerance_mm - 2, MM), NM),
            own.speed.present.implies(possible),
        ]
    )


def _place(own: Parts) -> Num:
    return exact_to(own.fix.value, NM)


def _error(own: Parts) -> Num:
    """Return the error bound of a fix, nm: its own error, a share of its distance off the track, and its age times the highest speed."""
    config = own.config
    beside = with_unit(own.offset * config.offset_charge_permille, UM)
    aged = with_unit(own.age * config.max_speed_mm_s, UM)
    return exact_to(beside + aged + config.fix_error_mm * UM_PER_MM, NM)


def _reach(own: Parts) -> tuple[Num, Num]:
    """Return the places that the vehicle can have reached by now if the last fix near the way was true: from, to; nm."""
    fastest = with_unit(Lit(own.config.period_ms, MS) * own.config.max_speed_mm_s, UM)
    ran = exact_to(fastest, NM) + _bend_nm(own.config)
    return (
        ite(own.advance, maximum(own.last_fix_low - ran, own.last_fix_low.low), own.last_fix_low),
        ite(own.advance, minimum(own.last_fix_high + ran, own.last_fix_high.high), own.last_fix_high),
    )


def _along(own: Parts) -> Bool:
    """Return whether the fix has no course, or one along the way: forwards, or backwards where that is permitted."""
    off, limit = own.course.value, own.config.course_limit_mrad
    backwards = ~own.forwards_only & (HALF_TURN_MRAD - off <= limit)
    return own.course.present.implies((off <= limit) | backwards)


def _sure_reach(own: Parts) -> tuple[Num, Num]:
    """Return the places that the vehicle can have reached since a row was last full, backwards only where permitted: from, to; nm."""
    ran = exact_to(with_unit(Lit(own.config.period_ms, MS) * own.config.max_speed_mm_s, UM), NM) + _bend_nm(own.config)
    least = ite(own.forwards_only, own.sure_low, maximum(own.sure_low - ran, own.sure_low.low))
    most = minimum(own.sure_high + ran, own.sure_high.high)
    return ite(own.advance, least, own.sure_low), ite(own.advance, most, own.sure_high)


def _come(own: Parts) -> Bool:
    """Return whether the vehicle can have reached the fix, within its error, since a row was last full, or by rolling back."""
    (low, high), place, error = _sure_reach(own), _place(own), _error(own)
    back = as_num(own.config.rollback_mm * NM_PER_MM, NM)
    return (place + error + back >= low) & (place - error <= high)


def _fair(own: Parts) -> Bool:
    """Return whether the fix is fair: near the way, along it, and within the vehicle's reach."""
    return near(own) & _along(own) & _come(own)


def _promised(own: Parts) -> Bool:
    """Return whether the law bounds the error of this fix: it completes a row, or continues a full one."""
    return _fair(own) & (_row_after(own) >= own.config.confirmations) & ~own.start_anew


def _row_after(own: Parts) -> Num:
    """Return the number of fair fixes in a row after the step.

    A fix off the track, across or against the way, or out of reach ends the row. A fair fix that does not follow from the one
    before, or to which no way leads, begins a new one.
    """
    (low, high), place, error = _reach(own), _place(own), _error(own)
    follows = ~own.elsewhere & (place + error >= low) & (place - error <= high)
    longer = minimum(own.row_fixes + 1, own.config.confirmations)
    beside = own.fix.present & own.fault.eq(NO_FAULT) & (own.offset > own.config.offset_limit_mm)
    off_track = beside | own.fault.eq(_FAR_OFF)
    kept = ite(off_track | near(own), as_num(0, COUNT), own.row_fixes)
    return ite(_fair(own), ite(follows, longer, as_num(1, COUNT)), kept)


def _place_true(own: Parts) -> Bool:
    off = own.next_truth - _place(own)
    return (off <= _error(own)) & (-off <= _error(own))


def _speed_true(own: Parts) -> Bool:
    wrong = abs_(own.next_speed) - exact_to(own.speed.value, UM_S)
    return abs_(wrong) <= own.config.speed_error_mm_s * UM_PER_MM


# ------------------------------------------------------------------ the vehicle


def _motion(own: Parts) -> Bool:
    """Return whether the vehicle changes its speed within its rates and runs as its speed says; without `advance` neither place nor speed changes."""
    config = own.config
    gain, change = (rate * config.period_ms for rate in (config.acceleration_mm_s2, _strongest(config)))
    ran, sped = own.next_truth - own.truth, own.next_speed - own.true_speed
    off = ran - exact_to(own.true_speed * Lit(config.period_ms, MS), NM)
    bend = _bend_nm(config)
    moves = all_of(
        [
            between(-bend, off, bend),
            sped <= ite(own.true_speed >= 0, as_num(gain, UM_S), change),
            -sped <= ite(own.true_speed <= 0, as_num(gain, UM_S), change),
        ]
    )
    return ite(own.advance, moves, ran.eq(0) & sped.eq(0))


def _strongest(config: GuardConfig) -> int:
    """Return the greater rate of traction and brake, mm/s2."""
    return max(config.acceleration_mm_s2, config.brake_mm_s2)


def _bend_nm(config: GuardConfig) -> int:
    """Return the greatest distance that a change of speed adds in a period, nm: a T^2 / 2."""
    return _strongest(config) * config.period_ms**2 // 2


# ------------------------------------------------------------------ what proofs keep


def lemmas(own: Parts, holding: Bool, free: Bool, recovering: Bool) -> dict[str, Bool]:
    """Return the lemmas of containment now and at the anchor, of the distance since the anchor, and of rows and places that equal the world's."""
    config = own.config
    inside = between(own.low, own.truth, own.high) & between(own.slow, own.true_speed, own.fast)
    begun = own.truth - own.run
    found = {
        "the truth is inside": holding.implies(inside),
        "the truth was inside at the anchor": holding.implies(between(own.anchor_low, begun, own.anchor_high)),
        "no anchor while nothing is held": free.implies(own.anchor_steps.eq(0)),
        "the last fix near the way": own.near_low.eq(own.last_fix_low) & own.near_high.eq(own.last_fix_high),
        "the place last known": own.known_low.eq(own.sure_low) & own.known_high.eq(own.sure_high),
        "the row of the receiver": own.fair_fixes.eq(own.row_fixes),
        "no longer row than the receiver's": own.agreed_fixes <= own.row_fixes,
        "recovering by the last fix": recovering.implies((own.low >= own.near_low) & (own.high <= own.near_high)),
    }
    for steps in range(config.window_steps):
        here = holding & own.anchor_steps.eq(steps)
        found[f"lag after {steps} steps"] = here.implies(_lags(own, steps))
    return found


def _lags(own: Parts, steps: int) -> Bool:
    straight = exact_to(own.true_speed * Lit(steps * own.config.period_ms, MS), NM)
    most = own.config.lag_nm(steps)
    return between(-most, own.run - straight, most)
