"""Detection of a drift that all satellites have in common: the position is compared with odometry since the last reference.

A spoofer that moves all signals together within the thresholds passes the checks of each cycle, and the sum has no bound.
A source independent of satellites bounds it: the last reference, moved by odometry, or by the greatest speed in a cycle without
odometry. The state is never computed from it (SAT-1, SAT-5): it only ends a position that has drifted away.
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.expr import Bool, Num, all_of, any_of, as_num, between, exact_to, ite
from safeloc.language.units import NM, NM_PER_MM
from safeloc.models.satellite.variables import Parts, State


@dataclass(frozen=True, eq=False)
class Anchor:
    """A state compared with the last reference moved by odometry.

    kept    the comparison is still of use: its margin is within the limit
    offset  the state's place less that place; margin: the error bound of that place
    holds   both may be true at once; without an anchor every state passes, unless the check is required
    """

    kept: Bool
    offset: Num
    margin: Num
    holds: Bool


def carried(own: Parts, state: State) -> Anchor:
    """Return the anchor a cycle later, compared with the given next state."""
    config = own.config
    known = own.odometry.present
    run = ite(known, exact_to(own.odometry.value, NM), as_num(0, NM))
    error = ite(known, exact_to(own.odometry_error, NM), as_num(config.way_at_most_nm, NM))
    offset = own.anchor_offset + (state.position - own.position) - run
    margin = own.anchor_margin + error
    kept = own.anchored & (margin <= config.anchor_limit_mm * NM_PER_MM)
    within = between(-(state.above + margin), offset, state.below + margin)
    return Anchor(kept, offset, margin, all_of([kept, within]) if _required(own) else any_of([~kept, within]))


def _required(own: Parts) -> bool:
    return own.config.drift_check == "required"
