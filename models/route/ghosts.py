"""Ghosts of the route machine: the true route, the true place on it, and the reflector that is really sighted."""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.declared import Declared
from safeloc.language.expr import NumVar, choice, enumeration, number
from safeloc.language.machine import ANY
from safeloc.language.units import COUNT, MM, NM, NM_PER_MM
from safeloc.models.turn_off import COURSE
from safeloc.models.vocabulary.measuring_world import Physics
from safeloc.models.vocabulary.reflectors import MODEL


@dataclass(frozen=True, eq=False)
class Ghosts:
    """The world's variables; lengths in nm.

    route, start_route    number of the route that the vehicle runs along; at a start, of the one that begins there
    truth, true_cycle_distance     place of end A from the common start, along that route, and its true travel in the cycle
    start_truth           at a start, the new place of end A
    wander, next_wander  the one-off part of the odometer's error: before the cycle and, freely chosen, after it
    last_delivered, silent  the last distance delivered that a vehicle can have run, mm, and the cycles since then
    sighted_place, model       place along the route and model of the reflector that is sighted in this cycle
    course               the course that the vehicle takes at the switch at which a turn may be seen
    """

    route: NumVar
    start_route: NumVar
    truth: NumVar
    true_cycle_distance: NumVar
    start_truth: NumVar
    wander: NumVar
    next_wander: NumVar
    last_delivered: NumVar
    silent: NumVar
    sighted_place: NumVar
    model: NumVar
    course: NumVar


@dataclass(frozen=True)
class Bounds:
    """Figures of the configuration that bound the ghosts: vehicle, half the odometer's constant, lengths of line, routes."""

    physics: Physics
    half_nm: int
    line_mm: int
    reflectors_mm: int
    routes: int


def ghosts(declared: Declared, bounds: Bounds) -> Ghosts:
    """Return fresh variables."""
    line, half, run = bounds.line_mm * NM_PER_MM, bounds.half_nm, bounds.physics
    return Ghosts(
        route=declared.ghost(number("true_route", COUNT, 1, bounds.routes), first=ANY),
        truth=declared.ghost(number("truth_nm", NM, -line, line), first=ANY),
        wander=declared.ghost(number("wander_nm", NM, -half, half), first=ANY),
        last_delivered=declared.ghost(
            number("odometer_last_delivered_mm", MM, -run.farthest_mm, run.farthest_mm), first=0
        ),
        silent=declared.ghost(
            number("odometer_silent_cycles", COUNT, 0, run.longest_cycles), first=run.gap_limit_cycles + 1
        ),
        true_cycle_distance=declared.choice(number("true_cycle_distance_nm", NM, -run.farthest_nm, run.farthest_nm)),
        start_truth=declared.choice(number("start_truth_nm", NM, -line, line)),
        next_wander=declared.choice(number("next_wander_nm", NM, -half, half)),
        start_route=declared.choice(number("start_route", COUNT, 1, bounds.routes)),
        sighted_place=declared.choice(number("sighted_place_nm", NM, 0, bounds.reflectors_mm * NM_PER_MM)),
        model=declared.choice(choice("sighted_model", enumeration(MODEL))),
        course=declared.choice(choice("true_course", enumeration(COURSE))),
    )
