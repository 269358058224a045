"""The wires of the route: what it begins from, what it sees, and what becomes of a lost one.

Routes begin only from groups that the balise machine accepted, within that machine's interval. Sightings are echoes of the frame that the reflector
machine hears; the turn is the one that the image shows. The route stands behind the reflector machine, which keeps the position: where no route is
left, or the permitted one or the course is refuted, the host gets none in that step, and the reflector machine hears of it in the next.
"""

from __future__ import annotations

from dataclasses import replace

from safeloc.language.expr import Bool, Expr, Num, Var, all_of, any_of, as_num, between, exact_to, ite
from safeloc.language.spec import earlier_bool
from safeloc.language.units import NM
from safeloc.models import route
from safeloc.models.localizer.sources import distance_of_motion
from safeloc.models.motion import Motion
from safeloc.models.reflector_anchor.wires import present
from safeloc.models.reflector_device.anchored import Anchored
from safeloc.models.reflector_device.configuration import ReflectorDeviceConfig
from safeloc.models.reflector_device.radar import Radar
from safeloc.models.reflector_device.starts import Starts
from safeloc.models.route import Route
from safeloc.models.route.ghosts import moved
from safeloc.models.route.variables import CONTRADICTION as NO_ROUTE_FITS
from safeloc.models.route.variables import NO_START
from safeloc.models.route.variables import TOLERANCE as TOO_WIDE
from safeloc.models.route.variables import parts as route_parts
from safeloc.models.turn_off import TurnOff
from safeloc.models.vocabulary.absent import wired_interval
from safeloc.models.vocabulary.first_of import first_of
from safeloc.models.vocabulary.reasons import CONTRADICTION, NO_REFERENCE, SENSOR_FAILURE, TOLERANCE


def branch(config: ReflectorDeviceConfig, moves: Motion) -> Route:
    """Build the route machine; the vehicle's one travel moves it, and with a check unit the one error of the reported distance."""
    own, seen = moved(config.route.physics, config.route.odometer.wander_nm), moves.own.ghosts
    own = replace(own, true_cycle_distance=seen.true_cycle_distance)
    if seen.units is not None:
        own = replace(own, wander=seen.units.reported, next_wander=seen.units.next_reported)
    return route.build(route_parts(config.route, moving=own))


def branch_wires(located: Anchored, frame: Radar, map_: Starts, course: TurnOff, carried: Route) -> dict[Var, Expr]:
    """Return all wires of the route machine, and those of the frame in which it sees reflectors."""
    own = carried.own
    return {
        **distance_of_motion(own.odometer.measured, own.odometer.more, located.motion),
        **_started(located, map_, carried),
        **_seen(frame, carried),
        own.course_taken: course.machine.output("course"),
        own.ghosts.course: course.own.true_course,
    }


def _started(located: Anchored, map_: Starts, carried: Route) -> dict[Var, Expr]:
    """Return the wires of a start: an accepted group at which routes begin, not more of them than are carried."""
    own = carried.own
    away = map_.away(*wired_interval(located.groups.machine))
    begun = all_of([located.accepted, map_.place.present, between(0, away, own.start_error.value.high)])
    off = located.motion.own.ghosts.truth - exact_to(map_.place.value, NM)
    return {
        **present(own.start_error, begun, away),
        **{
            one.candidate: candidate & map_.few for one, candidate in zip(own.routes, map_.candidates, strict=True)
        },
        own.ghosts.start_truth: ite(begun, off, as_num(0, NM)),
    }  # fmt: skip


def _seen(frame: Radar, carried: Route) -> dict[Var, Expr]:
    own = carried.own
    return {
        **present(own.sighting_range, frame.sighted, frame.range),
        own.sighting_error: frame.error,
        own.sighting_model: frame.model,
        own.sighting_by_own_track: frame.by_own_track,
    }


# ------------------------------------------------------------------ a position only on a branch that is possible


def _is_carried(carried: Route) -> Bool:
    """Return whether at least one route is left."""
    _, undecided, decided, _ = carried.machine.modes
    return carried.machine.mode.one_of(undecided, decided)


def refuted(course: TurnOff, carried: Route) -> tuple[Bool, Bool]:
    """Return whether the course, and whether the route, is not that of the movement authority."""
    return course.machine.flag("contradicts"), carried.machine.flag("refutes_authority")


def contradicted_before(located: Anchored, course: TurnOff, carried: Route) -> Bool:
    """Return whether, before the step, the reflector machine had a position that course or route contradicted.

    One that it gets later begins from another group: a route that was lost meanwhile says nothing against it.
    """
    *_, lost = carried.machine.modes
    against = any_of([carried.machine.mode.eq(lost), *refuted(course, carried)])
    return earlier_bool(located.source.machine.flag("valid") & against)


def passed_on(located: Anchored, course: TurnOff, carried: Route) -> Bool:
    """Return whether the host gets the reflector machine's position: a route is carried, and course and route are the permitted ones."""
    permitted = (~one for one in refuted(course, carried))
    return all_of([located.measuring.stated.valid, _is_carried(carried), *permitted])


def why_not(course: TurnOff, carried: Route, reason: Num) -> Num:
    """Return the reason for the host: a refuted permission, the lack of a route, or that of the reflector machine."""
    why, (other_course, other_route) = carried.own.reason, refuted(course, carried)
    return first_of(
        (other_course, CONTRADICTION),
        (other_route, CONTRADICTION),
        (_is_carried(carried), reason),
        (why.eq(NO_START), NO_REFERENCE),
        (why.eq(TOO_WIDE), TOLERANCE),
        (why.eq(NO_ROUTE_FITS), CONTRADICTION),
        default=SENSOR_FAILURE,
    )
