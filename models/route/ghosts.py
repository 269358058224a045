"""Ghosts of the route machine: the true route, the true place on it, and the reflector that is really sighted."""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.declared import Declared
from safeloc.language.expr import BoolVar, NumVar, boolean, choice, enumeration, number
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
    last_delivered, silent  the last distance delivered that a vehicle can have run, mm, and the cycles since then; where another machine
                         checked the distance, no part of the world
    sighted_place, model       place along the route and model of the reflector that is sighted in this cycle; beside another track
                         its place is of no matter
    elsewhere            the reflector that is sighted stands beside another track than the true route
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
    elsewhere: BoolVar
    course: NumVar


@dataclass(frozen=True)
class Bounds:
    """Figures of the configuration that bound the ghosts: vehicle, lengths of line and map, number of routes; and who checks the distance."""

    physics: Physics
    line_mm: int
    reflectors_mm: int
    routes: int
    checked_distance: bool


@dataclass(frozen=True, eq=False)
class Moved:
    """The vehicle's travel in the cycle, and the one-off part of its odometer's error, which the worlds of several machines may share."""

    true_cycle_distance: NumVar
    wander: NumVar
    next_wander: NumVar


def moved(physics: Physics, half_nm: int) -> Moved:
    """Return fresh variables."""
    return Moved(
        true_cycle_distance=number("true_cycle_distance_nm", NM, -physics.farthest_nm, physics.farthest_nm),
        wander=number("wander_nm", NM, -half_nm, half_nm),
        next_wander=number("next_wander_nm", NM, -half_nm, half_nm),
    )


def ghosts(declared: Declared, bounds: Bounds, moving: Moved) -> Ghosts:
    """Return fresh variables beside those of the movement."""
    line, run = bounds.line_mm * NM_PER_MM, bounds.physics
    last_delivered = number("odometer_last_delivered_mm", MM, -run.farthest_mm, run.farthest_mm)
    silent = number("odometer_silent_cycles", COUNT, 0, run.longest_cycles)
    route = declared.ghost(number("true_route", COUNT, 1, bounds.routes), first=ANY)
    truth = declared.ghost(number("truth_nm", NM, -line, line), first=ANY)
    wander = declared.ghost(moving.wander, first=ANY)
    if not bounds.checked_distance:
        declared.ghost(last_delivered, first=0)
        declared.ghost(silent, first=run.gap_limit_cycles + 1)
    return Ghosts(
        route=route,
        truth=truth,
        wander=wander,
        last_delivered=last_delivered,
        silent=silent,
        true_cycle_distance=declared.choice(moving.true_cycle_distance),
        start_truth=declared.choice(number("start_truth_nm", NM, -line, line)),
        next_wander=declared.choice(moving.next_wander),
        start_route=declared.choice(number("start_route", COUNT, 1, bounds.routes)),
        sighted_place=declared.choice(number("sighted_place_nm", NM, 0, bounds.reflectors_mm * NM_PER_MM)),
        model=declared.choice(choice("sighted_model", enumeration(MODEL))),
        elsewhere=declared.choice(boolean("sighted_elsewhere")),
        course=declared.choice(choice("true_course", enumeration(COURSE))),
    )
