"""The world of the route machine: the true route and place of the vehicle, and the laws of odometer, radar and map.

    odometer   delivers a distance that obeys its error law, or one that no vehicle can have run, or nothing
    start      gives the greatest distance from the common start, and the routes that begin there, if there are any
    reflector  is sighted at its range within the error, and shows its own model, or no known one; it stands beside the true route, or
               beside another track, but then not where the image of the own track's reflectors stands
    turn       that is seen is the one that the vehicle takes
    map        has, for the true route, the sighted reflector, its own or another track's in view, and the course at the switch

Nothing is assumed of reflectors and turns that are not seen, nor of the map's entries for the other routes.
"""

from __future__ import annotations

from safeloc.language.expr import (
    Bool,
    Expr,
    Num,
    Var,
    all_of,
    any_of,
    as_num,
    between,
    exact_to,
    ite,
    maximum,
    with_unit,
)
from safeloc.language.units import NM
from safeloc.language.world import Law, World
from safeloc.models.route.variables import Hypothesis, Parts
from safeloc.models.turn_off import UNDECIDED as NO_COURSE
from safeloc.models.turn_off.seen_course import TAKEN, seen_course_law
from safeloc.models.vocabulary.measuring_world import (
    THOUSAND,
    Measuring,
    further_error,
    possible_at_speed,
    wander_after,
)
from safeloc.models.vocabulary.reflectors import NO_MODEL
from safeloc.models.vocabulary.vehicle_world import ON_THE_LINE, SPEED, on_line, speed_law

ODOMETER = "the odometer obeys its error law"
AT_THE_START = "at a start the vehicle is near it"
"""Clauses that earlier machines can guarantee: one that checks the distance, and the balise machine if it gives the start."""


def world(own: Parts) -> World:
    """Return the world."""
    seen = own.ghosts
    moved: dict[Var, Expr] = {seen.route: _route(own), seen.truth: _after(own), seen.wander: _wander_after(own)}
    if not own.config.checked_distance:
        moved |= measuring(own).moves()
    return own.declared.world(
        moves=moved,
        clauses={
            ODOMETER: _odometer_law(own),
            SPEED: speed_law(seen.true_cycle_distance, own.config.physics.farthest_nm),
            ON_THE_LINE: _line_law(own),
            AT_THE_START: _start_law(own),
            "the start names the true route": _named_law(own),
            "a reflector is sighted at its range": _range_law(own),
            "a recognised model is the sighted reflector's": _model_law(own),
            "by the own track stands no reflector of another": _own_track_law(own),
            "the map has the sighted reflector in view of the true route": _map_law(own),
            TAKEN: seen_course_law(own.course_taken, seen.course),
            "the map has the course of the true route": _course_law(own),
        },
    )  # fmt: skip


def measuring(own: Parts) -> Measuring:
    """Return the odometer as a unit of the world, where the machine reads it directly."""
    seen = own.ghosts
    return Measuring(own.odometer.law, own.odometer.measured, seen.last_delivered, seen.silent, own.config.physics)


def _after(own: Parts) -> Num:
    """Return the place of end A at the end of the cycle; a start gives a new one."""
    return ite(own.start_error.present, own.ghosts.start_truth, own.ghosts.truth + own.ghosts.true_cycle_distance)


def _route(own: Parts) -> Num:
    """Return the number of the true route; a start gives a new one."""
    return ite(own.start_error.present, own.ghosts.start_route, own.ghosts.route)


# ------------------------------------------------------------------ the vehicle and its odometer


def _can_be_run(own: Parts) -> Bool:
    """Return whether a distance came that a vehicle can have run; of one that another machine checked, only the size counts."""
    if not own.config.checked_distance:
        return measuring(own).can_be_run
    return possible_at_speed(own.odometer.measured, own.config.physics.farthest_mm)


def _wander_after(own: Parts) -> Num:
    seen = own.ghosts
    return wander_after(_can_be_run(own), seen.wander, seen.next_wander, checked=own.config.checked_distance)


def _odometer_law(own: Parts) -> Law:
    return Law(
        _checked_error(own) if own.config.checked_distance else _own_error(own),
        "The error of a distance that the odometer measures in a cycle is at most what its rate and floor allow, plus the "
        "change of a one-off part within half its constant, plus what a checking unit reports beyond that; or no vehicle can have run "
        "the distance. The rate counts the MEASURED distance.",
        ("constant_mm", "rate_ppm", "floor_mm_s", "knee_mm_s", "max_speed_mm_s", "max_acceleration_mm_s2"),
        "[S] SUBSET-041: 5 m + 5 % of every measured distance",
        "supplier",
        "type test; in operation the run between two starts against the map",
    )


def _own_error(own: Parts) -> Bool:
    """Return whether the odometer that the machine reads directly keeps its law."""
    seen, odometer = own.ghosts, measuring(own)
    error = odometer.error(seen.true_cycle_distance, seen.wander, seen.next_wander)
    return odometer.can_be_run.implies(odometer.allows(error))


