"""Reflectors behind a balise and the route as one device: a position only on a branch that is possible (RFL-D6, source l. 281 to 304).

    motion, balise   as in `reflector_device`
    starts           no machine on board: the routes that begin at a group, and the next facing switch
    radar            tells which echo of the frame is a sighting
    turn_off         sees by the reflector behind a switch whether the vehicle turns off
    route            carries the routes on which the vehicle may be, at most four, each with its interval
    line, reflector  as in `reflector_device`; a lost route withdraws the position
    delocalized      passes the position on, or makes the vehicle restrictive

All act in one step. Routes begin only from groups that the balise machine accepted, within that machine's interval; sightings are echoes of the frame
that the reflector machine hears; the turn is the one that the image shows. Where no route is left, or the permitted one is refuted, the reflector
machine withdraws the position in that step, and the host gets one only while a route is carried.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from safeloc.language.composition import Clause, Composition, compose
from safeloc.language.expr import Bool, Expr, Var, all_of, as_num, between, exact_to, ite
from safeloc.language.machine import Machine
from safeloc.language.units import NM
from safeloc.models import balise, delocalized, reflector, route, turn_off
from safeloc.models.localizer.sources import distance_of_motion, law_of_motion
from safeloc.models.motion import Motion
from safeloc.models.reflector_device.anchored import Anchored, anchored, judged_by, present
from safeloc.models.reflector_device.line import Line
from safeloc.models.reflector_route.configuration import ReflectorRouteConfig
from safeloc.models.reflector_route.radar import Radar, radar
from safeloc.models.reflector_route.starts import Starts, starts
from safeloc.models.route import Route
from safeloc.models.route.ghosts import Moved, moved
from safeloc.models.route.variables import CONTRADICTION as NO_ROUTE_FITS
from safeloc.models.route.variables import NO_START
from safeloc.models.route.variables import TOLERANCE as TOO_WIDE
from safeloc.models.route.variables import parts as route_parts
from safeloc.models.route.world import AT_THE_START, ODOMETER
from safeloc.models.turn_off import TurnOff
from safeloc.models.turn_off.seen_course import TAKEN
from safeloc.models.turn_off.world import GIVEN
from safeloc.models.vocabulary.absent import wired_interval
from safeloc.models.vocabulary.reasons import CONTRADICTION, NO_REFERENCE, SENSOR_FAILURE, TOLERANCE

__all__ = ["ReflectorRoute", "ReflectorRouteConfig", "compose_machines"]
NAME = "reflector_route"


@dataclass(frozen=True, eq=False)
class ReflectorRoute:
    """The composition and its machines."""

    config: ReflectorRouteConfig
    composition: Composition
    motion: Motion
    groups: balise.Balise
    starts: Starts
    radar: Radar
    course: TurnOff
    route: Route
    line: Line
    source: reflector.ReflectorMachine
    restrictive: Machine


def compose_machines(config: ReflectorRouteConfig | None = None) -> ReflectorRoute:
    """Compose the device of a vehicle; all machines share one truth."""
    config = config or ReflectorRouteConfig()
    located = anchored(config)
    moves, source = located.motion, located.source
    map_, frame = starts(config), radar(config, source.own)
    course = turn_off.build(turn_off.parts(config.turn_off))
    branch = route.build(route_parts(config.route, moving=_moving(config, moves)))
    behind = delocalized.parts(config.host)
    restrictive = delocalized.build(behind)
    wires: dict[Var, Expr] = {
        **located.wires,
        **judged_by(located.groups.machine, course, map_.switch_position),
        **distance_of_motion(branch.own.odometer.measured, branch.own.odometer.more, moves),
        **_into_route(located, map_, branch),
        **_seen_by_route(frame, course, branch),
        located.line.contradicted: _contradicted(course, branch),
        **_into_host(located, branch, behind),
    }
    before, line = located.before_the_reflectors[:-1], located.line.machine
    whole = compose(
        NAME,
        [*before, map_.machine, frame.machine, course.machine, branch.machine, line, source.machine, restrictive],
        wires,
        shared=[*moves.shared, *frame.shared],
        discharge=[
            *located.discharged,
            Clause(course.machine, GIVEN),
            Clause(branch.machine, AT_THE_START), Clause(branch.machine, TAKEN),
            *law_of_motion(Clause(branch.machine, ODOMETER), moves),
            restrictive,
        ],
    )  # fmt: skip
    return ReflectorRoute(
        config, whole, moves, located.groups, map_, frame, course, branch, located.line, source, restrictive
    )


def _moving(config: ReflectorRouteConfig, moves: Motion) -> Moved:
    """Return what moves the vehicle in the route's world: the one travel, and with a check unit the one error of the reported distance."""
    own, seen = moved(config.route.physics, config.route.odometer.wander_nm), moves.own.ghosts
    own = replace(own, true_cycle_distance=seen.true_cycle_distance)
    return own if seen.units is None else replace(own, wander=seen.units.reported, next_wander=seen.units.next_reported)


def _into_route(located: Anchored, map_: Starts, branch: Route) -> dict[Var, Expr]:
    """Return the wires of a start: an accepted group at which routes begin, not more of them than are carried."""
    own = branch.own
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


def _seen_by_route(frame: Radar, course: TurnOff, branch: Route) -> dict[Var, Expr]:
    """Return the wires of what the vehicle sees: the sighting, and the turn that the image shows."""
    own = branch.own
    return {
        **present(own.sighting_range, frame.sighted, frame.range),
        own.sighting_error: frame.error,
        own.sighting_model: frame.model,
        own.sighting_by_own_track: frame.by_own_track,
        own.course_taken: course.machine.output("course"),
        own.ghosts.course: course.own.true_course,
    }


def _contradicted(course: TurnOff, branch: Route) -> Bool:
    """Return whether no route is left, or course or route are not those of the movement authority."""
    *_, lost = branch.machine.modes
    astray = course.machine.flag("contradicts") | branch.machine.flag("refutes_authority")
    return branch.machine.mode.eq(lost) | astray


def _into_host(located: Anchored, branch: Route, behind: delocalized.Parts) -> dict[Var, Expr]:
    """Return the wires of the restrictive state: as of reflectors alone, while a route is carried."""
    stated, machine, why = located.measuring.stated, branch.machine, branch.own.reason
    _, undecided, decided, _ = machine.modes
    carried = machine.mode.one_of(undecided, decided)
    of_route = ite(why.eq(TOO_WIDE), TOLERANCE, ite(why.eq(NO_ROUTE_FITS), CONTRADICTION, SENSOR_FAILURE))
    return {
        **located.into_host(behind),
        behind.valid: stated.valid & carried,
        behind.source_reason: ite(carried, stated.reason, ite(why.eq(NO_START), NO_REFERENCE, of_route)),
    }
