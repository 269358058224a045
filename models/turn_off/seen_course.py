"""The law by which other machines take up a course that the turn-off machine has seen."""

from __future__ import annotations

from safeloc.language.expr import Num, NumVar
from safeloc.language.world import Law
from safeloc.models.turn_off.variables import UNDECIDED

TAKEN = "a turn that is seen is taken"


def seen_course_law(seen: NumVar, true_course: Num) -> Law:
    """Return the law that a course which is seen is the true one; `seen`: what the turn-off machine reports."""
    return Law(
        seen.one_of(UNDECIDED, true_course),
        "A turn that the turn-off machine sees is the course that the vehicle takes at the switch.",
        source="[D] the machine `turn_off`, and its assumptions",
        owner="supplier",
        check="as for the machine `turn_off`",
    )