def _checked_error(own: Parts) -> Bool:
    """Return whether a distance that another machine checked keeps the law, with the error that it reports beyond; or it is none to be run."""
    seen, physics, law, counts = own.ghosts, own.config.physics, own.odometer.law, _can_be_run(own)
    thousandths, knee = own.odometer.measured.value * THOUSAND, law.knee_mm_s * physics.period_ms
    above = maximum(maximum(thousandths - knee, -thousandths - knee), 0)
    lawful = with_unit(above * law.rate_ppm, NM) + law.floor_mm_s * physics.period_ms * THOUSAND**2
    blind = as_num(physics.farthest_nm * THOUSAND, NM)
    most = ite(counts, lawful, blind) + further_error(own.odometer.more) * THOUSAND
    counted = ite(counts, exact_to(own.odometer.measured.value, NM), as_num(0, NM))
    error = seen.true_cycle_distance - counted - (seen.next_wander - seen.wander)
    return (error * THOUSAND <= most) & (-error * THOUSAND <= most)


def _line_law(own: Parts) -> Law:
    truth = own.ghosts.truth
    return Law(
        on_line(truth, truth + own.ghosts.true_cycle_distance),
        "The coordinates of the routes do not end before the vehicle does.",
        ("length_limit_mm",),
        "[D] 100 km from the common start",
        "infrastructure",
        "when the map is made",
    )


def _start_law(own: Parts) -> Law:
    away, seen = exact_to(own.start_error.value, NM), own.ghosts
    return Law(
        own.start_error.present.implies((seen.start_truth <= away) & (seen.start_truth >= -away)),
        "At a start the vehicle is no farther from the common start than the error of the reading.",
        ("start_error_mm",),
        "[S] OCORA 7242, SUBSET-026 3.16.2; Q_NVLOCACC [D]",
        "infrastructure",
        "the balise machine's linking",
    )


def _named_law(own: Parts) -> Law:
    leads = any_of(own.ghosts.start_route.eq(one.number) & one.candidate for one in own.routes)
    none = all_of(~one.candidate for one in own.routes)
    return Law(
        own.start_error.present.implies(leads | none),
        "A start that names any route names the one on which the vehicle runs.",
        source="[D] the map is looked up by the group that is read",
        owner="infrastructure",
        check="audit of the line's map",
    )


# ------------------------------------------------------------------ sightings, turns and the map


def _sighted(own: Parts, law: Bool) -> Bool:
    """Return whether the law holds in a cycle in which a reflector of known model is sighted."""
    return any_of([~own.sighting_range.present, own.sighting_model.eq(NO_MODEL), law])


def _range_law(own: Parts) -> Law:
    error, origin = exact_to(own.sighting_error, NM), own.ghosts.sighted_place
    too_near = origin - _after(own) - exact_to(own.sighting_range.value, NM)
    return Law(
        _sighted(own, own.ghosts.elsewhere | between(-error, too_near, error)),
        "The range of a sighting of a reflector beside the true route is the distance from end A to that reflector, within the error "
        "reported with the sighting. Of a reflector beside another track nothing is assumed.",
        ("range_limit_mm",),
        "[M] FMCW radar, interpolated to centimetres",
        "supplier",
        "self-test at every balise",
    )


def _model_law(own: Parts) -> Law:
    return Law(
        _sighted(own, own.ghosts.model.eq(own.sighting_model)),
        "A sighting is of a reflector, beside the route on which the vehicle runs or beside another track, and the recognised model is "
        "that reflector's.",
        source="[M] signatures told apart, source l. 161 and 237",
        owner="supplier",
        check="type test of the signatures; a contradiction is reported",
    )


def _own_track_law(own: Parts) -> Law:
    return Law(
        _sighted(own, own.sighting_by_own_track.implies(~own.ghosts.elsewhere)),
        "Where the image of a reflector of the own track stands, near the vehicle and on its side, none of another track stands: a "
        "sighting that is told to be by the own track is of a reflector beside the true route.",
        source="[D] reflectors of branch and straight line told apart clearly, source l. 277; their lateral places",
        owner="infrastructure",
        check="survey: the lateral place of every reflector, seen from each track in whose view it stands",
    )


def _map_law(own: Parts) -> Law:
    nothing_read = all_of(~one.reflector.present & ~one.other_in_view for one in own.routes)
    return Law(
        nothing_read | _sighted(own, all_of(_of_true(own, one, _names_it(own, one)) for one in own.routes)),
        "While a route is possible, the map is looked up for every sighting. It returns, for each route, its own reflector of that "
        "model nearest to the place where the vehicle would see it, and whether one of that model beside another track may be in view "
        "there. If it returns any, then for the true route the sighted one, or that it is another track's, "
        "since reflectors of one model stand farther apart than all errors.",
        ("tolerance_mm",),
        "[D] the map is looked up around the reported interval; layout rule: models told apart by distance",
        "infrastructure",
        "audit of the line's map; survey; the look-up is tested with the map",
    )


def _of_true(own: Parts, route: Hypothesis, law: Bool) -> Bool:
    return _route(own).ne(route.number) | law


def _names_it(own: Parts, route: Hypothesis) -> Bool:
    """Return whether the map names the sighted reflector for this route, or says that another track's may be in view."""
    seen, nearest = own.ghosts, route.reflector
    its_own = all_of([seen.model.eq(route.model), nearest.present, seen.sighted_place.eq(exact_to(nearest.value, NM))])
    return ite(seen.elsewhere, route.other_in_view, its_own)


def _course_law(own: Parts) -> Law:
    taken = own.ghosts.course
    return Law(
        all_of(_of_true(own, one, one.course.one_of(NO_COURSE, taken)) for one in own.routes),
        "If the map gives the course of the true route at the switch, the vehicle takes that course.",
        source="[D] the map is looked up around the reported interval",
        owner="infrastructure",
        check="audit of the line's map; the look-up is tested with the map",
    )
