"""The true course of one end of the train: no machine on board.

Light and sections are about one and the same end, whose place is that of the fibre machine's world. Its run of the cycle is chosen here, first of
all, so that the world of the time of flight can refer to the place after the cycle.
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.declared import Declared
from safeloc.language.expr import TRUE, Num, NumVar, between, number
from safeloc.language.machine import Model, Transition, modes
from safeloc.language.units import NM, NM_PER_MM
from safeloc.language.world import Law
from safeloc.models.fibre.variables import Parts as FibreParts
from safeloc.models.vocabulary.vehicle_world import ON_THE_LINE


@dataclass(frozen=True, eq=False)
class Parts:
    """The variables of the machine, all of them choices of the world: the end's place before the cycle, and its run in it."""

    declared: Declared
    place: NumVar
    run: NumVar

    @property
    def place_after(self) -> Num:
        """The end's place after the cycle."""
        return self.place + self.run


Course = Model[Parts]


def course(fibre: FibreParts, name: str) -> Course:
    """Return the machine of one end, in the ranges of the fibre machine with these variables."""
    declared, table, seen = Declared(), modes("RUNNING"), fibre.ghosts
    place = declared.choice(number("place_nm", NM, seen.truth.low, seen.truth.high))
    run = declared.choice(number("true_run_nm", NM, seen.true_run.low, seen.true_run.high))
    own = Parts(declared, place, run)
    farthest = 2 * fibre.config.position_limit_mm * NM_PER_MM
    machine = declared.machine(
        name=name,
        modes=table,
        outputs={},
        transitions=[Transition("runs", table[0], table[0], TRUE, {}, ("FWG-11",), 0)],
        world=declared.world(
            moves={},
            clauses={
                ON_THE_LINE: Law(
                    between(-farthest, own.place_after, farthest),
                    "The end of the train stays within twice the coordinates of the line.",
                    ("position_limit_mm",),
                    "[D] 1 000 km of line",
                    "infrastructure",
                    "when the map is made",
                )
            },
        ),
        doc="The true course of one end of a train. Assumed: it stays on the line.",
    )
    return Model(machine, own)
