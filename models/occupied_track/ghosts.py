"""Ghosts of the occupied track: the edge on which the vehicle really is, and the one that it enters."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from safeloc.language.declared import Declared
from safeloc.language.expr import NumVar, choice, enumeration, number
from safeloc.language.machine import ANY
from safeloc.language.units import COUNT, NM, NM_PER_MM
from safeloc.models.turn_off import COURSE


@dataclass(frozen=True, eq=False)
class Ghosts:
    """The world's variables.

    edge, origin, length  the edge that the front end is on, the coordinate at which it begins, and its length, mm
    truth, next_truth     coordinate of the front end before the cycle and after it, nm
    place                 place of the front end on its edge, from the end at which the coordinate is smaller, nm
    entered_edge, entered_length  number and length of the edge that the vehicle enters if it passes a joint in this cycle
    course                the course that the vehicle takes at the switch at which a turn may be seen
    """

    edge: NumVar
    origin: NumVar
    length: NumVar
    truth: NumVar
    place: NumVar
    next_truth: NumVar
    entered_edge: NumVar
    entered_length: NumVar
    course: NumVar


def ghosts(declared: Declared, edges: int, origin: NumVar, length: Callable[[str], NumVar], truth: NumVar) -> Ghosts:
    """Return fresh variables: `origin` and `truth` as declared by their ranges, `length` makes one of a name."""
    longest = length("longest").high * NM_PER_MM
    return Ghosts(
        edge=declared.ghost(number("true_edge", COUNT, 1, edges), first=ANY),
        origin=declared.ghost(origin, first=ANY),
        length=declared.ghost(length("true_length_mm"), first=ANY),
        truth=declared.ghost(truth, first=ANY),
        place=declared.ghost(number("true_place_nm", NM, 0, longest), first=ANY),
        next_truth=declared.choice(number("next_truth_nm", NM, truth.low, truth.high)),
        entered_edge=declared.choice(number("entered_edge", COUNT, 1, edges)),
        entered_length=declared.choice(length("entered_length_mm")),
        course=declared.choice(choice("true_course", enumeration(COURSE))),
    )
