"""The world of the occupied track: the vehicle on its edge, the joints that it passes, and what map, points and groups keep.

Only what is said of the TRUE edge is bound by a law. Whatever the map states of edges on which the vehicle is not may be wrong: it
costs the position, and never makes a track known that is not the true one.
"""

from __future__ import annotations

from collections.abc import Callable

from safeloc.language.expr import Bool, Num, all_of, between, exact_to, ite
from safeloc.language.units import NM
from safeloc.language.world import Law, World
from safeloc.models.occupied_track.variables import FIRST, NO_EDGE, NOT_KNOWN, SECOND, Joint, Offer, Parts
from safeloc.models.turn_off import UNDECIDED as NO_COURSE
from safeloc.models.turn_off.seen_course import TAKEN, seen_course_law

POSITION = "a position that is given holds the front end"
"""The clause that a localizer can guarantee."""


def world(own: Parts) -> World:
    """Return the world."""
    seen = own.ghosts
    return own.declared.world(
        moves={
            seen.truth: seen.next_truth,
            seen.edge: _edge(own),
            seen.origin: _origin(own),
            seen.length: _length(own),
            seen.place: seen.next_truth - exact_to(_origin(own), NM),
        },
        clauses={
            POSITION: _position_law(own),
            "a vehicle passes one joint in a cycle": _joint_law(own),
            "the map has the edge that is entered": _ways_law(own),
            "points lead where they are stated to lead": _points_law(own),
            "the map has the length of the true edge": _length_law(own),
            "a start names the true track": _start_law(own),
            "a group is read on the true edge": _group_law(own),
            TAKEN: seen_course_law(own.course_taken, seen.course),
            "the map has the course of the true track": _course_law(own),
            "a movement that is excluded does not happen": _movement_law(own),
        },
    )


def on_its_edge(own: Parts) -> Bool:
    """Return whether the front end is on its edge, at its place: so it is at first, and a vehicle that passes one joint in a cycle stays so."""
    seen = own.ghosts
    start = exact_to(seen.origin, NM)
    return between(start, seen.truth, start + exact_to(seen.length, NM)) & seen.place.eq(seen.truth - start)


# ------------------------------------------------------------------ where the vehicle goes


def _ahead(own: Parts) -> Bool:
    """Return whether the front end runs over the end of its edge."""
    seen = own.ghosts
    return seen.next_truth > exact_to(seen.origin + seen.length, NM)


def _behind(own: Parts) -> Bool:
    """Return whether the front end runs back over the beginning of its edge."""
    return own.ghosts.next_truth < exact_to(own.ghosts.origin, NM)


def _edge(own: Parts) -> Num:
    return ite(_ahead(own) | _behind(own), own.ghosts.entered_edge, own.ghosts.edge)


def _length(own: Parts) -> Num:
    return ite(_ahead(own) | _behind(own), own.ghosts.entered_length, own.ghosts.length)


def _origin(own: Parts) -> Num:
    """Return the coordinate at which the true edge begins after the cycle: the joint that was passed is at the same one."""
    seen = own.ghosts
    back = ite(_behind(own), seen.origin - seen.entered_length, seen.origin)
    return ite(_ahead(own), seen.origin + seen.length, back)


def _is_true(own: Parts, offer: Offer) -> Bool:
    return _of(offer.edge, _edge(own)) & offer.origin.eq(_origin(own))


def _of(stated: Num, edge: Num) -> Bool:
    """Return whether the map states something of this edge; what it states of no edge says nothing."""
    return stated.ne(NO_EDGE) & stated.eq(edge)


# ------------------------------------------------------------------ the laws


def _position_law(own: Parts) -> Law:
    low, high = exact_to(own.low, NM), exact_to(own.high, NM)
    return Law(
        (own.located & (own.low <= own.high)).implies(between(low, own.ghosts.next_truth, high)),
        "While the localizer gives a position, the interval from min to max safe front end holds the front end.",
        source="[D] containment of the localizer, whose own proof it is",
        owner="supplier",
        check="replayed recordings with a known true position",
        shares="an interval whose ends are exchanged is no position, for the machine as for the law, which says nothing of it",
    )


def _joint_law(own: Parts) -> Law:
    start = exact_to(_origin(own), NM)
    return Law(
        between(start, own.ghosts.next_truth, start + exact_to(_length(own), NM)),
        "No edge of the map is shorter than what the vehicle runs in a cycle, so after a cycle its front end is on its edge or on one that "
        "joins it.",
        ("shortest_edge_mm", "max_speed_mm_s", "period_ms"),
        "[D] between two switches lie more than 4.5 m",
        "infrastructure",
        "audit of the map: the lengths of its edges",
    )


