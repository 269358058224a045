"""The reflector device as one: odometer, balise reader, radar, restrictive state, and the stop at a platform (RFL-1, -5, -9, -D7).

    motion       the odometer that all machines share, and the true movement
    balise       judges every telegram by linking and expectation window
    line         no machine on board: the map's next reflector, and the law on its distance from a group
    reflector    anchored by what the balise machine accepted, with that machine's interval; measures reflectors from there
    turn_off     sees by the reflector behind a switch whether the vehicle turns off
    delocalized  passes the position on, or makes the vehicle restrictive
    stop_point   orders brake and hold at a platform, by the interval that was passed on

All act in one step. A telegram that the balise machine rejects is no reading for the reflector machine. That an accepted one
holds the front end is not assumed: the containment of the balise machine proves it. Where groups contradict the position, the
reflector machine, which began from the same groups, withdraws it as well. Where the vehicle takes another course than it is
permitted to, the host gets no position, in the same step. The order to brake counts from the max safe front end
of the interval that the host gets.
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.composition import Clause, Composition, compose
from safeloc.language.expr import Expr, Var, as_num, ite, maximum, minimum
from safeloc.language.machine import Machine
from safeloc.language.units import MM
from safeloc.models import balise, delocalized, reflector, stop_point, turn_off
from safeloc.models.motion import Motion
from safeloc.models.reflector_device.anchored import Anchored, anchored, present
from safeloc.models.reflector_device.configuration import ReflectorDeviceConfig
from safeloc.models.reflector_device.line import Line
from safeloc.models.stop_point import StopPoint
from safeloc.models.stop_point.variables import parts as stop_parts
from safeloc.models.stop_point.world import REPORTED
from safeloc.models.turn_off import TurnOff
from safeloc.models.turn_off.world import GIVEN
from safeloc.models.vocabulary.absent import wired_interval
from safeloc.models.vocabulary.reasons import CONTRADICTION

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
    source: reflector.ReflectorMachine
    course: TurnOff
    restrictive: Machine
    stop: StopPoint


def compose_machines(config: ReflectorDeviceConfig | None = None) -> ReflectorDevice:
    """Compose the device of a vehicle; all machines share one truth."""
    config = config or ReflectorDeviceConfig()
    located = anchored(config)
    moves, map_, source = located.motion, located.line, located.source
    course = turn_off.build(turn_off.parts(config.turn_off))
    behind = delocalized.parts(config.host)
    restrictive = delocalized.build(behind)
    stop = stop_point.build(stop_parts(config.stop))
    wires: dict[Var, Expr] = {
        **located.wires,
        **_into_course(map_, source, course),
        **_into_host(located, course, behind),
        **_into_stop(restrictive, source, stop),
        stop.own.next_truth: moves.own.ghosts.truth,
    }
    whole = compose(
        NAME,
        [*located.before_the_reflectors, source.machine, course.machine, restrictive, stop.machine],
        wires,
        shared=moves.shared,
        discharge=[
            *located.discharged,
            Clause(course.machine, GIVEN), restrictive,
            Clause(stop.machine, REPORTED),
        ],
    )  # fmt: skip
    return ReflectorDevice(config, whole, moves, located.groups, map_, source, course, restrictive, stop)


def _into_host(located: Anchored, course: TurnOff, behind: delocalized.Parts) -> dict[Var, Expr]:
    """Return the wires of the restrictive state: as of reflectors alone, and a course that is not permitted begins it."""
    stated, astray = located.measuring.stated, course.machine.flag("contradicts")
    return {
        **located.into_host(behind),
        behind.valid: stated.valid & ~astray,
        behind.source_reason: ite(astray, CONTRADICTION, stated.reason),
    }


def _into_course(map_: Line, source: reflector.ReflectorMachine, course: TurnOff) -> dict[Var, Expr]:
    """Return the wires of the course: the image of the reflector behind the switch, and the interval, or the whole line without one."""
    machine, own = source.machine, course.own
    position, below, above = wired_interval(machine)
    limit, valid = own.high.high, machine.flag("valid")
    high = ite(valid, minimum(position + above, limit), as_num(limit, MM))
    same = map_.switch_reflector.present & machine.output("reflector_position_mm").eq(map_.switch_reflector.value)
    return {
        own.measured: machine.flag("precise") & same,
        own.lateral: machine.output("lateral_mm"),
        own.low: ite(valid, maximum(position - below, -limit), as_num(-limit, MM)),
        own.high: high,
        **present(
            own.switch_position,
            map_.switch_position.present & (map_.switch_position.value > high),
            map_.switch_position.value,
        ),
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
