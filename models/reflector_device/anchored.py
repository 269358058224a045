"""Reflectors that are anchored by groups of balises, in wires.

motion       the odometer that all machines share, and the true movement
balise       judges every telegram by linking and expectation window
line         no machine on board: the map's next reflector, and the law on its distance from a group
reflector    anchored by what the balise machine accepted, with that machine's interval
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.composition import Clause
from safeloc.language.expr import Bool, Expr, Num, Optional, Var, as_num, between, ite, maximum, minimum
from safeloc.language.machine import Machine
from safeloc.language.system import canonical
from safeloc.language.units import MM
from safeloc.models import balise, delocalized, motion, reflector
from safeloc.models.localizer.sources import PIECES, Piece
from safeloc.models.motion import Motion
from safeloc.models.reflector.world import PRESCRIBED, READING
from safeloc.models.reflector_device.configuration import AnchoredConfig
from safeloc.models.reflector_device.line import Line, line
from safeloc.models.turn_off import TurnOff
from safeloc.models.vocabulary.absent import wired_interval
from safeloc.models.vocabulary.reasons import CONTRADICTION


@dataclass(frozen=True, eq=False)
class Anchored:
    """The four machines, their wires, and the clauses that machines before discharge.

    measuring  the reflector machine as a source, with its statement
    wires      of balise, line and reflector machine, but for what contradicts the reflector machine's position
    """

    motion: Motion
    groups: balise.Balise
    line: Line
    source: reflector.ReflectorMachine
    measuring: Piece
    wires: dict[Var, Expr]
    discharged: tuple[Clause, ...]

    @property
    def accepted(self) -> Bool:
        """The balise machine accepted the group that was read."""
        return _counts(self.groups)

    @property
    def before_the_reflectors(self) -> list[Machine]:
        """The machines before the reflector machine, in the order of the step."""
        return [self.motion.machine, self.groups.machine, self.line.machine]

    @property
    def disproved(self) -> Bool:
        """The balise machine withholds its position because groups contradict it: what was anchored by it is withdrawn too."""
        return self.groups.machine.output("reason").eq(CONTRADICTION)

    def into_host(self, behind: delocalized.Parts) -> dict[Var, Expr]:
        """Return the wires of the restrictive state, but for validity and reason: an accepted group and a recognised reflector end it."""
        stated = self.measuring.stated
        return {
            behind.reference_accepted: stated.reference | self.accepted & stated.valid,
            behind.position: stated.position,
            behind.below: stated.below,
            behind.above: stated.above,
            behind.next_truth: self.motion.own.ghosts.truth,
        }


def anchored(config: AnchoredConfig) -> Anchored:
    """Build the machines of one vehicle; all share one truth."""
    moves = motion.build(motion.parts(config.motion))
    reading, measuring = (PIECES[name](config.vehicle, moves, {}) for name in ("balise", "reflector"))
    (groups,), (source,) = reading.models, measuring.models
    assert isinstance(groups, balise.Balise) and isinstance(source, reflector.ReflectorMachine)
    map_ = line(config)
    wires: dict[Var, Expr] = {
        **reading.wires,
        **map_.telegram_wires(groups.own),
        **measuring.wires,
        **_anchor(groups, source),
        **_distances(groups, map_, source),
    }
    of_readings = (Clause(source.machine, READING), Clause(source.machine, PRESCRIBED))
    discharged = (*reading.discharged, *measuring.discharged, *of_readings)
    return Anchored(moves, groups, map_, source, measuring, wires, discharged)


def _counts(groups: balise.Balise) -> Bool:
    """Return whether the balise machine accepted the group that was read."""
    return groups.machine.flag("reference_accepted")


def _anchor(groups: balise.Balise, source: reflector.ReflectorMachine) -> dict[Var, Expr]:
    """Return the wires of a reading: an accepted group, with the balise machine's own interval at the end of the cycle."""
    counts, given = _counts(groups), source.own.balise
    position, below, above = wired_interval(groups.machine)
    return {
        **present(given.identity, counts, groups.own.memory.group),
        **present(given.position, counts, position),
        **present(given.accuracy, counts, maximum(below, above)),
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
    }


def judged_by(machine: Machine, course: TurnOff, switch: Optional) -> dict[Var, Expr]:
    """Return the wires of the course: a machine's interval, or the whole line without one, and the map's switch while it lies ahead of that."""
    own = course.own
    position, below, above = wired_interval(machine)
    limit, valid = own.high.high, machine.flag("valid")
    high = ite(valid, minimum(position + above, limit), as_num(limit, MM))
    return {
        own.low: ite(valid, maximum(position - below, -limit), as_num(-limit, MM)),
        own.high: high,
        **present(own.switch_position, switch.present & (switch.value > high), switch.value),
    }


def present(to: Optional, condition: Bool, value: Num) -> dict[Var, Expr]:
    return {to.present: condition, to.value: ite(condition, value, canonical(to.value))}


def _within(to: Optional, condition: Bool, value: Num) -> dict[Var, Expr]:
    """Return the wires of a value that is there only if it is in the range of the input: no distance is clipped."""
    return present(to, condition & between(to.value.low, value, to.value.high), value)
