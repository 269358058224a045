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
from safeloc.language.expr import Bool, Expr, Num, Optional, Var, as_num, between, ite, maximum, minimum
from safeloc.language.machine import Machine
from safeloc.language.system import canonical
from safeloc.language.units import MM
from safeloc.models import balise, delocalized, motion, reflector, stop_point, turn_off
from safeloc.models.localizer.sources import PIECES, Piece
from safeloc.models.motion import Motion
from safeloc.models.reflector.world import PRESCRIBED, READING
from safeloc.models.reflector_device.configuration import ReflectorDeviceConfig
from safeloc.models.reflector_device.line import Line, line
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
    moves = motion.build(motion.parts(config.motion))
    reading, measuring = (PIECES[name](config.vehicle, moves, {}) for name in ("balise", "reflector"))
    (groups,), (source,) = reading.models, measuring.models
    assert isinstance(groups, balise.Balise) and isinstance(source, reflector.ReflectorMachine)
    map_ = line(config)
    course = turn_off.build(turn_off.parts(config.turn_off))
    behind = delocalized.parts(config.host)
    restrictive = delocalized.build(behind)
    stop = stop_point.build(stop_parts(config.stop))
    wires: dict[Var, Expr] = {
        **reading.wires,
        **map_.telegram_wires(groups.own),
        **measuring.wires,
        **_anchor(groups, source),
        **_distances(groups, map_, source),
        **_into_course(map_, source, course),
        **_into_host(groups, measuring, course, behind),
        behind.next_truth: moves.own.ghosts.truth,
        **_into_stop(restrictive, source, stop),
        stop.own.next_truth: moves.own.ghosts.truth,
    }
    whole = compose(
        NAME,
        [moves.machine, groups.machine, map_.machine, source.machine, course.machine, restrictive, stop.machine],
        wires,
        shared=moves.shared,
        discharge=[
            *reading.discharged, *measuring.discharged, Clause(source.machine, READING), Clause(source.machine, PRESCRIBED),
            Clause(course.machine, GIVEN), restrictive,
            Clause(stop.machine, REPORTED),
        ],
    )  # fmt: skip
    return ReflectorDevice(config, whole, moves, groups, map_, source, course, restrictive, stop)


def _counts(groups: balise.Balise) -> Bool:
    """Return whether the balise machine accepted the group that was read."""
    return groups.machine.flag("reference_accepted")


def _anchor(groups: balise.Balise, source: reflector.ReflectorMachine) -> dict[Var, Expr]:
    """Return the wires of a reading: an accepted group, with the balise machine's own interval at the end of the cycle."""
    counts, given = _counts(groups), source.own.balise
    position, below, above = wired_interval(groups.machine)
    return {
        **_present(given.identity, counts, groups.own.memory.group),
        **_present(given.position, counts, position),
        **_present(given.accuracy, counts, maximum(below, above)),
        given.since.present: counts,
        given.since.value: as_num(0, MM),
    }


def _distances(groups: balise.Balise, map_: Line, source: reflector.ReflectorMachine) -> dict[Var, Expr]:
    """Return the wires of the reflector's distance: counted from the position that is handed over, no longer from the group."""
    counts, machine, given, ahead = _counts(groups), groups.machine, source.own.balise, source.own.ahead
    position, _, _ = wired_interval(machine)
    by_telegram = machine.output("reflector_mm") - position
    search = machine.output("search_mm") - position
    by_map = groups.own.memory.last_group_position + map_.reference.value - position
    return {
        **_within(given.reference, counts & machine.flag("reflector_known"), by_telegram),
        **_within(given.search_from, counts & machine.flag("search_known") & (search > 0), search),
        **_within(ahead.reference, counts & map_.reference.present, by_map),
        ahead.position.value: map_.position.value,
        ahead.position.present: map_.position.present,
        source.own.contradicted: map_.contradicted | _disproved(groups),
    }


def _disproved(groups: balise.Balise) -> Bool:
    """Return whether the balise machine withholds its position because groups contradict it: what was anchored by it is withdrawn too."""
    return groups.machine.output("reason").eq(CONTRADICTION)


def _present(to: Optional, condition: Bool, value: Num) -> dict[Var, Expr]:
    return {to.present: condition, to.value: ite(condition, value, canonical(to.value))}


def _within(to: Optional, condition: Bool, value: Num) -> dict[Var, Expr]:
    """Return the wires of a value that is there only if it is in the range of the input: no distance is clipped."""
    return _present(to, condition & between(to.value.low, value, to.value.high), value)


def _into_host(groups: balise.Balise, piece: Piece, course: TurnOff, behind: delocalized.Parts) -> dict[Var, Expr]:
    """Return the wires of the restrictive state: an accepted group and a recognised reflector end it, a course that is not permitted begins it."""
    stated, astray = piece.stated, course.machine.flag("contradicts")
    return {
        behind.valid: stated.valid & ~astray,
        behind.reference_accepted: stated.reference | _counts(groups) & stated.valid,
        behind.source_reason: ite(astray, CONTRADICTION, stated.reason),
        behind.position: stated.position,
        behind.below: stated.below,
        behind.above: stated.above,
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
        **_present(
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
