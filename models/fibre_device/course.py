"""The true course of one end of the train: no machine on board.

Light and sections are about one and the same end, whose place is that of the fibre machine's world. Its run of the cycle is chosen here, first of
all, so that the world of the time of flight can refer to the place after the cycle. The light's coordinates end at twice those of the line; an
end beyond them is taken there, where no place is compared: a place is compared only on the line.
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.declared import Declared
from safeloc.language.expr import TRUE, Num, NumVar, maximum, minimum, number
from safeloc.language.machine import Model, Transition, modes
from safeloc.language.units import NM, NM_PER_MM
from safeloc.models.fibre.variables import Parts as FibreParts


@dataclass(frozen=True, eq=False)
class Parts:
    """The variables of the machine: choices of the world.

    place, run   the end's place before the cycle, and its run in it
    farthest_nm  where the light's coordinates end
    """

    declared: Declared
    place: NumVar
    run: NumVar
    farthest_nm: int

    @property
    def place_after(self) -> Num:
        """The end's place after the cycle, no farther out than the light's coordinates reach."""
        return maximum(minimum(self.place + self.run, self.farthest_nm), -self.farthest_nm)


Course = Model[Parts]


def course(fibre: FibreParts, name: str) -> Course:
    """Return the machine of one end, in the ranges of the fibre machine with these variables."""
    declared, table, seen = Declared(), modes("RUNNING"), fibre.ghosts
    place = declared.choice(number("place_nm", NM, seen.truth.low, seen.truth.high))
    run = declared.choice(number("true_run_nm", NM, seen.true_run.low, seen.true_run.high))
    own = Parts(declared, place, run, 2 * fibre.config.position_limit_mm * NM_PER_MM)
    machine = declared.machine(
        name=name,
        modes=table,
        outputs={},
        transitions=[Transition("runs", table[0], table[0], TRUE, {}, ("FWG-11",), 0)],
        world=declared.world(moves={}, clauses={}),
        doc="The true course of one end of a train. Nothing is assumed of it.",
    )
    return Model(machine, own)
