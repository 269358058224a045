"""Properties of the reflector device with its route: the branch that is told is the true one, and a lost route ends the position (RFL-D6, RFL-12, RFL-D3).

What the route machine claims by itself it keeps here of the vehicle that balises and reflectors locate, with fewer laws. Beside it stand claims on the
wires: a route that begins from a raw telegram, or that nobody hears, would keep every other claim.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import partial

from safeloc.language.expr import Bool, Lit, Num, NumVar, all_of, any_of, as_num, before, between, exact_to, ite
from safeloc.language.spec import Property, always, earlier_bool
from safeloc.language.units import COUNT, NM
from safeloc.models.reflector.echo import Slot
from safeloc.models.reflector_device import ReflectorDevice
from safeloc.models.route import variables as routes
from safeloc.models.turn_off.variables import UNDECIDED
from safeloc.models.vocabulary.reasons import CONTRADICTION, NO_REFERENCE, SENSOR_FAILURE, TOLERANCE
from safeloc.models.vocabulary.reflectors import MAX_ERROR_MM, NO_MODEL
from safeloc.properties import route as route_claims
from safeloc.properties.hearing import hears_value
from safeloc.properties.reflector_device.host import LAW as SENSORS
from safeloc.properties.reflector_device.host import (
    accepted,
    astray,
    carrying,
    flag,
    interval_of,
    lost_route,
    of_source,
    other_route,
    restrictive,
    withdrawn,
)
from safeloc.properties.reflector_words import says_why
from safeloc.properties.turn_off import LAW as IMAGES

LAW = (
    f"{SENSORS}; {IMAGES}; a start that names any route names the true one; an echo that shows a model is that of a reflector: beside the "
    "true route, within its error, and the map names it there; or beside another track, which the map has in view of the true route, and not where a "
    "near reflector of the own track stands"
)
REQUIREMENTS = ("RFL-D6",)
_OF_THE_ROUTE = (
    "the true route is carried",
    "the decided route is true",
    "containment",
    "a right authority is never refuted",
)
_REASONS: Mapping[Lit, Lit] = {
    routes.NO_START: NO_REFERENCE,
    routes.CONTRADICTION: CONTRADICTION,
    routes.TOLERANCE: TOLERANCE,
    routes.SENSOR_FAILURE: SENSOR_FAILURE,
}
"""Reasons of the route machine, in the words of the host."""
for_all_inputs = partial(always, requirements=REQUIREMENTS, unconditional=True)
under_assumption = partial(always, requirements=REQUIREMENTS, assumption=LAW)


def properties(whole: ReflectorDevice) -> list[Property]:
    """Return the properties of the whole device that concern its route."""
    makers = (
        _branch, _branches, _others, _too_many, _lost, _only_lost, _told_why, _told_refuted,
        _told_by_reflectors, _starts, _candidates, _near_the_start, _sightings,
        _courses,
    )  # fmt: skip
    return [prop for maker in makers for prop in maker(whole)]


# ------------------------------------------------------------------ the branch that is told, and those that are carried


def _branch(whole: ReflectorDevice) -> Iterator[Property]:
    for claim in route_claims.properties(whole.route):
        if claim.name in _OF_THE_ROUTE:
            yield replace(whole.composition.inherited(whole.route.machine, claim), assumption=LAW)
    machine = whole.route.machine
    told = flag(whole, machine, "valid")
    number = whole.composition.of(machine).num(machine.output("route"))
    only = all_of(number.eq(one.number).iff(told & _possible(whole, one.possible)) for one in whole.route.own.routes)
    yield for_all_inputs(
        "a branch is told only where no other is possible",
        told.iff(_count(whole).eq(1)) & only & (number > 0).iff(told),
        statement="a branch is told exactly while one route is possible, and it is that one",
    )


def _branches(whole: ReflectorDevice) -> Iterator[Property]:
    own, into, heard = (
        whole.route.own,
        whole.composition.of(whole.route.machine),
        whole.composition.of(whole.source.machine),
    )
    unshown = all_of(heard.bool(~_shows(whole, slot)) for slot in whole.source.own.slots)
    nothing = all_of([unshown, into.num(own.course_taken).eq(UNDECIDED), ~into.bool(own.start_error.present)])
    kept = all_of(
        _possible(whole, one.possible).iff(earlier_bool(_possible(whole, one.possible))) for one in own.routes
    )
    yield for_all_inputs(
        "an undecided switch leaves every branch",
        all_of([nothing, carrying(whole)]).implies(kept),
        statement="in a cycle in which no echo shows a model, no turn is seen and no route begins, every route that was possible stays possible, and no other "
        "becomes possible, unless all are given up",
    )


def _others(whole: ReflectorDevice) -> Iterator[Property]:
    own, into = whole.route.own, whole.composition.of(whole.route.machine)
    heard = whole.composition.of(whole.source.machine)
    near = any_of(
        all_of([heard.bool(_shows(whole, one)), _stands_by_own_track(whole, one)]) for one in whole.source.own.slots
    )
    turned, begun = into.num(own.course_taken).ne(UNDECIDED), into.bool(own.start_error.present)
    left = all_of(
        (earlier_bool(_possible(whole, one.possible)) & into.bool(one.other_in_view)).implies(
            _possible(whole, one.possible)
        )
        for one in own.routes
    )
    yield for_all_inputs(
        "another track's reflector in view leaves the branch",
        any_of([near, turned, begun, ~carrying(whole)]) | left,
        statement="in a cycle in which no echo with a model is near and on the own track's side, no turn is seen and no route begins, a route stays possible "
        "from which the map has such a reflector of another track in view, unless all are given up",
    )


def _too_many(whole: ReflectorDevice) -> Iterator[Property]:
    begun = whole.composition.of(whole.route.machine).bool(whole.route.own.start_error.present)
    ahead = whole.composition.of(whole.starts.machine).num(whole.starts.routes_ahead)
    yield for_all_inputs(
        "more branches than are carried are no position",
        (begun & (ahead > whole.config.route.routes)).implies(lost_route(whole) & restrictive(whole)),
        statement="in a cycle in which the vehicle starts where more routes begin than are carried, the route is lost and the host gets no position",
    )


# ------------------------------------------------------------------ a lost route ends the position


def _lost(whole: ReflectorDevice) -> Iterator[Property]:
    for name, against, words, requirements in (
        ("a lost route withdraws the position", lost_route(whole), "no route is left, and up to the next start", ("RFL-D6", "RFL-D3")),
        (
            "a refuted authority withdraws the position", any_of([other_route(whole), astray(whole)]),
            "the route of the movement authority is impossible, or the course at a switch is not the permitted one", ("RFL-12", "RFL-D6"),
        ),
    ):  # fmt: skip
        had = earlier_bool(of_source(whole, "valid") & against)
        yield for_all_inputs(
            name,
            against.implies(restrictive(whole)) & had.implies(withdrawn(whole)),
            statement=f"in each cycle in which {words}, the host has no position; one that the reflector machine has then is withdrawn in the next cycle",
            requirements=requirements,
        )


def _only_lost(whole: ReflectorDevice) -> Iterator[Property]:
    yield for_all_inputs(
        "no position without a branch",
        (~restrictive(whole)).implies(carrying(whole)),
        statement="the host has a position only in cycles in which a route is possible",
    )
    yield for_all_inputs(
        "only a start ends a lost route",
        (earlier_bool(lost_route(whole)) & ~lost_route(whole)).implies(
            whole.composition.of(whole.route.machine).bool(whole.route.own.start_error.present)
        ),
        statement="a lost route is lost up to a cycle in which a group passed every check and routes begin there",
    )


def _told(whole: ReflectorDevice) -> Num:
    """Return the reason that the restrictive state hears."""
    [heard] = [one for one in whole.restrictive.inputs if isinstance(one, NumVar) and one.name == "source_reason"]
    return whole.composition.of(whole.restrictive).num(heard)


def _refuted(whole: ReflectorDevice) -> Bool:
    """Return whether course or route are not the permitted ones."""
    return other_route(whole) | astray(whole)


def _told_why(whole: ReflectorDevice) -> Iterator[Property]:
    why, told = _why(whole), _told(whole)
    in_words = all_of(why.eq(of_route).implies(told.eq(for_host)) for of_route, for_host in _REASONS.items())
    yield for_all_inputs(
        "the host is told why no branch is carried",
        any_of([carrying(whole), _refuted(whole), in_words]),
        statement="without a branch the restrictive state hears the reason of the route machine, which is the host's if the position is lost then: no start, a contradiction, an interval too wide, a silent odometer; "
        "unless course or route are not the permitted ones",
    )


def _told_refuted(whole: ReflectorDevice) -> Iterator[Property]:
    yield for_all_inputs(
        "the host is told that course or route are not the permitted ones",
        _refuted(whole).implies(_told(whole).eq(CONTRADICTION)),
        statement="in each cycle in which the route of the movement authority is impossible, or the course at a switch is not the permitted one, the "
        "restrictive state hears a contradiction, which is the host's reason if the position is lost then",
        requirements=("RFL-12", *REQUIREMENTS),
    )


def _told_by_reflectors(whole: ReflectorDevice) -> Iterator[Property]:
    source = whole.source.machine
    error = whole.composition.of(source).num(source.output("error"))
    yield for_all_inputs(
        "the host is told the reflector machine's reason on a branch",
        (carrying(whole) & ~_refuted(whole)).implies(says_why(_told(whole), error)),
        statement="while a branch is carried, and course and route are the permitted ones, the restrictive state hears the reflector machine's reason",
        requirements=("RFL-D3", *REQUIREMENTS),
    )


# ------------------------------------------------------------------ what a route begins from


def _starts(whole: ReflectorDevice) -> Iterator[Property]:
    own, into = whole.route.own, whole.composition.of(whole.route.machine)
    map_ = whole.composition.of(whole.starts.machine)
    position, below, above = interval_of(whole, whole.groups.machine)
    place = map_.num(whole.starts.place.value)
    behind, ahead = place - position + below, position - place + above
    farther = ite(behind > ahead, behind, ahead)
    few = farther <= whole.config.route.start_error_mm
    given = all_of([accepted(whole), map_.bool(whole.starts.place.present), few])
    yield for_all_inputs(
        "a route begins at every accepted group that is a start",
        hears_value(into, own.start_error, given, farther),
        statement="routes begin exactly in the cycles in which the balise machine accepted a group, the map has a start there, and no end of the interval "
        "is farther away than a start may be; the error is the distance to the farther end",
        requirements=("RFL-D6", "RFL-5"),
    )


def _candidates(whole: ReflectorDevice) -> Iterator[Property]:
    own, into = whole.route.own, whole.composition.of(whole.route.machine)
    map_ = whole.composition.of(whole.starts.machine)
    most = map_.num(whole.starts.routes_ahead) <= whole.config.route.routes
    yield for_all_inputs(
        "the map's routes are candidates",
        all_of(
            into.bool(one.candidate).iff(map_.bool(mapped) & most)
            for one, mapped in zip(own.routes, whole.starts.candidates, strict=True)
        ),
        statement="the candidates at a start are those of the map, and none where more begin than are carried",
    )


def _near_the_start(whole: ReflectorDevice) -> Iterator[Property]:
    own, into = whole.route.own, whole.composition.of(whole.route.machine)
    truth, error = whole.motion.own.ghosts.truth, exact_to(into.num(own.start_error.value), NM)
    place = exact_to(whole.composition.of(whole.starts.machine).num(whole.starts.place.value), NM)
    begun, along = into.bool(own.start_error.present), into.num(own.ghosts.truth)
    assert isinstance(along, NumVar)
    yield under_assumption(
        "a start holds the front end",
        begun.implies(between(-error, truth - place, error) & along.eq(truth - place)),
        statement="at a start the true front end is no farther from the start's place than the error that the route begins with, and from there its "
        "distance along the route is counted",
    )
    ran = truth - before(truth)
    yield under_assumption(
        "the distance along the route is that of the vehicle",
        begun | (along - before(along)).eq(ran),
        statement="between two starts the true distance along the route grows by what the front end truly ran",
    )


# ------------------------------------------------------------------ what refutes a route


def _sightings(whole: ReflectorDevice) -> Iterator[Property]:
    own, into = whole.route.own, whole.composition.of(whole.route.machine)
    heard, offset = whole.composition.of(whole.source.machine), whole.config.reflector.radar_offset_mm
    shown = [heard.bool(_shows(whole, slot)) for slot in whole.source.own.slots]
    away, error, model = (into.num(one) for one in (own.sighting_range.value, own.sighting_error, own.sighting_model))
    by_own_track, same = into.bool(own.sighting_by_own_track), list[Bool]()
    for number, slot in enumerate(whole.source.own.slots):
        range_, own_error, shows = (heard.num(one) for one in (slot.range.value, slot.error, slot.model))
        told = all_of([
            away + offset - range_ <= 0, range_ - away <= offset, model.eq(shows),
            error - own_error <= whole.config.sighting_error_mm, own_error - error <= -whole.config.sighting_error_mm,
            by_own_track.iff(_stands_by_own_track(whole, slot)),
        ])  # fmt: skip
        same.append(all_of([shown[number], *(~one for one in shown[:number])]).implies(told))
    yield for_all_inputs(
        "a sighting is an echo that the reflector machine hears",
        all_of(
            [
                into.bool(own.sighting_range.present).iff(any_of(shown)),
                any_of(shown) | (model.eq(NO_MODEL) & ~by_own_track),
                *same,
            ]
        ),
        statement="the route machine hears, of the frame that the reflector machine hears, the first echo with the minimum intensity that shows a "
        "model: that model, the range from the front end, the echo's error with the configured one, and whether it is near and stands on the own "
        "track's side; and nothing else",
        requirements=("RFL-D6", "RFL-10"),
    )


def _shows(whole: ReflectorDevice, slot: Slot) -> Bool:
    """A frame came whose echo is strong, shows a model, is not too close and ahead of the front end, and has an error that can be told."""
    figures = whole.config.reflector
    weak, coarse = (
        slot.intensity < figures.minimum_intensity_cdb,
        slot.error > MAX_ERROR_MM - whole.config.sighting_error_mm,
    )
    behind = slot.range.value < max(figures.radar_offset_mm, figures.near_range_mm)
    return ~any_of(
        [~whole.source.own.frame_present, ~slot.range.present, weak, slot.model.eq(NO_MODEL), behind, coarse]
    )


def _stands_by_own_track(whole: ReflectorDevice, slot: Slot) -> Bool:
    """The echo is near, and comes from between the two sides at which reflectors of the own track stand."""
    heard, figures = whole.composition.of(whole.source.machine), whole.config
    near = heard.num(slot.range.value) <= figures.own_track_range_mm
    aside = heard.num(slot.lateral)
    return all_of([near, aside >= figures.own_track_right_mm, aside <= figures.own_track_left_mm])


def _courses(whole: ReflectorDevice) -> Iterator[Property]:
    own, into = whole.course.own, whole.composition.of(whole.course.machine)
    yield for_all_inputs(
        "the route hears the course at a switch",
        whole.composition.of(whole.route.machine).num(whole.route.own.course_taken).eq(into.num(own.course)),
        statement="the turn that refutes routes is the one that the image of a reflector shows in this cycle",
        requirements=("RFL-D6", "RFL-12"),
    )


# ------------------------------------------------------------------ words


def _possible(whole: ReflectorDevice, term: Bool) -> Bool:
    return whole.composition.of(whole.route.machine).bool(term)


def _count(whole: ReflectorDevice) -> Num:
    """The number of routes that are possible."""
    total = as_num(0, COUNT)
    for one in whole.route.own.routes:
        total = total + ite(_possible(whole, one.possible), as_num(1, COUNT), 0)
    return total


def _why(whole: ReflectorDevice) -> Num:
    return whole.composition.of(whole.route.machine).num(whole.route.own.reason)
