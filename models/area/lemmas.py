"""Lemmas for the proofs of the area machine. They read the machine and the world, and are proved themselves."""

from __future__ import annotations

from safeloc.language.expr import Bool, Lit, Num, all_of
from safeloc.models.area.slot import Slot
from safeloc.models.area.variables import Parts
from safeloc.models.area.world import um


def ends_in_order(own: Parts) -> Bool:
    """Return the order of the ends: low before high, both at least a cycle's run from the ends of the world."""
    inner = own.config.limit_mm - own.config.reach.cycle_mm
    return all_of([own.low_end < own.high_end, own.low_end >= -inner, own.high_end <= inner])


def lemmas(own: Parts, current: Num, table: tuple[Lit, ...]) -> dict[str, Bool]:
    """Return the lemmas: intervals contain their trains, loose vehicles are in bounds, and a train that pushes is there."""
    swept = current.eq(table[1])
    found: dict[str, Bool] = {
        "ends in order": ends_in_order(own),
        "nothing loose once swept": swept.implies(~own.loose),
        "loose vehicles within": own.loose.implies(
            (um(own.loose_low) <= own.loose_rear) & (own.loose_front <= um(own.loose_high))
        ),
    }
    for one in own.slots:
        found |= _of_train(own, one, swept)
    return found


def _of_train(own: Parts, one: Slot, swept: Bool) -> dict[str, Bool]:
    inside = (um(one.low) <= one.true_rear) & (one.true_front <= um(one.high)) & (one.true_rear <= one.true_front)
    pushed = (one.below.implies(one.low <= own.loose_low)) & (one.above.implies(own.loose_high <= one.high))
    really = one.below.implies(one.from_low) & one.above.implies(one.from_high)
    return {
        f"train {one.number} within": one.there.implies(one.present & inside),
        f"train {one.number} has sides only while present": (one.below | one.above).implies(one.present),
        f"train {one.number} has one side": ~(one.below & one.above),
        f"train {one.number} has pushed": swept | pushed,
        f"train {one.number} is in order": one.present.implies(one.low <= one.high),
        f"train {one.number} pushes only while there": (own.loose & (one.below | one.above)).implies(one.there),
        f"train {one.number} pushes from the end where it came in": one.there.implies(really),
    }
