"""Simulated balise groups, linking and odometer as step streams of the balise machine, its ghosts included.

The map is simulated too: it announces groups when the machine asks for them, so each stream is made step by step
together with the machine as it runs on board. Because a stream contains the ghosts, the interpreter can check on it
that it obeys the assumption.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from safeloc.errors import InputError
from safeloc.language.units import NM_PER_MM
from safeloc.models.balise.groups import Group, Orientation, Reaction
from safeloc.models.balise.simulation.announcing import RouteSet
from safeloc.models.balise.simulation.many import Line, Runs, simulate_many
from safeloc.models.balise.simulation.passages import KINDS, Antenna, Telegram
from safeloc.models.balise.variables import BaliseConfig
from safeloc.runtime.streams.steps import Cell
from safeloc.simulation import sensors
from safeloc.simulation.faults import Fault
from safeloc.simulation.many_runs import refuse_beyond_ranges
from safeloc.simulation.motion import Leg, Motion, VehicleConfig, move, plan
from safeloc.simulation.sensors import Distances, measure

__all__ = ["KINDS", "RouteSet", "Steps", "line", "simulate", "vehicle_of"]
Steps = list[dict[str, Cell]]


_GHOSTS = ("read_place_nm", "true_since_nm", "reading_wander_nm")
"""Ghosts of a reading."""


def vehicle_of(config: BaliseConfig) -> VehicleConfig:
    """Return a vehicle that stays within the configured limits."""
    return VehicleConfig(max_speed_mm_s=max(100, int(config.max_speed_mm_s * 0.9)))


def line(first_mm: int = 100_000, spacing_mm: int = 150_000, count: int = 60) -> list[Group]:
    """Return groups a fixed distance apart: one to four balises, both orientations, with and without an accuracy of their own."""
    reactions: tuple[Reaction, ...] = ("SERVICE_BRAKE", "TRAIN_TRIP", "NONE")
    groups = []
    for number in range(count):
        accuracy = None if number % 5 == 4 else 1_000 + 500 * (number % 4)
        orientation: Orientation = "REVERSE" if number % 3 == 2 else "NOMINAL"
        reflector = 80_000 if number % 4 == 0 else None
        search = None if reflector is None else 30_000
        groups.append(
            Group(
                number + 1, first_mm + number * spacing_mm, 1 + number % 4, orientation, accuracy,
                reactions[number % 3], True, reflector, search,
            )
        )  # fmt: skip
    return groups


def simulate(
    config: BaliseConfig,
    *,
    seed: int,
    seconds: float = 300.0,
    groups: Sequence[Group] | None = None,
    routes: Sequence[RouteSet] = (),
    dropout: float = 0.01,
    missed: float = 0.03,
    foreign: float = 0.002,
    counted: float = 0.5,
    national_accuracy_mm: int | None = 5_000,
    legs: Sequence[Leg] | None = None,
    motion: Motion | None = None,
    faults: Sequence[Fault] = (),
    sensor_faults: Sequence[Fault] = (),
    measured: Distances | None = None,
) -> Steps:
    """Return one run as steps: inputs, ghost inputs, and the remark `truth_mm` (rounded down).

    groups   those that the vehicle passes
    routes   the groups that the map announces from a cycle on, by default the same ones; the map knows no place of a group
             that is not on the route set last
    missed   the share of groups that are not read
    foreign  the share of cycles without another telegram that bring one of another track
    counted  the share of readings with a latched counter
    national_accuracy_mm  received in the first cycle; None: the default applies
    motion   the vehicle's run; without it, the run over `legs`, or over a random service
    faults   named faults of groups (`KINDS`); none of them breaks the assumption
    sensor_faults  named faults of `odometer`; while one is active the assumption may be broken
    measured  the odometer's distances, if other machines use the same odometer; they contain its faults already
    InputError for a fault of a group that the line does not have, and for two routes that are set in one cycle.
    """
    rng = np.random.default_rng(seed)
    known = list(groups) if groups is not None else line()
    vehicle = vehicle_of(config)
    if motion is None:
        motion = move(vehicle, legs or plan(vehicle, seconds, rng, reversals=False), config.period_ms)
    sensors.KINDS.require(sensor_faults, places=["odometer"], length=len(motion.position_nm))
    KINDS.require(faults, places=[group.identity for group in known], timed=False)
    _check_routes(routes)
    distances = measured or measure("odometer", motion, config.odometer, rng, dropout=dropout, faults=sensor_faults)
    columns = distances.as_column
    routed = {0: known} | {one.cycle: one.groups for one in routes}
    antenna = Antenna(rng, missed, foreign, counted, faults)
    runs = simulate_many(config, Line(known, [routed], national_accuracy_mm), [motion], columns, [antenna])
    return _steps(config, motion, distances, runs, national_accuracy_mm)


def _check_routes(routes: Sequence[RouteSet]) -> None:
    cycles = [one.cycle for one in routes]
    if len(set(cycles)) < len(cycles):
        raise InputError(f"routes are set in cycles {cycles}: only one can be set in a cycle; leave the others out.")


def _steps(config: BaliseConfig, motion: Motion, distances: Distances, runs: Runs, national_mm: int | None) -> Steps:
    """Return the run of the only vehicle as steps. InputError for an input out of its range."""
    refuse_beyond_ranges(runs.on_board, runs.inputs)
    quiet, steps = Telegram({}, {}), Steps()
    own = {name: runs.inputs[name][:, 0] for name in _GHOSTS}
    true = motion.distance_nm
    for cycle, place in enumerate(motion.position_nm):
        step: dict[str, Cell] = {"odometer_more_nm": distances.more(cycle)} if config.checked_distance else {}
        if distances.present[cycle]:
            step["odometer_mm"] = int(distances.distance_mm[cycle])
        step |= runs.announced[0].get(cycle, {})
        if cycle == 0 and national_mm is not None:
            step["national_accuracy_mm"] = national_mm
        step |= runs.telegrams[0].get(cycle, quiet).cells
        step |= {name: int(values[cycle]) for name, values in own.items()}
        step |= {"true_cycle_distance_nm": int(true[cycle]), "odometer_next_wander_nm": int(distances.wander_nm[cycle])}
        steps.append({**step, "truth_mm": int(place) // NM_PER_MM})
    return steps
