"""The world of a train that is verified: the fibre's readings of the train that makes the pattern.

The world chooses that train anew in every cycle: no law says that it is the train of the record. Nor is there a law for the
record, for train control, or for place and speed at the counter: the machine compares these.
"""

from __future__ import annotations

from safeloc.language.expr import Bool, between, exact_to
from safeloc.language.units import UM
from safeloc.language.world import Law, World
from safeloc.models.verification.variables import Parts
from safeloc.models.vocabulary.vehicle_world import stated_interval_holds

PLACE = "a located interval holds the front"


def world(own: Parts, *, place_kept: bool) -> World:
    """Return the world of the train that makes the pattern; `place_kept`: an earlier machine guarantees its interval."""
    return own.declared.world(
        moves={own.axles: own.next_axles, own.length: own.next_length, own.truth: own.next_truth},
        clauses={**_features(own), **({} if place_kept else _place(own))},
    )


def place_law(own: Parts) -> Bool:
    """Return the condition that a located interval contains the front."""
    place, below, above = own.fibre_position, own.fibre_margin_below, own.fibre_margin_above
    inside = stated_interval_holds(place.value, below, above, own.next_truth)
    return (own.located & own.fibre_position.present).implies(inside)


def _place(own: Parts) -> dict[str, Bool | Law]:
    return {
        PLACE: Law(
            place_law(own),
            "Where the fibre machine reports the front as located, its interval contains it.",
            source="[D] proved of the fibre's machine, under its own laws",
            owner="supplier",
            check="place at every counter that the train passes",
        )
    }


def _features(own: Parts) -> dict[str, Bool | Law]:
    """Return the laws of count and length: they are those of the train that makes the pattern."""
    tolerance = own.config.length_tolerance_mm * 1_000
    off = exact_to(own.fibre_length.value, UM) - own.next_length
    counted, measured = own.associated & own.fibre_axles.present, own.associated & own.fibre_length.present
    return {
        "the fibre's count is the train's": Law(
            counted.implies(own.fibre_axles.value.eq(own.next_axles)),
            "Where the fibre reports a number of axles with a pattern, the train that makes the pattern had as "
            "many at the moment to which the count refers. Machines that use the count have to allow for the "
            "time since that moment.",
            source="[S] Kowarik 2020: bogies can be counted, single axles not shown; [D] docs/signals.md: often no "
            "count",
            owner="supplier",
            check="count of every train against that of the counters",
        ),
        "the fibre's length is the train's within its tolerance": Law(
            measured.implies(between(-tolerance, off, tolerance)),
            "Where the fibre reports a length with a pattern, it is that of the train that makes the pattern, "
            "within the tolerance.",
            figures=("length_tolerance_mm",),
            source="[D] of the front end, measured",
            owner="supplier",
            check="length of every train against that of the counters",
        ),
    }
