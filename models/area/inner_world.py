"""The world of detection sections inside an area: what a clear one says of trains, their parts, and uncounted vehicles.

A train may have parted, and a gap between its parts may be clear. So one vehicle of each train stands for all of its vehicles: any one,
chosen anew in each cycle, between the train's rear end and its front end.
"""

from __future__ import annotations

from safeloc.language.expr import Bool, Num, all_of, between
from safeloc.language.world import Law
from safeloc.models.area.inner import Inner
from safeloc.models.area.laws import um
from safeloc.models.area.slot import Slot
from safeloc.models.area.variables import Parts


def part_law(one: Slot, known: Bool) -> Law:
    """Return the law of any vehicle of a train."""
    inside = all_of(
        [
            one.next_rear <= one.next_part_rear,
            one.next_part_rear <= one.next_part_front,
            one.next_part_front <= one.next_front,
        ]
    )
    return Law(
        known.implies(inside),
        "Every vehicle of a train is between the train's rear end and its front end, those of a part that was left behind as well.",
        (),
        "[D] definition of a train's ends",
        "nobody",
    )


def detection_law(own: Parts, number: int, inner: Inner) -> Law:
    """Return the law of one detection section."""
    loose = own.next_loose_there.implies(_outside(inner, own.next_loose_rear, own.next_loose_front))
    trains = [
        (one.there | one.enters).implies(
            _outside(inner, one.next_part_rear, one.next_part_front)
            & ~_in(inner, one.next_rear)
            & ~_in(inner, one.next_front)
        )
        for one in own.slots
    ]
    return Law(
        inner.clear.implies(all_of([loose, *trains])),
        f"Inner detection section {number} is clear only if no part of any vehicle, and no end of a train, is in it at the end of the cycle.",
        (),
        "[S] EN 50129: train detection fails to occupied",
        "supplier",
        "safety case of train detection; shunting of every vehicle",
    )


def _in(inner: Inner, place: Num) -> Bool:
    return between(um(inner.start), place, um(inner.end))


def _outside(inner: Inner, rear: Num, front: Num) -> Bool:
    return (front < um(inner.start)) | (rear > um(inner.end))
