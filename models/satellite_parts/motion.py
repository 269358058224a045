"""The state a cycle later: predicted from the state before alone, and narrowed by what else holds the truth."""

from __future__ import annotations

from safeloc.expr import Bool, Lit, abs_, all_of, as_num, between, exact_to, ite
from safeloc.models.satellite_parts.variables import NM_PER_MM, Parts, State
from safeloc.units import MS, NM, UM_S


def predicted(own: Parts) -> State:
    """The state E* from the state before alone: constant acceleration along the track (SAT-1, [0042])."""
    config, period = own.config, Lit(own.config.period_ms, MS)
    half = exact_to(own.change * Lit(config.period_ms // 2, MS), NM)
    way = as_num(config.way_nm, NM)
    return State(
        own.position + exact_to(own.speed * period, NM) + half,
        own.margin + exact_to(own.speed_margin * period, NM) + abs_(half) + way,
        own.speed + own.change,
        own.speed_margin + abs_(own.change) + config.speed_change_um_s,
    )


def solved(own: Parts) -> State:
    """What the solution says."""
    return State(exact_to(own.fix.value, NM), exact_to(own.protection, NM), own.fix_speed, own.speed_protection)


def referred(own: Parts) -> State:
    """What the reference says; without its speed any that a vehicle has."""
    fast = own.config.max_speed_mm_s * 1_000
    return State(
        exact_to(own.reference.value, NM),
        exact_to(own.accuracy, NM),
        ite(own.reference_speed.present, own.reference_speed.value, as_num(0, UM_S)),
        ite(own.reference_speed.present, own.speed_accuracy, as_num(fast, UM_S)),
    )


def narrowed(first: State, second: State) -> State:
    """The one with the smaller margin, place and speed apart: both hold the truth."""
    nearer, steadier = second.margin <= first.margin, second.speed_margin <= first.speed_margin
    return State(
        ite(nearer, second.position, first.position),
        ite(nearer, second.margin, first.margin),
        ite(steadier, second.speed, first.speed),
        ite(steadier, second.speed_margin, first.speed_margin),
    )


def reportable(own: Parts, state: State) -> Bool:
    """It may be reported: margin within the tolerance when rounded, place and speed in range."""
    config = own.config
    fast = config.max_speed_mm_s * 1_000
    limit = config.position_limit_mm * NM_PER_MM
    return all_of(
        [
            state.margin <= (config.tolerance_mm - 2) * NM_PER_MM,
            between(-limit, state.position, limit),
            between(-fast, state.speed, fast),
        ]
    )