def _at_joints(own: Parts, law: Callable[[Joint], Bool]) -> Bool:
    """Return whether a law of the passed joint holds in each entry of the map for the true edge."""
    terms: list[Bool] = []
    for entry in own.entries:
        of_true = _of(entry.edge, own.ghosts.edge)
        terms.append((of_true & _ahead(own)).implies(law(entry.ahead)))
        terms.append((of_true & _behind(own)).implies(law(entry.behind)))
    return all_of(terms)


def _ways_law(own: Parts) -> Law:
    def names(joint: Joint) -> Bool:
        return own.ghosts.entered_edge.eq(joint.first) | own.ghosts.entered_edge.eq(joint.second)

    return Law(
        _at_joints(own, names),
        "The map's entry for the edge on which the vehicle is names, at each end, every edge on which a vehicle may go on from there; there "
        "are two at most.",
        source="[D] a switch has two legs; a three-way switch is two switches",
        owner="infrastructure",
        check="survey of the line; audit of the map; the look-up is tested with the map",
    )


def _points_law(own: Parts) -> Law:
    def leads(joint: Joint) -> Bool:
        first, second = own.ghosts.entered_edge.eq(joint.first), own.ghosts.entered_edge.eq(joint.second)
        return joint.points.eq(NOT_KNOWN) | (joint.points.eq(FIRST) & first) | (joint.points.eq(SECOND) & second)

    return Law(
        _at_joints(own, leads),
        "If a position of the points at a joint is stated, then the vehicle that passes the joint in this cycle goes where they lead.",
        source="[D] interlocking: points are locked and detected while a train is on them",
        owner="infrastructure",
        check="detection of the points; the age of the message is supervised",
    )


def _length_law(own: Parts) -> Law:
    return Law(
        all_of(_of(one.edge, _edge(own)).implies(one.length.eq(_length(own))) for one in own.offers),
        "The length that the map states of the edge on which the vehicle is, is that edge's. Coordinates along a track are sums of these "
        "lengths, so what survey and track differ is part of the error of the position.",
        ("longest_edge_mm",),
        "[D] the localizer's coordinates come from the same map",
        "infrastructure",
        "version and checksum of the map on board",
    )


def _start_law(own: Parts) -> Law:
    right = own.start_edge.eq(_edge(own)) & own.start_origin.eq(_origin(own)) & own.start_length.eq(_length(own))
    return Law(
        own.start_given.implies(right),
        "A start names the edge on which the front end is, the coordinate at which it begins, and its length.",
        source="[D] a balise group whose place is on the announced route, or an entry by the driver that is checked",
        owner="infrastructure",
        check="linking of the balise machine; identities of groups are unique",
    )


def _group_law(own: Parts) -> Law:
    error = exact_to(own.group_error, NM)
    off = own.ghosts.next_truth - exact_to(_origin(own) + own.group_place, NM)
    return Law(
        own.group_edge.present.implies(own.group_edge.value.eq(_edge(own)) & between(-error, off, error)),
        "A group that tells the track lies on the edge on which the front end is when it has been read, and the front end is there where the "
        "group puts it, within the error that comes with it.",
        source="[D] layout rule: from a group that tells the track to the next joint it is farther than from the antenna to the front end, "
        "and a cycle's run",
        owner="infrastructure",
        check="audit of the map: groups near joints; identities of groups are unique",
    )


def _course_law(own: Parts) -> Law:
    right = [_is_true(own, one).implies(one.course.one_of(NO_COURSE, own.ghosts.course)) for one in own.offers]
    return Law(
        all_of(right),
        "If the map states the course by which the true track leaves the watched switch, the vehicle takes that course.",
        source="[D] the map is looked up for the switch that the turn-off machine watches",
        owner="infrastructure",
        check="audit of the map; the look-up is tested with the map",
    )


def _movement_law(own: Parts) -> Law:
    seen = own.ghosts
    return Law(
        own.surely_not_ahead.implies(seen.next_truth <= seen.truth)
        & own.surely_not_back.implies(seen.next_truth >= seen.truth),
        "If it is excluded that the vehicle ran ahead in a cycle, or back, it did not.",
        source="[M] cold movement detection, direction of the wheel's pulses",
        owner="supplier",
        check="type test of the direction of wheel pulses",
    )
