"""Many vehicles with the balise machine at once, cycle by cycle with the machine on board, as arrays over vehicles.

The antenna's telegrams follow from the runs alone; what the map announces follows from what the machine asks for. One vehicle is
the case of one column (`safeloc.models.balise.simulate`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from safeloc.codegen.batch_steps import Stepped, compile_steps
from safeloc.language.system import TransitionSystem, lower, without_ghosts
from safeloc.language.units import NM_PER_MM
from safeloc.models.balise import machine
from safeloc.models.balise.groups import Group
from safeloc.models.balise.simulation.announcing import ASKED, Announcing
from safeloc.models.balise.simulation.passages import Antenna, Reading, Telegram, passages
from safeloc.models.balise.variables import BaliseConfig
from safeloc.runtime.streams.steps import Cell
from safeloc.simulation.many_runs import Array, Writer, absent_everywhere, through_border
from safeloc.simulation.motion import Motion
from safeloc.simulation.sensors import Distances


@dataclass(frozen=True, eq=False)
class Line:
    """Data of the vehicles' line: the groups that they pass, and for each vehicle those that the map announces from a cycle on.

    national_mm  location accuracy received in the first cycle; None: the default applies
    libraries    folder for compiled machines; None: a temporary one
    """

    groups: Sequence[Group]
    announced: Sequence[Mapping[int, Sequence[Group]]]
    national_mm: int | None
    libraries: Path | None = None


@dataclass(frozen=True, eq=False)
class Runs:
    """Runs of vehicles: inputs of the machine, ghosts included, as arrays [cycle, vehicle], and what they consist of.

    on_board              the machine without its world
    telegrams, announced  of each vehicle, by their cycles
    """

    on_board: TransitionSystem
    inputs: Mapping[str, Array]
    telegrams: Sequence[Mapping[int, Telegram]]
    announced: Sequence[Mapping[int, Mapping[str, Cell]]]


@lru_cache(maxsize=8)
def _with_world(config: str) -> TransitionSystem:
    return lower(machine(BaliseConfig.model_validate_json(config)))


@lru_cache(maxsize=8)
def _on_board(config: str, libraries: Path | None) -> Stepped:
    """Return the machine without its world, compiled once for each configuration (JSON)."""
    return compile_steps(without_ghosts(_with_world(config)), ASKED, folder=libraries)


def simulate_many(
    config: BaliseConfig, line: Line, motions: Sequence[Motion], distances: Distances, antennas: Sequence[Antenna]
) -> Runs:
    """Return the runs of vehicles, each with its motion and antenna; `distances` are those of their odometers."""
    made = config.model_dump_json()
    inputs = _of_odometers(config, _with_world(made), motions, distances)
    writer = Writer(_with_world(made), inputs)
    national = config.default_accuracy_mm if line.national_mm is None else line.national_mm
    telegrams = []
    for run, (motion, antenna, routes) in enumerate(zip(motions, antennas, line.announced, strict=True)):
        placed = {cycle: frozenset(group.identity for group in groups) for cycle, groups in routes.items()}
        met = passages(config, line.groups, national, motion, antenna)
        read = Reading(config, motion, distances.wander_nm[:, run], placed, antenna).telegrams(met)
        for cycle, one in read.items():
            writer.write(cycle, run, one.cells)
            writer.write(cycle, run, one.ghosts)
        if line.national_mm is not None:
            writer.write(0, run, {"national_accuracy_mm": line.national_mm})
        telegrams.append(read)
    on_board = _on_board(made, line.libraries)
    return Runs(on_board.system, inputs, telegrams, _announced(config, line, on_board, inputs, writer))


def _of_odometers(
    config: BaliseConfig, system: TransitionSystem, motions: Sequence[Motion], distances: Distances
) -> dict[str, Array]:
    """Return the inputs without telegrams and announcements."""
    position = np.stack([motion.position_nm for motion in motions], axis=1)
    inputs = absent_everywhere(system, *position.shape)
    inputs["odometer_mm"][:] = np.where(distances.present, distances.distance_mm, 0)
    inputs["odometer_mm.present"][:] = distances.present
    if config.checked_distance and distances.more_nm is not None:
        inputs["odometer_more_nm"][:] = distances.more_nm
    inputs["odometer_next_wander_nm"][:] = distances.wander_nm
    inputs["true_cycle_distance_nm"][:] = np.stack([motion.distance_nm for motion in motions], axis=1)
    inputs["read_place_nm"][:] = position - config.antenna_mm * NM_PER_MM
    return inputs


def _announced(
    config: BaliseConfig, line: Line, code: Stepped, inputs: Mapping[str, Array], writer: Writer
) -> list[dict[int, Mapping[str, Cell]]]:
    """Run the machines on board; write what the map announces into the inputs, and return it for each vehicle by cycles."""
    own = {var.name: inputs[var.name] for var in code.system.inputs}
    cycles, vehicles = own["odometer_mm"].shape
    runs, maps = code.begin(through_border(code.system, own)[0]), Announcing(config, line.announced)
    found: list[dict[int, Mapping[str, Cell]]] = [{} for _ in range(vehicles)]
    for cycle in range(cycles):
        for run, cells in maps.announced(cycle, runs.told):
            writer.write(cycle, run, cells)
            found[run][cycle] = cells
        runs.step(cycle)
    return found
