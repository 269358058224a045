"""Lemmas for the proofs of the counting head: the mode gives the place of the wheel, and the side from which it came."""

from __future__ import annotations

from safeloc.language.expr import Bool, Lit, NumVar, all_of, between
from safeloc.language.units import UM_PER_MM
from safeloc.models.axle_head.variables import NO_AXLE, Parts


def lemmas(own: Parts, current: NumVar, table: tuple[Lit, ...]) -> dict[str, Bool]:
    """Return the lemmas, mode by mode."""
    free, a_first, both_up, b_last, b_first, both_down, a_last, disturbed = table
    spacing, end = own.config.spacing_mm * UM_PER_MM, (2 * own.config.spacing_mm + own.config.overlap_mm) * UM_PER_MM
    over_a, over_b = between(0, own.wheel, spacing - 1), between(end - spacing, own.wheel, end - 1)
    both = between(spacing, own.wheel, end - spacing - 1)
    up, down = {a_first: over_a, both_up: both, b_last: over_b}, {b_first: over_b, both_down: both, a_last: over_a}
    places = [current.eq(mode).implies(place & own.from_low) for mode, place in up.items()]
    places += [current.eq(mode).implies(place & ~own.from_low) for mode, place in down.items()]
    return {
        "the mode is where the wheel is": all_of([current.eq(free).implies(~between(0, own.wheel, end - 1)), *places]),
        "the axle is the wheel that passed": current.eq(disturbed) | own.ended | own.axle.eq(own.passed),
        "an axle is reported when the head is free": current.ne(free).implies(own.axle.eq(NO_AXLE)),
        "a disturbance has ended where the head is free": own.ended.implies(current.eq(free)),
    }
