"""Properties of the occupied track: the true edge is carried, one is told only if no other is possible, and none ends without a reason (RFL-D6).

Claims speak of what the vehicle was told in the cycle and of what was carried before it, in terms of their own: how far the interval
reaches beyond an edge, and by how much a place that is read lies outside it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

from safeloc.language.expr import Bool, Num, all_of, any_of, as_num, before, between, exact_to, ite
from safeloc.language.spec import Property, always, earlier_bool, reachable
from safeloc.language.units import COUNT, MM, NM
from safeloc.models.occupied_track import OccupiedTrack
from safeloc.models.occupied_track.variables import (
    CONTRADICTION,
    FIRST,
    NO_POSITION,
    NO_REASON,
    NOT_ALL_CARRIED,
    SECOND,
    Joint,
    Offer,
    Slot,
)
from safeloc.models.turn_off import UNDECIDED
from safeloc.models.vocabulary.absent import NO_POSITION_MM
from safeloc.properties.no_interval import no_interval

LAW = (
    "the localizer's interval holds the front end; of the edge on which the vehicle is the map has the length and the edges that join it; "
    "a vehicle passes one joint in a cycle; a start names the true track; a group is read on it; a turn that is seen is taken; points "
    "lead where they are stated to lead; a movement that is excluded does not happen"
)
REQUIREMENTS = ("RFL-D6",)
for_all_inputs = partial(always, requirements=REQUIREMENTS, unconditional=True)
under_assumption = partial(always, requirements=REQUIREMENTS, assumption=LAW)


def properties(model: OccupiedTrack) -> list[Property]:
    """Return every property of the machine."""
    makers = (_true, _told, _silent, _reasons, _starts, _followed, _ended, _taken, _reached)
    return [prop for maker in makers for prop in maker(model)]


# ------------------------------------------------------------------ terms of the claims


def _carrying(model: OccupiedTrack) -> Bool:
    """Return whether the machine carries tracks."""
    return model.machine.mode.one_of(*model.machine.modes[1:3])


def _went_on(model: OccupiedTrack) -> Bool:
    """Return whether it carried tracks before the cycle and still does."""
    return earlier_bool(_carrying(model)) & _carrying(model)


def _there(slot: Slot) -> Bool:
    return slot.edge > 0


def _on(model: OccupiedTrack, slot: Slot) -> tuple[Num, Num]:
    """Return the reported interval on a carried edge."""
    low, high = (model.machine.output(f"track_{slot.number}_{end}_mm") for end in ("low", "high"))
    return low, high


def _located(model: OccupiedTrack) -> Bool:
    """Return whether the localizer gives an interval."""
    own = model.own
    return ~((own.high - own.low < 0) | ~own.located)


def _beside(model: OccupiedTrack, start: Num, length: Num) -> Bool:
    """Return whether the whole interval lies off an edge."""
    own = model.own
    return (start - own.high > 0) | (own.low - start > length)


@dataclass(frozen=True, eq=False)
class _Possible:
    """A track on which the vehicle may be in the cycle, from one that was carried: when, in words, and which offer it is."""

    words: str
    when: Bool
    offered: tuple[Bool, ...]


def _possible(model: OccupiedTrack, index: int) -> Iterator[_Possible]:
    """Yield the tracks that follow from a slot: its own edge, and the two at each end."""
    own, slot, entry = model.own, model.own.slots[index], model.own.entries[index]
    was, start, length = before(slot.edge), before(slot.origin), before(slot.length)
    was_there = was > 0
    stays = tuple(one.origin.eq(start) & _ends_at(one, start + length) & one.edge.eq(was) for one in own.offers)
    yield _Possible("its own edge", was_there & ~_beside(model, start, length), stays)
    over = was_there & (own.high - start > length) & ~own.surely_not_ahead
    for which, edge in _at(entry.ahead):
        leads = (edge > 0) & _leads(entry.ahead, which)
        begins = tuple((one.origin - start).eq(length) & one.edge.eq(edge) for one in own.offers)
        yield _Possible(f"the {which} edge ahead", over & leads, begins)
    back = was_there & (start - own.low > 0) & ~own.surely_not_back
    for which, edge in _at(entry.behind):
        leads = (edge > 0) & _leads(entry.behind, which)
        ends = tuple(_ends_at(one, start) & one.edge.eq(edge) for one in own.offers)
        yield _Possible(f"the {which} edge behind", back & leads, ends)


def _ends_at(offer: Offer, place: Num) -> Bool:
    """Return whether the end of an offered edge is at a place along the route."""
    return (offer.origin + offer.length).eq(place)


def _at(joint: Joint) -> Iterator[tuple[str, Num]]:
    yield "first", joint.first
    yield "second", joint.second


def _leads(joint: Joint, which: str) -> Bool:
    """Return whether the points do not exclude one of the edges."""
    return joint.points.ne(SECOND if which == "first" else FIRST)


def _position_excludes(model: OccupiedTrack, offer: Offer) -> Bool:
    """Return whether the whole interval lies off a track."""
    return _beside(model, offer.origin, offer.length)


def _group_excludes(model: OccupiedTrack, offer: Offer) -> Bool:
    """Return whether the group that was read stands on another edge, or farther from the interval than its error."""
    own = model.own
    place, error = own.group_place + offer.origin, own.group_error
    elsewhere = own.group_edge.value.ne(offer.edge) | (own.low - place > error) | (place - own.high > error)
    return own.group_edge.present & elsewhere


def _turn_excludes(model: OccupiedTrack, offer: Offer) -> Bool:
    own = model.own
    return all_of([own.course_taken.ne(UNDECIDED), offer.course.ne(UNDECIDED), offer.course.ne(own.course_taken)])


def _start_excludes(model: OccupiedTrack, offer: Offer) -> Bool:
    own = model.own
    return own.start_given & (own.start_edge.ne(offer.edge) | own.start_origin.ne(offer.origin))


def _excluded(model: OccupiedTrack, offer: Offer) -> Bool:
    """Return whether what the vehicle was told in the cycle excludes a track."""
    makers = (_position_excludes, _group_excludes, _turn_excludes, _start_excludes)
    return any_of(one(model, offer) for one in makers)


def _unknown_joint(model: OccupiedTrack) -> Bool:
    """Return whether the vehicle may have passed a joint that the map does not state."""
    own, terms = model.own, list[Bool]()
    for slot, entry in zip(own.slots, own.entries, strict=True):
        start, length = before(slot.origin), before(slot.length)
        over = (own.high - start > length) & ~own.surely_not_ahead
        back = (start - own.low > 0) & ~own.surely_not_back
        terms.append((before(slot.edge) > 0) & entry.edge.ne(before(slot.edge)) & (over | back))
    return any_of(terms)


def _not_offered(model: OccupiedTrack) -> Bool:
    """Return whether the map offers no place for a track on which the vehicle may be."""
    ways = [way for index in range(len(model.own.slots)) for way in _possible(model, index)]
    return _unknown_joint(model) | any_of(way.when & all_of(~one for one in way.offered) for way in ways)


# ------------------------------------------------------------------ what is true


def _true(model: OccupiedTrack) -> Iterator[Property]:
    machine, seen = model.machine, model.own.ghosts
    holds = []
    for slot in model.own.slots:
        low, high = _on(model, slot)
        inside = between(exact_to(low, NM), seen.place, exact_to(high, NM))
        holds.append(slot.edge.eq(seen.edge) & slot.origin.eq(seen.origin) & inside)
    yield under_assumption(
        "the true track is carried",
        _carrying(model).implies(any_of(holds)),
        statement="while the machine carries any track, the edge on which the front end is, is among them, and the interval on it holds the true place",
    )
    yield under_assumption(
        "a track that is told is the true one",
        machine.flag("valid").implies(machine.output("edge").eq(seen.edge)),
        statement="the edge that the host is told is the one on which the front end is",
    )
    position, below, above = (machine.output(f"{name}_mm") for name in ("position", "margin_below", "margin_above"))
    yield under_assumption(
        "containment",
        machine.flag("valid").implies(
            between(exact_to(position - below, NM), seen.place, exact_to(position + above, NM))
        ),
        statement="while an edge is told, the interval along it holds the true place of the front end on that edge",
    )


# ------------------------------------------------------------------ what the host is told


def _told(model: OccupiedTrack) -> Iterator[Property]:
    machine, slots = model.machine, model.own.slots
    valid, edge = machine.flag("valid"), machine.output("edge")
    others = any_of(_there(slot) & slot.edge.ne(edge) for slot in slots)
    yield for_all_inputs(
        "one track is told only if no other is possible",
        valid.implies((edge > 0) & any_of(slot.edge.eq(edge) for slot in slots) & ~others),
        statement="if an edge is told, it is carried, and every carried track is on it",
    )
    apart = [
        _there(one) & _there(other) & one.edge.ne(other.edge)
        for one in slots
        for other in slots
        if one.number < other.number
    ]
    yield for_all_inputs(
        "one track is told if no other is possible",
        _carrying(model).implies(valid | any_of(apart)),
        statement="if every carried track is on one edge, that edge is told",
    )
    yield for_all_inputs(
        "a place is told with its track only",
        (~valid).implies(edge.eq(0) & no_interval(machine)),
        statement="while the edge is not known, neither an edge nor a place on one is told",
    )
    counted = as_num(0, COUNT)
    for slot in slots:
        counted = counted + ite(_there(slot), as_num(1, COUNT), 0)
    yield for_all_inputs(
        "the possible tracks are listed",
        machine.output("tracks").eq(counted)
        & all_of(machine.output(f"track_{slot.number}_edge").eq(slot.edge) for slot in slots)
        & all_of(
            machine.output(f"track_{slot.number}_origin_mm").eq(ite(_there(slot), slot.origin, NO_POSITION_MM))
            for slot in slots
        ),
        statement="every carried track is told to the host, with the coordinate at which its edge begins and the number of tracks",
    )
    yield for_all_inputs(
        "the told interval is that of its tracks",
        all_of(_as_narrow(model)),
        statement="the interval told with an edge begins where that of a carried track begins, and ends where that of one ends; that of a "
        "track is the localizer's on that edge, and within its ends",
    )


def _as_narrow(model: OccupiedTrack) -> Iterator[Bool]:
    """Widths: an interval that is wider than the tracks' would hold the truth as well."""
    machine, own = model.machine, model.own
    position, below, above = (machine.output(f"{name}_mm") for name in ("position", "margin_below", "margin_above"))
    lowest, highest = list[Bool](), list[Bool]()
    for slot in own.slots:
        low, high = _on(model, slot)
        lowest.append(_there(slot) & low.eq(position - below))
        highest.append(_there(slot) & high.eq(position + above))
        start, end = as_num(0, MM), slot.length
        inside = (
            (low >= start)
            & (high <= end)
            & (low + slot.origin >= own.given_low)
            & (high + slot.origin <= own.given_high)
        )
        yield _there(slot).implies(inside & (low <= high))
        yield _there(slot) | (low.eq(NO_POSITION_MM) & high.eq(NO_POSITION_MM))
    yield machine.flag("valid").implies(any_of(lowest) & any_of(highest))
    yield _carrying(model).implies(own.given_low.eq(own.low) & own.given_high.eq(own.high))


