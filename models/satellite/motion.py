"""The state a cycle later: predicted from the state before alone, and narrowed by a solution or a reference.

Estimate and bounds are computed apart: the bounds follow from physics and from intervals that hold the truth, the estimate
follows the latest solution within them. So a solution with wide bounds still leads the prediction.
"""

from __future__ import annotations

from safeloc.language.expr import Bool, Lit, Num, all_of, as_num, between, exact_to, floor_div, ite, maximum, minimum
from safeloc.language.units import MM, MM_S, MS, NM, NM_PER_MM, UM_S
from safeloc.models.satellite.variables import Parts, State, around


def predicted(own: Parts) -> State:
    """Return the state E* by the state before alone: constant acceleration along the track (SAT-1, [0042])."""
    config, period = own.config, Lit(own.config.period_ms, MS)
    fast, way, gained = config.max_speed_mm_s * 1_000, as_num(config.way_nm, NM), config.speed_change_um_s
    half = exact_to(own.change * Lit(config.period_ms // 2, MS), NM)
    return State(
        own.position + exact_to(own.speed * period, NM) + half,
        own.low + exact_to(own.slowest * period, NM) - way,
        own.high + exact_to(own.fastest * period, NM) + way,
        _within(own.speed + own.change, as_num(-fast, UM_S), as_num(fast, UM_S)),
        maximum(own.slowest - gained, -fast),
        minimum(own.fastest + gained, fast),
    )


def protection_level(own: Parts) -> Num:
    """Return the error bound of the solution's place, nm: every used signal has the greatest error of a usable one."""
    signals = own.dilution * Lit(own.config.selection.usable_range_error_mm, MM)
    return exact_to(signals, NM) + exact_to(own.further, NM)


def speed_level(own: Parts) -> Num:
    """Return the error bound of the solution's speed, um/s."""
    return (
        exact_to(own.speed_dilution * Lit(own.config.selection.usable_speed_error_mm_s, MM_S), UM_S) + own.speed_further
    )


def solved(own: Parts) -> State:
    """Return the state by the solution alone."""
    return around(exact_to(own.fix.value, NM), protection_level(own), own.fix_speed, speed_level(own))


def referred(own: Parts) -> State:
    """Return the state by the reference alone; without a speed of its own it allows any speed of a vehicle."""
    fast, known = own.config.max_speed_mm_s * 1_000, own.reference_speed.present
    place, error = exact_to(own.reference.value, NM), exact_to(own.accuracy, NM)
    speed = ite(known, own.reference_speed.value, as_num(0, UM_S))
    reach = around(place, error, speed, ite(known, own.speed_accuracy, as_num(fast, UM_S)))
    return State(place, reach.low, reach.high, speed, maximum(reach.slowest, -fast), minimum(reach.fastest, fast))


def fixed(own: Parts) -> State:
    """Return the common part of prediction and solution; the estimates are the solution's, the place smoothed."""
    found, ahead = solved(own), predicted(own)
    knows_speed = speed_level(own) < own.config.max_speed_mm_s * 1_000
    nearer = ahead.position + floor_div((found.position - ahead.position) * own.config.place_gain_percent, 100)
    return _both(ahead, found, nearer, ite(knows_speed, found.speed, ahead.speed))


def confirmed(own: Parts) -> State:
    """Return the common part of prediction and reference; the estimate is that of the narrower one."""
    found, ahead = referred(own), predicted(own)
    nearer = found.high - found.low <= ahead.high - ahead.low
    speed = ite(own.reference_speed.present, found.speed, ahead.speed)
    return _both(ahead, found, ite(nearer, found.position, ahead.position), speed)


def _both(one: State, other: State, position: Num, speed: Num) -> State:
    low, high = maximum(one.low, other.low), minimum(one.high, other.high)
    slowest, fastest = maximum(one.slowest, other.slowest), minimum(one.fastest, other.fastest)
    return State(_within(position, low, high), low, high, _within(speed, slowest, fastest), slowest, fastest)


def _within(value: Num, low: Num, high: Num) -> Num:
    return maximum(low, minimum(value, high))


def reportable(own: Parts, state: State) -> Bool:
    """Return whether the state may be reported: margins within the tolerance when rounded, place and speed in range."""
    config = own.config
    limit, most = config.position_limit_mm * NM_PER_MM, (config.tolerance_mm - 2) * NM_PER_MM
    place = [between(0, state.below, most), between(0, state.above, most), between(-limit, state.position, limit)]
    return all_of([*place, state.slowest <= state.speed, state.speed <= state.fastest])
