"""One cycle: where the vehicle may be on each carried track and beyond its ends, and which offers of the map follow from that."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from safeloc.language.expr import Bool, Num, all_of, any_of
from safeloc.models.occupied_track.variables import FIRST, NO_EDGE, SECOND, Entry, Joint, Offer, Parts, Slot
from safeloc.models.turn_off import UNDECIDED as NO_COURSE


@dataclass(frozen=True, eq=False)
class Way:
    """A track on which the vehicle may be in this cycle, and the condition on which the offer of the map is this track."""

    possible: Bool
    offered: tuple[Bool, ...]


@dataclass(frozen=True, eq=False)
class Cycle:
    """The terms of a cycle."""

    own: Parts

    @property
    def located(self) -> Bool:
        """The localizer gives a position."""
        return self.own.located & (self.own.low <= self.own.high)

    def may_be_on(self, origin: Num, length: Num) -> Bool:
        """Return whether the interval has a place in common with an edge."""
        return (self.own.low <= origin + length) & (self.own.high >= origin)

    def leaves_ahead(self, slot: Slot) -> Bool:
        """Return whether the vehicle may have run over the end of the edge."""
        return slot.edge.ne(NO_EDGE) & (self.own.high > slot.origin + slot.length) & ~self.own.surely_not_ahead

    def leaves_behind(self, slot: Slot) -> Bool:
        """Return whether the vehicle may have run back over the beginning of the edge."""
        return slot.edge.ne(NO_EDGE) & (self.own.low < slot.origin) & ~self.own.surely_not_back

    def ways(self, slot: Slot, entry: Entry) -> Iterator[Way]:
        """Yield where the vehicle may be that was on this track: still on it, or on the edges that join it."""
        stays = slot.edge.ne(NO_EDGE) & self.may_be_on(slot.origin, slot.length)
        yield Way(stays, tuple(_same(one, slot) for one in self.own.offers))
        for edge, led in _led(entry.ahead):
            offered = tuple(one.edge.eq(edge) & one.origin.eq(slot.origin + slot.length) for one in self.own.offers)
            yield Way(self.leaves_ahead(slot) & led, offered)
        for edge, led in _led(entry.behind):
            offered = tuple(one.edge.eq(edge) & slot.origin.eq(one.origin + one.length) for one in self.own.offers)
            yield Way(self.leaves_behind(slot) & led, offered)

    @property
    def all_ways(self) -> tuple[Way, ...]:
        """Every track on which the vehicle may be, whatever it reads."""
        pairs = zip(self.own.slots, self.own.entries, strict=True)
        return tuple(way for slot, entry in pairs for way in self.ways(slot, entry))

    @property
    def all_offered(self) -> Bool:
        """The map knows every joint that may have been passed, and offers every track on which the vehicle may be."""
        known = [
            (self.leaves_ahead(slot) | self.leaves_behind(slot)).implies(entry.edge.eq(slot.edge))
            for slot, entry in zip(self.own.slots, self.own.entries, strict=True)
        ]
        return all_of([*known, *(way.possible.implies(any_of(way.offered)) for way in self.all_ways)])

    def follows(self, index: int) -> Bool:
        """Return whether an offer is a track on which the vehicle may be."""
        return any_of(way.possible & way.offered[index] for way in self.all_ways)

    def agrees(self, offer: Offer) -> Bool:
        """Return whether position, group, turn and start permit a track."""
        own = self.own
        group = ~own.group_edge.present | (own.group_edge.value.eq(offer.edge) & self.group_fits(offer))
        turn = own.course_taken.eq(NO_COURSE) | offer.course.eq(NO_COURSE) | own.course_taken.eq(offer.course)
        start = ~own.start_given | (own.start_edge.eq(offer.edge) & own.start_origin.eq(offer.origin))
        return all_of([self.may_be_on(offer.origin, offer.length), group, turn, start])

    def group_fits(self, offer: Offer) -> Bool:
        """Return whether the interval has a place in common with that which the group gives on the edge."""
        place, error = offer.origin + self.own.group_place, self.own.group_error
        return (self.own.low <= place + error) & (self.own.high >= place - error)

    @property
    def kept(self) -> tuple[Bool, ...]:
        """For each offer: it is carried after this cycle."""
        return tuple(self.follows(index) & self.agrees(offer) for index, offer in enumerate(self.own.offers))

    @property
    def begins(self) -> Bool:
        """A start gives the track, and the position lies on it."""
        return self.located & self.own.start_given & self.may_be_on(self.own.start_origin, self.own.start_length)


def _same(offer: Offer, slot: Slot) -> Bool:
    return offer.edge.eq(slot.edge) & offer.origin.eq(slot.origin) & offer.length.eq(slot.length)


def _led(joint: Joint) -> Iterator[tuple[Num, Bool]]:
    """Yield each edge of a joint, and whether the points may lead to it."""
    yield joint.first, joint.first.ne(NO_EDGE) & joint.points.ne(SECOND)
    yield joint.second, joint.second.ne(NO_EDGE) & joint.points.ne(FIRST)


def on_one_edge(edges: tuple[Num, ...], there: tuple[Bool, ...]) -> Bool:
    """Return whether all tracks that are there have the same edge."""
    pairs = [(one, other) for one in range(len(edges)) for other in range(one)]
    return all_of(~there[one] | ~there[other] | edges[one].eq(edges[other]) for one, other in pairs)