def _silent(model: OccupiedTrack) -> Iterator[Property]:
    slots = model.own.slots
    yield for_all_inputs(
        "nothing is carried without a start",
        _carrying(model).iff(any_of(_there(slot) for slot in slots)),
        statement="in IDLE and LOST no track is carried, otherwise at least one",
    )
    yield for_all_inputs(
        "no resurrection",
        (_carrying(model) & ~earlier_bool(_carrying(model))).implies(model.own.start_given & _located(model)),
        statement="once no track is carried, only a start on a given position begins anew",
    )
    yield for_all_inputs(
        "what is given up leaves nothing behind",
        all_of(
            _there(slot) | (slot.origin.eq(0) & slot.length.eq(model.own.config.shortest_edge_mm)) for slot in slots
        ),
        statement="a slot without a track has no place and no length of an earlier one, so equal tracks are equal states and equal snapshots",
    )
    yield for_all_inputs(
        "without a position nothing is told",
        _carrying(model).implies(_located(model)),
        statement="in a cycle in which the localizer gives no position, no track is carried",
    )


# ------------------------------------------------------------------ why nothing is carried


def _reasons(model: OccupiedTrack) -> Iterator[Property]:
    own = model.own
    reason, lost = own.reason, earlier_bool(_carrying(model)) & ~_carrying(model)
    yield for_all_inputs(
        "reason stated",
        reason.eq(NO_REASON).iff(_carrying(model)),
        statement="the machine gives a reason exactly while it carries no track",
    )
    yield for_all_inputs(
        "given up for the position only without one",
        lost.implies(reason.eq(NO_POSITION).iff(~_located(model))),
        statement="the machine gives the tracks up for the position exactly if the localizer gives none",
    )
    yield for_all_inputs(
        "more than carried is no position",
        (earlier_bool(_carrying(model)) & _not_offered(model)).implies(~_carrying(model)),
        statement="if the vehicle may be on a track for which there is no slot, or may have passed a joint that the map does not state, nothing is told",
    )
    yield for_all_inputs(
        "given up for too many only then",
        lost.implies(reason.eq(NOT_ALL_CARRIED).iff(_located(model) & _not_offered(model))),
        statement="the machine gives the tracks up for their number exactly if a track on which the vehicle may be is not offered, or a joint is "
        "not stated",
    )
    ways = [way for index in range(len(own.slots)) for way in _possible(model, index)]
    fits = [
        way.when & one & ~_excluded(model, offer)
        for way in ways
        for one, offer in zip(way.offered, own.offers, strict=True)
    ]
    yield for_all_inputs(
        "a contradiction is that no track fits",
        lost.implies(reason.eq(CONTRADICTION).iff(_located(model) & ~_not_offered(model))) & lost.implies(
            reason.eq(CONTRADICTION).implies(~any_of(fits))
        ),
        statement="the machine gives the tracks up for a contradiction exactly if what it is told in the cycle excludes each of them",
    )  # fmt: skip


