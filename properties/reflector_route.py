"""Properties of reflectors with the route: the branch that is told is the true one, and a lost route ends the position (RFL-D6, RFL-12, RFL-D3).

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
from safeloc.models.reflector_route import ReflectorRoute
from safeloc.models.route import variables as routes
from safeloc.models.turn_off.variables import UNDECIDED
from safeloc.models.vocabulary.reasons import CONTRADICTION, NO_REFERENCE, SENSOR_FAILURE, TOLERANCE
from safeloc.models.vocabulary.reflectors import MAX_ERROR_MM, NO_MODEL
from safeloc.properties import anchored_device
from safeloc.properties import route as route_claims
from safeloc.properties import turn_off as course_claims
from safeloc.properties.anchored_device import (
    accepted,
    astray,
    disproved,
    every_position_that_is_reported,
    flag,
    interval_of,
    judged_by,
    only_a_reference,
    only_an_accepted_group,
    restrictive,
    the_reflector_machines_interval,
    what_the_host_gets,
    withdrawn,
)
from safeloc.properties.hearing import hears_value
from safeloc.properties.turn_off import LAW as IMAGES

LAW = (
    f"{anchored_device.LAW}; {IMAGES}; a start that names any route names the true one; an echo that shows a model is that of a reflector: beside the "
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


def properties(whole: ReflectorRoute) -> list[Property]:
    """Return the properties of the whole device."""
    makers = (
        _host, _branch, _branches, _others, _too_many, _lost, _only_lost, _told_why, _withdrawn, _starts, _candidates,
        _near_the_start, _sightings, _courses, _watched,
    )  # fmt: skip
    return [prop for maker in makers for prop in maker(whole)]


# ------------------------------------------------------------------ what the host gets


def _host(whole: ReflectorRoute) -> Iterator[Property]:
    yield from what_the_host_gets(whole, LAW, REQUIREMENTS)
    yield the_reflector_machines_interval(whole)
    yield every_position_that_is_reported(
        whole,
        "the host gets every position on a route that is carried",
        ~_carrying(whole),
        "while the reflector machine reports a position and a route is carried, the host that had a position keeps one, and one that "
        "had none gets it with the first accepted group or recognised reflector",
    )


# ------------------------------------------------------------------ the branch that is told, and those that are carried


def _branch(whole: ReflectorRoute) -> Iterator[Property]:
    for claim in route_claims.properties(whole.route):
        if claim.name in _OF_THE_ROUTE:
            yield replace(whole.composition.inherited(whole.route.machine, claim), assumption=LAW)
    told, machine = _of_route(whole, "valid"), whole.route.machine
    number = whole.composition.of(machine).num(machine.output("route"))
    only = all_of(number.eq(one.number).iff(told & _possible(whole, one.possible)) for one in whole.route.own.routes)
    yield for_all_inputs(
        "a branch is told only where no other is possible",
        told.iff(_count(whole).eq(1)) & only & (number > 0).iff(told),
        statement="a branch is told exactly while one route is possible, and it is that one",
    )


def _branches(whole: ReflectorRoute) -> Iterator[Property]:
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
        all_of([nothing, _carrying(whole)]).implies(kept),
        statement="in a cycle in which no echo shows a model, no turn is seen and no route begins, every route that was possible stays possible, and no other "
        "becomes possible, unless all are given up",
    )


def _others(whole: ReflectorRoute) -> Iterator[Property]:
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
        any_of([near, turned, begun, ~_carrying(whole)]) | left,
        statement="in a cycle in which no echo with a model is near and on the own track's side, no turn is seen and no route begins, a route stays possible "
        "from which the map has such a reflector of another track in view, unless all are given up",
    )


def _too_many(whole: ReflectorRoute) -> Iterator[Property]:
    begun = whole.composition.of(whole.route.machine).bool(whole.route.own.start_error.present)
    ahead = whole.composition.of(whole.starts.machine).num(whole.starts.routes_ahead)
    yield for_all_inputs(
        "more branches than are carried are no position",
        (begun & (ahead > whole.config.route.routes)).implies(_lost_route(whole) & restrictive(whole)),
        statement="in a cycle in which the vehicle starts where more routes begin than are carried, the route is lost and the host gets no position",
    )


# ------------------------------------------------------------------ a lost route ends the position


def _lost(whole: ReflectorRoute) -> Iterator[Property]:
    yield for_all_inputs(
        "a lost route withdraws the position",
        _lost_route(whole).implies(withdrawn(whole)),
        statement="in each cycle in which no route is left, and up to the next start, neither the host nor the reflector machine has a position",
        requirements=("RFL-D6", "RFL-D3"),
    )
    yield for_all_inputs(
        "a refuted authority withdraws the position",
        (_of_route(whole, "refutes_authority") | astray(whole)).implies(withdrawn(whole)),
        statement="in each cycle in which the route of the movement authority is impossible, or the course at a switch is not the permitted one, "
        "neither the host nor the reflector machine has a position",
        requirements=("RFL-12", "RFL-D6"),
    )


def _only_lost(whole: ReflectorRoute) -> Iterator[Property]:
    yield for_all_inputs(
        "no position without a branch",
        (~restrictive(whole)).implies(_carrying(whole)),
        statement="the host has a position only in cycles in which a route is possible",
    )
    heard = whole.composition.of(whole.source.machine).bool(whole.source.own.contradicted)
    yield for_all_inputs(
        "route, course and groups contradict, and nothing else",
        heard.iff(any_of([_lost_route(whole), _of_route(whole, "refutes_authority"), astray(whole), disproved(whole)])),
        statement="a contradiction is wired to the reflector machine exactly in the cycles in which the route is lost, the permitted route or course "
        "is refuted, or groups contradict the position",
        requirements=("RFL-D6", "RFL-12", "RFL-D3"),
    )


def _told_why(whole: ReflectorRoute) -> Iterator[Property]:
    [heard] = [one for one in whole.restrictive.inputs if isinstance(one, NumVar) and one.name == "source_reason"]
    why, told = _why(whole), whole.composition.of(whole.restrictive).num(heard)
    yield for_all_inputs(
        "the host is told why no branch is carried",
        _carrying(whole)
        | all_of(why.eq(of_route).implies(told.eq(for_host)) for of_route, for_host in _REASONS.items()),
        statement="without a branch the host's reason is that of the route machine: no start, a contradiction, an interval too wide, a silent odometer",
    )


def _withdrawn(whole: ReflectorRoute) -> Iterator[Property]:
    yield for_all_inputs(
        "only a start ends a lost route",
        (earlier_bool(_lost_route(whole)) & ~_lost_route(whole)).implies(
            whole.composition.of(whole.route.machine).bool(whole.route.own.start_error.present)
        ),
        statement="a lost route is lost up to a cycle in which a group passed every check and routes begin there",
    )
    yield only_a_reference(
        whole,
        "only an accepted group or a reflector ends a loss",
        _carrying(whole),
        "the restrictive state is left only in a cycle in which a group passed every check or a reflector was recognised, and a route is "
        "carried",
        ("RFL-D6", "RFL-5"),
    )
    yield only_an_accepted_group(whole)


# ------------------------------------------------------------------ what a route begins from


def _starts(whole: ReflectorRoute) -> Iterator[Property]:
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


def _candidates(whole: ReflectorRoute) -> Iterator[Property]:
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


def _near_the_start(whole: ReflectorRoute) -> Iterator[Property]:
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


def _sightings(whole: ReflectorRoute) -> Iterator[Property]:
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


def _shows(whole: ReflectorRoute, slot: Slot) -> Bool:
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


def _stands_by_own_track(whole: ReflectorRoute, slot: Slot) -> Bool:
    """The echo is near, and comes from between the two sides at which reflectors of the own track stand."""
    heard, figures = whole.composition.of(whole.source.machine), whole.config
    near = heard.num(slot.range.value) <= figures.own_track_range_mm
    aside = heard.num(slot.lateral)
    return all_of([near, aside >= figures.own_track_right_mm, aside <= figures.own_track_left_mm])


def _courses(whole: ReflectorRoute) -> Iterator[Property]:
    own, into = whole.course.own, whole.composition.of(whole.course.machine)
    for claim in course_claims.properties(whole.course):
        if claim.name == "course is true":
            yield replace(whole.composition.inherited(whole.course.machine, claim), assumption=LAW)
    yield for_all_inputs(
        "the route hears the course at a switch",
        whole.composition.of(whole.route.machine).num(whole.route.own.course_taken).eq(into.num(own.course)),
        statement="the turn that refutes routes is the one that the image of a reflector shows in this cycle",
        requirements=("RFL-D6", "RFL-12"),
    )


def _watched(whole: ReflectorRoute) -> Iterator[Property]:
    own, into = whole.course.own, whole.composition.of(whole.course.machine)
    yield for_all_inputs(
        "the course is judged by the balise machine's interval",
        judged_by(whole, whole.groups.machine),
        statement="before, on and beyond a switch are judged by the ends of the balise machine's interval, as far as they are on the line, and by "
        "those of the line without one",
        requirements=("RFL-12",),
    )
    switch, shown = whole.starts.switch_position, whole.composition.of(whole.starts.machine)
    place = shown.num(switch.value)
    yield for_all_inputs(
        "a switch is taken up only ahead of the interval",
        hears_value(into, own.switch_position, shown.bool(switch.present) & (place > into.num(own.high)), place),
        statement="the map's next switch is watched from where the whole interval lies before it, and no other one",
        requirements=("RFL-12",),
    )


# ------------------------------------------------------------------ words


def _possible(whole: ReflectorRoute, term: Bool) -> Bool:
    return whole.composition.of(whole.route.machine).bool(term)


def _count(whole: ReflectorRoute) -> Num:
    """The number of routes that are possible."""
    total = as_num(0, COUNT)
    for one in whole.route.own.routes:
        total = total + ite(_possible(whole, one.possible), as_num(1, COUNT), 0)
    return total


def _why(whole: ReflectorRoute) -> Num:
    return whole.composition.of(whole.route.machine).num(whole.route.own.reason)


def _carrying(whole: ReflectorRoute) -> Bool:
    """At least one route is possible."""
    return any_of(_possible(whole, one.possible) for one in whole.route.own.routes)


def _lost_route(whole: ReflectorRoute) -> Bool:
    machine = whole.route.machine
    *_, lost = machine.modes
    return whole.composition.of(machine).bool(machine.mode.eq(lost))


def _of_route(whole: ReflectorRoute, output: str) -> Bool:
    return flag(whole, whole.route.machine, output)
