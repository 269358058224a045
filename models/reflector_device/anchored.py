"""A vehicle whose reflectors are anchored by groups of balises: the machines that locate it, as in a localizer of these sources.

motion       the odometer that all machines share, and the true movement
balise       judges every telegram by linking and expectation window
line         no machine on board: the map's next reflector, and the law on its distance from a group
reflector    anchored by what the balise machine accepted, with that machine's interval
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.composition import Clause
from safeloc.language.expr import Bool, Expr, Optional, Var, as_num, ite, maximum, minimum
from safeloc.language.machine import Machine
from safeloc.language.units import MM
from safeloc.models import balise, delocalized, motion, reflector
from safeloc.models.localizer.sources import PIECES, Piece, anchored_reflector
from safeloc.models.motion import Motion
from safeloc.models.reflector_anchor.line import Line, Switch
from safeloc.models.reflector_anchor.wires import accepted, disproved, present
from safeloc.models.reflector_device.configuration import AnchoredConfig
from safeloc.models.turn_off import TurnOff
from safeloc.models.vocabulary.absent import wired_interval


@dataclass(frozen=True, eq=False)
class Anchored:
    """The four machines, their wires, and the clauses that machines before discharge.

    measuring  line and reflector machine as a source, with its statement
    wires      of balise, line and reflector machine; a composition may wire more to what contradicts the reflector machine's position
    """

    motion: Motion
    groups: balise.Balise
    line: Line
    switch: Switch
    source: reflector.ReflectorMachine
    measuring: Piece
    wires: dict[Var, Expr]
    discharged: tuple[Clause, ...]

    @property
    def accepted(self) -> Bool:
        """The balise machine accepted the group that was read."""
        return accepted(self.groups)

    @property
    def before_the_reflectors(self) -> list[Machine]:
        """The machines before the reflector machine, in the order of the step."""
        return [self.motion.machine, self.groups.machine, self.line.machine]

    @property
    def disproved(self) -> Bool:
        """The balise machine withholds its position because groups contradict it: what was anchored by it is withdrawn too."""
        return disproved(self.groups)

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
    reading = PIECES["balise"](config.vehicle, moves, {})
    measuring = anchored_reflector(config.vehicle, moves, reading, with_switch=True)
    (groups,), (map_, source) = reading.models, measuring.models
    assert isinstance(groups, balise.Balise) and isinstance(source, reflector.ReflectorMachine)
    assert isinstance(map_, Line) and map_.switch is not None
    wires: dict[Var, Expr] = {**reading.wires, **measuring.wires}
    discharged = (*reading.discharged, *measuring.discharged)
    return Anchored(moves, groups, map_, map_.switch, source, measuring, wires, discharged)


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