# ------------------------------------------------------------------ how tracks begin, go on and end


def _starts(model: OccupiedTrack) -> Iterator[Property]:
    own = model.own
    silent, lies = earlier_bool(~_carrying(model)), ~_beside(model, own.start_origin, own.start_length)
    yield for_all_inputs(
        "a start begins on its track",
        (silent & own.start_given & _located(model) & lies).implies(
            model.machine.flag("valid") & model.machine.output("edge").eq(own.start_edge)
        ),
        statement="a start on whose edge the position lies begins, and that edge is told in the same cycle",
    )
    named = any_of(slot.edge.eq(own.start_edge) & slot.origin.eq(own.start_origin) for slot in own.slots)
    others = any_of(
        _there(slot) & (slot.edge.ne(own.start_edge) | slot.origin.ne(own.start_origin)) for slot in own.slots
    )
    yield for_all_inputs(
        "a start leaves its own track",
        (own.start_given & _carrying(model)).implies(named & ~others),
        statement="after a start the machine carries the track that the start names, and no other",
    )


def _followed(model: OccupiedTrack) -> Iterator[Property]:
    """Yield, for each carried track and each way on, that it is carried on unless something excludes it."""
    own = model.own
    for index, slot in enumerate(own.slots):
        ways = tuple(_possible(model, index))
        for words, chosen in (
            ("its own edge", ways[:1]),
            ("what lies ahead", ways[1:3]),
            ("what lies behind", ways[3:]),
        ):
            kept = []
            for way in chosen:
                goes_on = [
                    one & (_same_slot(own.slots[number], own.offers[number]) | _excluded(model, own.offers[number]))
                    for number, one in enumerate(way.offered)
                ]
                kept.append(way.when.implies(any_of(goes_on)))
            yield for_all_inputs(
                f"track {slot.number} goes on along {words}",
                _went_on(model).implies(all_of(kept)),
                statement="where the vehicle may be by the interval, the joints and the points is carried on, unless a group, a turn or a start "
                "excludes it",
            )


