"""Properties of a localizer on a map with switches: the track that is told belongs to the position that the host gets (RFL-13, RFL-D6).

What the occupied track claims by itself it keeps here of the vehicle that the localizer locates, with fewer laws. Beside it stand claims
on the wires: a track of another interval, or one that begins with a refused group, would keep every other claim.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

from safeloc.language.expr import Bool
from safeloc.language.spec import Property, always, earlier_bool
from safeloc.models.localizer_track import LocalizerTrack
from safeloc.properties import localizer as localizer_claims
from safeloc.properties import occupied_track as track_claims
from safeloc.properties.hearing import INTERVAL

LAW = (
    f"{localizer_claims.LAW}; radar images at switches; of the edge on which the vehicle is the map has the length and the edges that join "
    "it; a vehicle passes one joint in a cycle; the map has the track of every accepted group; a group of another branch is read on it; "
    "points lead where they are stated to lead; a movement that is excluded does not happen"
)
REQUIREMENTS = ("RFL-13", "RFL-D6")
_OF_THE_TRACK = (
    "the true track is carried",
    "a track that is told is the true one",
    "containment",
    "one track is told only if no other is possible",
    "one track is told if no other is possible",
    "a place is told with its track only",
    "the possible tracks are listed",
    "the told interval is that of its tracks",
    "more than carried is no position",
)
for_all_inputs = partial(always, requirements=REQUIREMENTS, unconditional=True)


def properties(model: LocalizerTrack) -> list[Property]:
    """Return the properties of position and track together."""
    return [*_position(model), *_kept(model), *_heard(model)]


def _restrictive(model: LocalizerTrack) -> Bool:
    guard = model.localizer.guard
    return model.composition.of(guard).bool(guard.flag("restrictive"))


def _carrying(model: LocalizerTrack) -> Bool:
    machine = model.track.machine
    return model.composition.of(machine).num(machine.output("tracks")) > 0


def _accepted(model: LocalizerTrack) -> Bool:
    return model.composition.of(model.groups).bool(model.groups.flag("reference_accepted"))


def _position(model: LocalizerTrack) -> Iterator[Property]:
    """Yield what the host is promised of the position itself."""
    for claim in localizer_claims.properties(model.localizer):
        if claim.name == "containment":
            yield replace(claim, name="the position holds the front end", assumption=LAW)


def _kept(model: LocalizerTrack) -> Iterator[Property]:
    for claim in track_claims.properties(model.track):
        if claim.name in _OF_THE_TRACK:
            kept = model.composition.inherited(model.track.machine, claim)
            yield replace(kept, assumption=LAW if kept.assumption else "", requirements=REQUIREMENTS)


def _heard(model: LocalizerTrack) -> Iterator[Property]:
    own, machine = model.track.own, model.track.machine
    into, guard = model.composition.of(machine), model.localizer.guard
    position, below, above = (model.composition.of(guard).num(guard.output(name)) for name in INTERVAL)
    passed = ~_restrictive(model)
    same = (into.num(own.high) - above).eq(position) & (into.num(own.low) + below).eq(position)
    yield for_all_inputs(
        "the track is that of the host's position",
        into.bool(own.located).iff(passed) & passed.implies(same),
        statement="the track has an interval in exactly the cycles in which the host gets one, and that very interval",
    )
    yield for_all_inputs(
        "no track without the host's position",
        _restrictive(model).implies(~_carrying(model)),
        statement="while the vehicle is restrictive, no track is told or listed",
    )
    yield for_all_inputs(
        "a refused group begins no track",
        (~earlier_bool(_carrying(model)) & _carrying(model)).implies(_accepted(model)),
        statement="a track begins only in a cycle in which the balise machine accepted a group",
    )
    yield for_all_inputs(
        "every accepted group names its track",
        into.bool(own.start_given).iff(_accepted(model)),
        statement="the map is asked for the track of a group in exactly the cycles in which the balise machine accepted one",
    )
    course = model.composition.of(model.course.machine).num(model.course.machine.output("course"))
    yield for_all_inputs(
        "the track hears the course at a switch",
        into.num(own.course_taken).eq(course),
        statement="the turn that ends tracks is the one that the image of a reflector shows in this cycle",
    )
    watching = model.composition.of(model.course.machine)
    low, high = watching.num(model.course.own.low), watching.num(model.course.own.high)
    limit = model.config.turn_off.position_limit_mm
    near = (high.eq(position + above) | (position + above > limit)) & (
        low.eq(position - below) | (position - below < -limit)
    )
    yield for_all_inputs(
        "a switch is watched by the host's position",
        passed.implies(near) & _restrictive(model).implies(high.eq(limit) & low.eq(-limit)),
        statement="the course at a switch is judged by the interval that the host gets; by the whole line while there is none",
    )
