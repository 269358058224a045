"""Lemmas of the satellite position machine: they help to prove its properties, and are proved themselves."""

from __future__ import annotations

from safeloc.language.expr import Bool, Lit, Num, between
from safeloc.language.units import NM_PER_MM
from safeloc.models.satellite.variables import Parts, held
from safeloc.models.satellite.world import Trusted, can_stop


def lemmas(own: Parts, current: Num, table: tuple[Lit, ...], trusted: Trusted) -> dict[str, Bool]:
    """Return invariants of the machine, and those of its ghosts that follow from the trusted source."""
    lost, located, _ = table
    state, most = held(own), (own.config.tolerance_mm - 2) * NM_PER_MM
    margin = own.anchor_margin
    return {
        **(_inside(own, current, lost) if trusted == "satellites" else _near_anchor(own)),
        "margins are tolerable": between(0, state.below, most) & between(0, state.above, most),
        "nothing while unlocated": current.eq(lost).implies(own.coasted.eq(0) & ~own.anchored),
        "speed between its bounds": (state.slowest <= state.speed) & (state.speed <= state.fastest),
        "coasting counts": current.eq(located).implies(own.coasted.eq(0)),
        "position and anchor meet": between(-(state.above + margin), own.anchor_offset, state.below + margin),
        "the vehicle can stop before the coordinates end": can_stop(own, own.truth, own.true_speed),
    }


def _inside(own: Parts, current: Num, lost: Lit) -> dict[str, Bool]:
    state = held(own)
    place = (state.low <= own.truth) & (own.truth <= state.high)
    speed = (state.slowest <= own.true_speed) & (own.true_speed <= state.fastest)
    return {"the truth is inside": current.ne(lost).implies(place & speed)}


def _near_anchor(own: Parts) -> dict[str, Bool]:
    off = own.truth - (own.position - own.anchor_offset)
    return {"the truth is near the anchor": own.anchored.implies(between(-own.anchor_margin, off, own.anchor_margin))}
