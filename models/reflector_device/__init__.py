"""The reflector device as one: odometer, balise reader, direction, radar, course, route, restrictive state, stop (RFL-1, -5, -9, -12, -D5 to -D7).

    motion       the odometer that all machines share, and the true movement
    balise       judges every telegram by linking and expectation window
    line         no machine on board: the map's next reflector, and the law on its distance from a group
    met          tells the direction which models the vehicle meets, of the radar's frame
    travel_direction  finds the direction of travel from the models of the reflectors before and after an accepted group
    reflector    anchored by what the balise machine accepted, with that machine's interval; measures reflectors from there
    turn_off     sees by the reflector behind a switch whether the vehicle turns off
    radar        tells which echo of the frame is a sighting
    starts       no machine on board: the routes that begin at a group
    route        carries the routes on which the vehicle may be, at most four, each with its interval
    delocalized  passes the position on while a route is carried, or makes the vehicle restrictive
    stop_point   orders brake and hold at a platform, by the interval that was passed on

All act in one step. A telegram that the balise machine rejects is no reading for the reflector machine. That an accepted one
holds the front end is not assumed: the containment of the balise machine proves it. Where groups contradict the position, the
reflector machine, which began from the same groups, withdraws it as well. The order to brake counts from the max safe front end
of the interval that the host gets.

The comparison of measurement and map is one of distance and of direction (source l. 285 to 295). Where the direction is another one than route
and movement authority give, it has failed, as where groups contradict: the reflector machine withdraws the position in that step. A group counts
for the direction only if the balise machine accepted it. Places grow in the direction of travel, so the vehicle turned where it is measured behind
the farthest place that it reached, or where no distance is measured: then the reflectors that it passed no longer count.

Behind a switch the position is known only together with the branch (source l. 281 to 304). Where no route is left, or the vehicle takes another
course or route than it is permitted to, the host gets no position in the same step; the reflector machine hears it in the next, and withdraws the
position that it had, so that none comes back but from another group.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from safeloc.language.composition import Clause, Composition, compose
from safeloc.language.expr import Bool, Expr, Var, any_of, as_num, ite
from safeloc.language.machine import Machine
from safeloc.language.units import MM
from safeloc.models import balise, delocalized, reflector, stop_point, travel_direction, turn_off
from safeloc.models.localizer.sources import law_of_motion
from safeloc.models.motion import Motion
from safeloc.models.reflector.variables import Parts as Heard
from safeloc.models.reflector_anchor.line import Line, Switch
from safeloc.models.reflector_device.anchored import Anchored, anchored, judged_by
from safeloc.models.reflector_device.branches import (
    branch,
    branch_wires,
    contradicted_before,
    passed_on,
    why_not,
)
from safeloc.models.reflector_device.configuration import ReflectorDeviceConfig
from safeloc.models.reflector_device.met_models import Met, met
from safeloc.models.reflector_device.radar import Radar, radar
from safeloc.models.reflector_device.starts import Starts, starts
from safeloc.models.route import Route
from safeloc.models.route.world import AT_THE_START, ODOMETER
from safeloc.models.stop_point import StopPoint
from safeloc.models.stop_point.variables import parts as stop_parts
from safeloc.models.stop_point.world import REPORTED
from safeloc.models.travel_direction import TravelDirection
from safeloc.models.turn_off import TurnOff
from safeloc.models.turn_off.seen_course import TAKEN
from safeloc.models.turn_off.world import GIVEN
from safeloc.models.vocabulary.absent import wired_interval
from safeloc.models.vocabulary.measured import ADMITTED

__all__ = ["ReflectorDevice", "ReflectorDeviceConfig", "compose_machines"]
NAME = "reflector_device"


@dataclass(frozen=True, eq=False)
class ReflectorDevice:
    """The composition and its machines."""

    config: ReflectorDeviceConfig
    composition: Composition
    motion: Motion
    groups: balise.Balise
    line: Line
    switch: Switch
    met: Met
    direction: TravelDirection
    source: reflector.ReflectorMachine
    course: TurnOff
    radar: Radar
    starts: Starts
    route: Route
    restrictive: Machine
    stop: StopPoint


def compose_machines(config: ReflectorDeviceConfig | None = None) -> ReflectorDevice:
    """Compose the device of a vehicle; all machines share one truth."""
    config = config or ReflectorDeviceConfig()
    located = anchored(config)
    moves, map_, source = located.motion, located.line, located.source
    measured = located.groups.own.odometer.measured
    meets = met(config, source.own, measured.value)
    direction = travel_direction.build(travel_direction.parts())
    course = turn_off.build(turn_off.parts(config.turn_off))
    frame, ways, carried = radar(config, source.own), starts(config), branch(config, moves)
    behind = delocalized.parts(config.host)
    restrictive = delocalized.build(behind)
    stop = stop_point.build(stop_parts(config.stop))
    wires: dict[Var, Expr] = {
        **located.wires,
        direction.own.balise_read: located.accepted,
        meets.turned: _turned(located.groups),
        meets.run: ite(measured.present, measured.value, as_num(0, MM)),
        direction.own.backwards: _turned(located.groups),
        direction.own.passed_model: meets.passed_model,
        direction.own.ahead_model: meets.ahead_model,
        source.own.contradicted: any_of([
            direction.machine.flag("contradicts"), located.disproved, contradicted_before(located, course, carried),
        ]),
        **_into_course(located.switch, source, course),
        **branch_wires(located, frame, ways, course, carried),
        **_into_host(located, course, carried, behind),
        **_into_stop(restrictive, source, stop),
        stop.own.next_truth: moves.own.ghosts.truth,
    }  # fmt: skip
    whole = compose(
        NAME,
        [
            *located.before_the_reflectors, meets.machine, direction.machine, source.machine, course.machine, frame.machine, ways.machine,
            carried.machine,
            restrictive, stop.machine,
        ],
        wires,
        shared=[*moves.shared, *_radars_frame(source.own)],
        discharge=[
            *located.discharged,
            Clause(course.machine, GIVEN),
            Clause(carried.machine, AT_THE_START), Clause(carried.machine, TAKEN),
            *law_of_motion(Clause(carried.machine, ODOMETER), moves),
            restrictive,
            Clause(stop.machine, REPORTED),
        ],
    )  # fmt: skip
    return ReflectorDevice(
        config, whole, moves, located.groups, map_, located.switch, meets, direction, source, course, frame, ways, carried, restrictive, stop
    )  # fmt: skip


def _turned(groups: balise.Balise) -> Bool:
    """Return whether the vehicle is measured behind the farthest place that it reached, or may have run unmeasured."""
    heading = groups.own.heading
    return heading.backwards | (heading.rolled > 0) | groups.machine.output("odometer").ne(ADMITTED)


def _radars_frame(heard: Heard) -> Iterator[Var]:
    """Yield the inputs that three machines hear of the radar's frame."""
    yield heard.frame_present
    for slot in heard.slots:
        yield from (slot.range.value, slot.range.present, slot.error, slot.model, slot.intensity, slot.lateral)


