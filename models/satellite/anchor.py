"""Against a drift that all satellites have in common: the position held against odometry since the last reference.

A spoofer that moves every signal together within the thresholds passes each cycle's checks, without a bound in sum.
What knows nothing of satellites bounds it: the last reference, carried along by odometry; without odometry in a cycle
by the greatest speed. The state is never computed from it (SAT-1, SAT-5): it only ends a position that has drifted away.
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.expr import Bool, Num, all_of, any_of, as_num, between, exact_to, ite
from safeloc.language.units import NM, NM_PER_MM
from safeloc.models.satellite.variables import Parts, State


@dataclass(frozen=True, eq=False)
class Anchor:
    """How a state stands to the place that odometry carries along.

    kept    it still bounds something: its margin is within the limit
    offset  the state's place less that place; margin: what that place may be wrong by
    holds   both may be true at once; without an anchor nothing is held against the state, unless it is required
    """

    kept: Bool
    offset: Num
    margin: Num
    holds: Bool


def carried(own: Parts, state: State) -> Anchor:
    """The anchor a cycle later, against the state that would be taken on."""
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
