"""Lemmas for the proofs of the area machine. They read the machine and the world, and are proved themselves."""

from __future__ import annotations

from safeloc.language.expr import Bool, Lit, Num, all_of, ite
from safeloc.models.area.followers import Followers, Side
from safeloc.models.area.laws import um
from safeloc.models.area.slot import Slot
from safeloc.models.area.variables import Parts


def ends_in_order(own: Parts) -> Bool:
    """Return the order of the ends: low before high, both so far from the ends of the world as a train can be in when it comes in."""
    inner = own.config.limit_mm - own.config.reach.entry_mm
    return all_of([own.low_end < own.high_end, own.low_end >= -inner, own.high_end <= inner])


def lemmas(own: Parts, current: Num, table: tuple[Lit, ...]) -> dict[str, Bool]:
    """Return the lemmas: intervals contain their trains, loose vehicles are in bounds, and a train that pushes is there."""
    swept, followers = current.eq(table[1]), own.followers
    loose = (
        own.loose_there if followers is None else own.loose_there & ~(followers.low.came_in | followers.high.came_in)
    )
    found: dict[str, Bool] = {
        "ends in order": ends_in_order(own),
        "nothing loose once swept": swept.implies(~loose),
        "loose vehicles within": loose.implies(
            (um(own.loose_low) <= own.loose_rear) & (own.loose_front <= um(own.loose_high))
        ),
    }
    if own.inner:
        found |= {f"vehicles of train {one.number}": _of_parts(one) for one in own.slots}
    if followers is not None:
        found |= _of_followers(own, followers)
    for one in own.slots:
        found |= _of_train(own, one, swept)
        found |= _of_sides(own, one) if followers is None else _of_order(own, followers, one, loose)
    return found


def _of_train(own: Parts, one: Slot, swept: Bool) -> dict[str, Bool]:
    inside = (um(one.low) <= one.true_rear) & (one.true_front <= um(one.high)) & (one.true_rear <= one.true_front)
    in_order = (
        one.there if own.inner else one.present
    )  # a train that is not there may have no place left where it can be
    pushed = (one.below_loose.implies(one.low <= own.loose_low)) & (one.above_loose.implies(own.loose_high <= one.high))
    return {
        f"train {one.number} within": one.there.implies(one.present & inside),
        f"train {one.number} has sides only while present": (one.below_loose | one.above_loose).implies(one.present),
        f"train {one.number} has one side": ~(one.below_loose & one.above_loose),
        f"train {one.number} has pushed": swept | pushed,
        f"train {one.number} is in order": in_order.implies(one.low <= one.high),
    }


def _of_parts(one: Slot) -> Bool:
    inside = all_of([one.true_rear <= one.part_rear, one.part_rear <= one.part_front, one.part_front <= one.true_front])
    return one.there.implies(inside)


def _of_sides(own: Parts, one: Slot) -> dict[str, Bool]:
    really = one.below_loose.implies(one.from_low) & one.above_loose.implies(one.from_high)
    return {
        f"train {one.number} pushes only while there": (own.loose_there & (one.below_loose | one.above_loose)).implies(
            one.there
        ),
        f"train {one.number} pushes from the end where it came in": one.there.implies(really),
    }


def _of_followers(own: Parts, followers: Followers) -> dict[str, Bool]:
    low, high = followers.sides
    inside = (own.loose_front >= um(own.low_end)) & (own.loose_rear <= um(own.high_end))
    return {
        "followers within": (own.loose_there & low.came_in).implies(own.loose_front <= um(low.bound))
        & (own.loose_there & high.came_in).implies(own.loose_rear >= um(high.bound)),
        "followers are in the area": (own.loose_there & (low.came_in | high.came_in)).implies(inside),
        "a follower came in at one end": ~(low.came_in & high.came_in),
        **{
            f"followers from the {name} end may be there": side.some | side.bound.eq(side.none)
            for name, side in _named(followers)
        },
    }


def _named(followers: Followers) -> tuple[tuple[str, Side], ...]:
    return ("low", followers.low), ("high", followers.high)


def _of_order(own: Parts, followers: Followers, one: Slot, loose: Bool) -> dict[str, Bool]:
    """Return where the uncounted vehicle really is, seen from a train whose order is known."""
    ordered, behind = followers.ordered[one.number - 1], followers.behind[one.number - 1]
    above, below = ite(behind, one.from_high, one.from_low), ite(behind, one.from_low, one.from_high)
    known = own.loose_there & ordered
    apart = (followers.low.bound <= one.high) & (followers.high.bound >= one.low)
    return {
        f"train {one.number} is ordered from one end": ~(one.from_low & one.from_high),
        f"train {one.number} is ordered only while present": ordered.implies(one.present),
        f"train {one.number} has sides only while ordered": (one.below_loose | one.above_loose).implies(ordered),
        f"train {one.number} is ordered only while there": ordered.implies(one.there & (one.from_low | one.from_high)),
        f"train {one.number} keeps followers behind its far end": ordered.implies(apart),
        f"train {one.number} has followers behind it": (known & followers.low.came_in).implies(below)
        & (known & followers.high.came_in).implies(above),
        f"train {one.number} has loose vehicles on its side": (loose & one.below_loose).implies(above)
        & (loose & one.above_loose).implies(below),
    }
