"""Lemmas of the occupied track, over the machine and its world. They are proved themselves."""

from __future__ import annotations

from safeloc.language.expr import Bool, Lit, Num, all_of, any_of, between, exact_to
from safeloc.language.units import NM
from safeloc.models.occupied_track.cycle import on_one_edge
from safeloc.models.occupied_track.variables import NO_EDGE, Parts, Slot
from safeloc.models.occupied_track.world import on_its_edge


def lemmas(own: Parts, current: Num, table: tuple[Lit, ...]) -> dict[str, Bool]:
    """Return the lemmas: the true track is carried, each carried one meets the interval, and the mode tells how many edges there are."""
    _, one_edge, several, _ = table
    carrying, seen = current.one_of(one_edge, several), own.ghosts
    there = tuple(slot.edge.ne(NO_EDGE) for slot in own.slots)
    alike = on_one_edge(tuple(slot.edge for slot in own.slots), there)
    inside = between(exact_to(own.given_low, NM), seen.truth, exact_to(own.given_high, NM))
    return {
        "the true track has a slot": carrying.implies(any_of(_true(own, slot) for slot in own.slots)),
        "the vehicle is on its edge": on_its_edge(own),
        "the interval holds the vehicle": carrying.implies(inside),
        "the interval is in order": own.given_low <= own.given_high,
        "a carried track meets the interval": all_of(~one | _meets(own, slot) for one, slot in zip(there, own.slots, strict=True)),
        "nothing is carried without a track": carrying.iff(any_of(there)),
        "one edge or several": current.eq(one_edge).iff(any_of(there) & alike),
    }  # fmt: skip


def _true(own: Parts, slot: Slot) -> Bool:
    seen = own.ghosts
    return slot.edge.eq(seen.edge) & slot.origin.eq(seen.origin) & slot.length.eq(seen.length)


def _meets(own: Parts, slot: Slot) -> Bool:
    return (own.given_low <= slot.origin + slot.length) & (own.given_high >= slot.origin)
