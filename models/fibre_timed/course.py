"""The true course of the end that is located and timed: no machine on board.

Sections and light are about one and the same end. Its place and its run are those of the fibre machine's world; here they come first, so
that the world of the time of flight can refer to them.
"""

from __future__ import annotations

from safeloc.language.declared import Declared
from safeloc.language.expr import TRUE, between
from safeloc.language.machine import ANY, Machine, Transition, modes
from safeloc.language.units import NM_PER_MM
from safeloc.language.world import Law
from safeloc.models.fibre.variables import Parts
from safeloc.models.vocabulary.vehicle_world import ON_THE_LINE

NAME = "course"


def course(fibre: Parts) -> Machine:
    """Return the machine; it shares the ghosts of place and run with the fibre machine of these variables."""
    declared, table, seen = Declared(), modes("RUNNING"), fibre.ghosts
    truth, run = declared.ghost(seen.truth, first=ANY), declared.choice(seen.true_run)
    farthest = 2 * fibre.config.position_limit_mm * NM_PER_MM
    return declared.machine(
        name=NAME,
        modes=table,
        outputs={},
        transitions=[Transition("runs", table[0], table[0], TRUE, {}, ("FWG-11",), 0)],
        world=declared.world(
            moves={truth: truth + run},
            clauses={
                ON_THE_LINE: Law(
                    between(-farthest, truth + run, farthest),
                    "The end of the train stays within twice the coordinates of the line.",
                    ("position_limit_mm",),
                    "[D] 1 000 km of line",
                    "infrastructure",
                    "when the map is made",
                )
            },
        ),
        initially=between(-farthest, truth, farthest),
        doc="The true course of one end of a train. Assumed: it stays on the line.",
    )
