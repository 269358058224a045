"""The world of an area whose borders report occupancy alone: who comes in, and what train detection says of it.

    trains     tell themselves when they come in, perhaps late, and when they have left
    detection  undisturbed, is clear over nobody, in the area and just outside each end
    others     come in at an end only while the side outside is not clear, and pass no train

One vehicle that was never counted stands for all of them. The world remembers whether it is a follower: it came in at an
end, and no train did after it; and for each train that came in at that end, whether the vehicle came after it.
"""

from __future__ import annotations

from safeloc.language.expr import Bool, Expr, Var, abs_, all_of, any_of, ite
from safeloc.language.units import UM_PER_MM
from safeloc.language.world import Law
from safeloc.models.area.followers import Followers
from safeloc.models.area.laws import came_in, um
from safeloc.models.area.slot import Slot
from safeloc.models.area.variables import Parts


def moves(own: Parts, followers: Followers) -> dict[Var, Expr]:
    """Return the next values of what the world remembers of the uncounted vehicle."""
    comes = _comes(own)
    found: dict[Var, Expr] = {}
    for side in followers.sides:
        here = followers.next_loose_comes_in_low if side.is_low else ~followers.next_loose_comes_in_low
        was = side.came_in & ~any_of(one.event.eq(side.enters) for one in own.slots)
        found[side.came_in] = all_of([own.next_loose_there, own.healthy, ite(comes, here, was)])
    return found | {
        behind: _is_behind(own, followers, one) for one, behind in zip(own.slots, followers.behind, strict=True)
    }


def _is_behind(own: Parts, followers: Followers, one: Slot) -> Bool:
    """Return the condition that the uncounted vehicle came in after the train, at the same end: now, before, or before the train was reported."""
    low, high = came_in(one)
    here = any_of(one.event.eq(side.enters) & side.came_in for side in followers.sides)
    was = ite(one.enters, here & followers.reported_late[one.number - 1], followers.behind[one.number - 1])
    return ite(_comes(own), ite(followers.next_loose_comes_in_low, low, high), was)


def _comes(own: Parts) -> Bool:
    """Return the condition that the uncounted vehicle comes in."""
    return own.next_loose_there & ~own.loose_there


def _outside(own: Parts, one: Slot) -> Bool:
    """Return the condition that no part of the train is between the ends after the cycle."""
    return (one.next_front < um(own.low_end)) | (one.next_rear > um(own.high_end))


def stays(own: Parts, one: Slot) -> Bool:
    """Return the condition that the train is in the area after the cycle."""
    over = own.healthy & (own.clear | one.leaves) & _outside(own, one)
    return one.enters | (one.there & ~over)


def laws(own: Parts, followers: Followers) -> dict[str, Law]:
    """Return the laws of trains that come in, of detection, and of uncounted vehicles."""
    entering = {f"train {one.number} reports that it comes in": _entering_law(own, followers, one) for one in own.slots}
    return {
        **entering,
        "detection is clear over nobody": _detection_law(own),
        "uncounted vehicles come in from outside": _coming_law(own, followers),
        "uncounted vehicles": _order_law(own, followers),
    }


def _entering_law(own: Parts, followers: Followers, one: Slot) -> Law:
    config = own.config
    step = config.reach.cycle_mm * UM_PER_MM + config.max_speed_mm_s * config.entry_report_delay_ms
    low, high = (one.event.eq(side.enters) for side in followers.sides)
    at_low, at_high = one.next_front <= um(own.low_end) + step, one.next_rear >= um(own.high_end) - step
    return Law(
        all_of([one.enters.implies(~one.there), low.implies(at_low), high.implies(at_high)]),
        "A train that reports that it comes in gets a slot that no train in the area has, and is no farther in than it runs until it is reported, and in a cycle.",
        ("max_speed_mm_s", "period_ms", "entry_report_delay_ms"),
        "[D] HTD: a train is known by its own reports; trackside detection says free or occupied",
        "operator",
        "detection becomes occupied when a train reports that it comes in",
    )


def _detection_law(own: Parts) -> Law:
    clear = own.healthy & own.clear
    trains = all_of((one.there | one.enters).implies(_outside(own, one)) for one in own.slots)
    return Law(
        clear.implies(~own.next_loose_there & trains),
        "Undisturbed train detection is clear only if no part of any vehicle is between the ends at the end of the cycle.",
        (),
        "[S] SUBSET-026 and EN 50129: train detection fails to occupied",
        "supplier",
        "safety case of train detection; shunting of every vehicle",
    )


def _coming_law(own: Parts, followers: Followers) -> Law:
    step = own.config.reach.cycle_mm * UM_PER_MM
    at_low = ~followers.low.clear & (own.next_loose_front <= um(own.low_end) + step)
    at_high = ~followers.high.clear & (own.next_loose_rear >= um(own.high_end) - step)
    return Law(
        (_comes(own) & own.healthy).implies(ite(followers.next_loose_comes_in_low, at_low, at_high)),
        "While detection is undisturbed, a vehicle that was never counted comes in at an end only in a cycle in which the side "
        "just outside was not clear throughout, and is then no farther in than it runs in a cycle.",
        ("max_speed_mm_s", "period_ms"),
        "[D] the section outside is longer than a cycle's run: nobody runs through it between two readings",
        "infrastructure",
        "safety case of train detection; no switch between the ends",
    )


def _order_law(own: Parts, followers: Followers) -> Law:
    step = own.config.reach.cycle_mm * UM_PER_MM
    rear, front = own.next_loose_rear, own.next_loose_front
    runs = (abs_(front - own.loose_front) <= step) & (abs_(rear - own.loose_rear) <= step)
    inside = (front >= um(own.low_end)) & (rear <= um(own.high_end))
    order = all_of(_beside(own, followers, one) for one in own.slots)
    term = all_of(
        [
            own.next_loose_there.implies((rear <= front) & inside),
            (own.next_loose_there & own.loose_there).implies(runs),
            (own.next_loose_there & own.healthy).implies(order),
        ]
    )
    return Law(
        term,
        "A vehicle that was never counted runs no faster than the top speed, and passes no train: it stays behind a train that reported before "
        "it came in at the same end, or in the same cycle, and ahead of others; of a train that tells after the vehicle came in there, "
        "with no other train reported between, either; until that train reported that it left.",
        ("max_speed_mm_s", "period_ms"),
        "[D] one track: no vehicle passes another, and none comes in between an end and a train that reports that it comes in",
        "infrastructure",
        "no switch between the ends, nor just outside",
    )


def _beside(own: Parts, followers: Followers, one: Slot) -> Bool:
    """Return the condition that the uncounted vehicle keeps its order with a train that came in at a known end.

    Seen from the low end a vehicle behind the train is below it; seen from the high end, above it.
    """
    low, high = came_in(one)
    behind = _is_behind(own, followers, one)
    below, above = own.next_loose_front <= one.next_rear, own.next_loose_rear >= one.next_front
    return low.implies(ite(behind, below, above)) & high.implies(ite(behind, above, below))
