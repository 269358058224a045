"""What the guard's environment keeps: how a vehicle moves, and when a fix is true.

Nothing is assumed of a single fix, nor of any run of agreeing fixes shorter than asked for: they may lie anywhere,
also where the guard would look for the vehicle. Nothing at all is assumed of quality flags: the guard does not read them.
"""

from __future__ import annotations

from safeloc.language.expr import Bool, Expr, Lit, Var, abs_, all_of, as_num, between, exact_to, ite
from safeloc.language.units import MS, NM, UM_S
from safeloc.language.world import Law
from safeloc.models.guard.box import due_now, half_nm
from safeloc.models.guard.judgement import Judged
from safeloc.models.guard.variables import Parts


def clauses(own: Parts, cycle: Judged, holding: Bool, recovering: Bool) -> dict[str, Law]:
    """The vehicle moves as its figures say while something is held; a confirmed fix is true within its bound."""
    confirmed = ((holding & cycle.agrees) | (recovering & cycle.agrees)) & cycle.confirmed
    return {
        "the vehicle moves within its figures": Law(
            holding.implies(_motion(own)),
            "The vehicle changes its speed by no more than acceleration and brake allow, and the way follows from the speed.",
            ("acceleration_mm_s2", "brake_mm_s2", "period_ms"),
            "[D] acceleration of passenger trains; [M] the strongest brake",
            "operator",
            "the rates of the vehicle class, emergency brake included, against the recorded speed",
        ),
        "a confirmed fix is true within its bound": Law(
            confirmed.implies(_true(own)),
            "A fix that agrees with map and motion, after as many agreeing ones as are asked for, lies no farther from the vehicle "
            "than it is charged; nor does its speed.",
            ("fix_error_mm", "offset_charge_permille", "speed_error_mm_s", "confirmations"),
            "[M] errors of a receiver along the track",
            "supplier",
            "the receiver's fixes against marks of known place",
        ),
    }


def _motion(own: Parts) -> Bool:
    """Speed changes by no more than the vehicle can; the way follows from speed. In one instant nothing moves."""
    config = own.config
    gain, change = as_num(config.speed_rise_um_s, UM_S), as_num(config.speed_change_um_s, UM_S)
    ran, sped = own.next_truth - own.truth, own.next_speed - own.true_speed
    off = ran - exact_to(own.true_speed * Lit(config.period_ms, MS), NM)
    moves = all_of(
        [
            between(-config.way_nm, off, config.way_nm),
            sped <= ite(own.true_speed >= 0, gain, change),
            -sped <= ite(own.true_speed <= 0, gain, change),
        ]
    )
    return ite(own.advance, moves, ran.eq(0) & sped.eq(0))


def _true(own: Parts) -> Bool:
    """The fix lies no farther from the vehicle than it is charged, and so does its speed, where it tells one."""
    half, off = half_nm(own), own.next_truth - exact_to(own.fix.value, NM)
    error = own.config.speed_error_mm_s * 1_000
    wrong = abs_(own.next_speed) - exact_to(own.speed.value, UM_S)
    return between(-half, off, half) & own.speed.present.implies(between(-error, wrong, error))


def moves(own: Parts, holding: Bool) -> dict[Var, Expr]:
    """How the ghosts move. While nothing is held `run` rests: where a way begins anew, so does the truth along it."""
    ran = own.run + own.next_truth - own.truth
    run = ite(holding & ~due_now(own), ran, as_num(0, NM))
    return {own.truth: own.next_truth, own.true_speed: own.next_speed, own.run: run}


def lemmas(own: Parts, holding: Bool, free: Bool) -> dict[str, Bool]:
    """The truth is inside, at the anchor as well; and distance since then lags speed times duration by a known amount."""
    config = own.config
    inside = between(own.low, own.truth, own.high) & between(own.slow, own.true_speed, own.fast)
    begun = own.truth - own.run
    found = {
        "the truth is inside": holding.implies(inside),
        "the truth was inside at the anchor": holding.implies(between(own.anchor_low, begun, own.anchor_high)),
        "no anchor while nothing is held": free.implies(own.anchor_steps.eq(0)),
    }
    for steps in range(config.window_steps):
        here = holding & own.anchor_steps.eq(steps)
        found[f"lag after {steps} steps"] = here.implies(_lags(own, steps))
    return found


def _lags(own: Parts, steps: int) -> Bool:
    straight = exact_to(own.true_speed * Lit(steps * own.config.period_ms, MS), NM)
    most = own.config.lag_nm(steps)
    return between(-most, own.run - straight, most)