def _into_host(located: Anchored, course: TurnOff, carried: Route, behind: delocalized.Parts) -> dict[Var, Expr]:
    """Return the wires of the restrictive state: as of reflectors alone, while a route is carried, and course and route are the permitted ones."""
    stated = located.measuring.stated
    return {
        **located.into_host(behind),
        behind.valid: passed_on(located, course, carried),
        behind.source_reason: why_not(course, carried, stated.reason),
    }


def _into_course(switch: Switch, source: reflector.ReflectorMachine, course: TurnOff) -> dict[Var, Expr]:
    """Return the wires of the course: the image of the reflector behind the switch, and the interval, or the whole line without one."""
    machine, own = source.machine, course.own
    same = switch.reflector.present & machine.output("reflector_position_mm").eq(switch.reflector.value)
    return {
        own.measured: machine.flag("precise") & same,
        own.lateral: machine.output("lateral_mm"),
        **judged_by(machine, course, switch.position),
    }


def _into_stop(restrictive: Machine, source: reflector.ReflectorMachine, stop: StopPoint) -> dict[Var, Expr]:
    """Return the wires of the stop at a platform: the interval that the host gets, and whether a reflector gave it."""
    passed, own = ~restrictive.flag("restrictive"), stop.own
    position, below, above = wired_interval(restrictive)
    return {
        own.valid: passed,
        own.precise: passed & source.machine.flag("precise"),
        own.position: position,
        own.below: below,
        own.above: above,
    }