def _same_slot(slot: Slot, offer: Offer) -> Bool:
    """Return whether an offer is carried."""
    return all_of([slot.edge.eq(offer.edge), slot.origin.eq(offer.origin), slot.length.eq(offer.length)])


def _ended(model: OccupiedTrack) -> Iterator[Property]:
    """Yield, for each offer and each kind of evidence, that a track that is excluded is not carried."""
    own = model.own
    kinds = (
        ("the position", "the whole interval lies off it", partial(_position_excludes, model)),
        ("a group", "the group that was read stands elsewhere", partial(_group_excludes, model)),
        ("a turn", "the turn that was seen is not its course", partial(_turn_excludes, model)),
    )
    for words, why, excludes in kinds:
        yield for_all_inputs(
            f"a track that {words} excludes is given up",
            all_of(
                (_went_on(model) & excludes(offer)).implies(~_there(slot))
                for slot, offer in zip(own.slots, own.offers, strict=True)
            ),
            statement=f"no track is carried of which {why}",
        )


def _taken(model: OccupiedTrack) -> Iterator[Property]:
    own = model.own
    for number, (slot, offer) in enumerate(zip(own.slots, own.offers, strict=True)):
        ways = [way for index in range(len(own.slots)) for way in _possible(model, index)]
        follows = any_of(way.when & way.offered[number] for way in ways)
        yield for_all_inputs(
            f"offer {number + 1} is taken only if it follows",
            (_went_on(model) & _there(slot)).implies(follows & _same_slot(slot, offer)),
            statement="a track is carried only if it was carried before, or joins one that was, at an end that the vehicle may have passed",
        )


def _reached(model: OccupiedTrack) -> Iterator[Property]:
    machine = model.machine
    yield reachable(
        "a track is known again after several were possible",
        machine.fired("one edge is left"),
        statement="what the vehicle is told can end the other tracks",
        requirements=REQUIREMENTS,
    )
    yield reachable(
        "a group tells the branch",
        machine.fired("one edge is left") & model.own.group_edge.present & model.own.course_taken.eq(UNDECIDED),
        statement="a group that is read can end the other tracks",
        requirements=REQUIREMENTS,
    )
    yield reachable(
        "a turn tells the branch",
        machine.fired("one edge is left")
        & ~model.own.group_edge.present
        & ~model.own.start_given
        & model.own.course_taken.ne(UNDECIDED),
        statement="a turn that is seen can end the other tracks",
        requirements=REQUIREMENTS,
    )
