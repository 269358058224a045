"""The world of a train that is verified: what the fibre tells of whichever train its pattern belongs to.

Which train that is, the world chooses anew in every cycle: nothing here says that it is the train of the record. Nor is
anything said of the record, of train control, or of place and speed at the counter: that is what is compared.
"""

from __future__ import annotations

from safeloc.language.expr import Bool, between, exact_to
from safeloc.language.units import NM, UM
from safeloc.language.world import Law, World
from safeloc.models.verification.variables import Parts

PLACE = "a located interval holds the front"


def world(own: Parts, *, place_kept: bool) -> World:
    """Axles (when counted), length and front of the train that the pattern belongs to; `place_kept`: an earlier machine vouches for it."""
    return World(
        ghosts=own.declared.ghosts,
        choices=own.declared.choices,
        moves={own.axles: own.next_axles, own.length: own.next_length, own.truth: own.next_truth},
        clauses={**_features(own), **({} if place_kept else _place(own))},
    )


def place_law(own: Parts) -> Bool:
    """A located interval holds the front."""
    low, high = own.place.value - own.place_below, own.place.value + own.place_above
    inside = between(exact_to(low, NM), own.next_truth, exact_to(high, NM))
    return (own.located & own.place.present).implies(inside)


def _place(own: Parts) -> dict[str, Bool | Law]:
    return {
        PLACE: Law(
            place_law(own),
            "Where the fibre's machine says that it located the front, its interval holds it.",
            source="[D] proved of the fibre's machine, under its own laws",
            owner="supplier",
            check="place at every counter that the train passes",
        )
    }


def _features(own: Parts) -> dict[str, Bool | Law]:
    """What a pattern tells is true of the train it belongs to."""
    tolerance = own.config.length_tolerance_mm * 1_000
    off = exact_to(own.seen_length.value, UM) - own.next_length
    counted, measured = own.associated & own.seen_count.present, own.associated & own.seen_length.present
    return {
        "the fibre's count is the train's": Law(
            counted.implies(own.seen_count.value.eq(own.next_axles)),
            "Where the fibre reports a number of axles with a pattern, the train that makes the pattern had as many at the moment "
            "that the count tells of: how long ago that may be, the machines that use it have to charge.",
            source="[S] Kowarik 2020: bogies can be counted, single axles not shown; [D] docs/signals.md: often not told",
            owner="supplier",
            check="count of every train against that of the counters",
        ),
        "the fibre's length is the train's within its tolerance": Law(
            measured.implies(between(-tolerance, off, tolerance)),
            "Where the fibre reports a length with a pattern, it is that of the train that makes the pattern, within the tolerance.",
            figures=("length_tolerance_mm",),
            source="[D] of the front end, measured",
            owner="supplier",
            check="length of every train against that of the counters",
        ),
    }
