"""Many vehicles with the odometry machine at once: the sensors of `simulate`, as arrays over vehicles.

Each vehicle drives one of a few motions and draws its own errors of units and places of markers.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from safeloc.language.system import TransitionSystem
from safeloc.language.units import NM_PER_MM
from safeloc.models.odometry.ghosts import READERS
from safeloc.models.odometry.simulate import reading_inputs, sensed
from safeloc.models.odometry.variables import OdometryConfig
from safeloc.models.vocabulary.error_law import ErrorLaw
from safeloc.simulation import reader_faults, sensors
from safeloc.simulation.faults import Fault, Kinds
from safeloc.simulation.many_runs import Array, Drawn, DrawnFigure, ManyRuns, absent_everywhere
from safeloc.simulation.motion import Motion
from safeloc.simulation.reader_faults import with_faults
from safeloc.simulation.sensors import Distances, faulty, measured, passages

MISSED = "missed"


@dataclass(frozen=True, eq=False)
class Drives:
    """Drives that begin at 0 and never turn back: the place of end A, nm, array [cycle, drive], and each vehicle's drive."""

    position_nm: NDArray[np.int64]
    of_vehicle: NDArray[np.int64]


def _units_of(config: OdometryConfig) -> dict[str, ErrorLaw]:
    """Return the law of each unit by its name."""
    ends = ("front", "rear")[: config.devices]
    return {f"{end}_{law.kind}": law for end in ends for law in (config.first_unit, config.second_unit)}


def figures_of(config: OdometryConfig) -> dict[str, DrawnFigure]:
    """Return the figures of the sensors that may be drawn."""
    found = {MISSED: DrawnFigure("share", 0, 1, 0.0, "markers that a reader does not report")}
    for name in _units_of(config):
        found[f"{name}_severity"] = DrawnFigure(
            "share", 0, 100, 0.9, f"error of {name} as a share of what its law allows; above 1 it breaks the law"
        )
        found[f"{name}_dropout"] = DrawnFigure("share", 0, 1, 0.0, f"cycles in which {name} measures nothing")
    return found


def kinds_of(config: OdometryConfig) -> dict[str | int, Kinds]:
    """Return the kinds of fault of each unit and reader."""
    return {**dict.fromkeys(_units_of(config), sensors.KINDS), **dict.fromkeys(READERS, reader_faults.KINDS)}


def simulate_many(
    config: OdometryConfig,
    system: TransitionSystem,
    drives: Drives,
    markers: Sequence[tuple[int, int]],
    accuracy_mm: Mapping[int, int],
    drawn: Drawn,
    rng: np.random.Generator,
) -> ManyRuns:
    """Return the runs of the vehicles along a line with these markers; errors of markers reach nine tenths of their accuracy."""
    position = drives.position_nm[:, drives.of_vehicle]
    cycles, vehicles = position.shape
    inputs = absent_everywhere(system, cycles, vehicles)
    true = np.diff(position, axis=0, prepend=np.int64(0))
    inputs["true_cycle_distance_nm"][:] = true
    inputs["true_length_nm"][:] = config.vehicle_length_mm * NM_PER_MM
    for name, law in _units_of(config).items():
        _measure(inputs, name, law, true, config.period_ms, drawn, rng)
    for end, offset in enumerate((0, config.vehicle_length_mm)):
        _read(inputs, config, end, offset, position, markers, accuracy_mm, drawn, rng)
    return ManyRuns(inputs)


def simulate_alike(
    config: OdometryConfig,
    system: TransitionSystem,
    motion: Motion,
    rngs: Sequence[np.random.Generator],
    faults: Sequence[Sequence[Fault]],
    markers: Sequence[tuple[int, int]],
    first_unit: Distances | None,
    second_unit: Distances | None,
) -> dict[str, Array]:
    """Return the inputs of vehicles on one run, without drop-outs and markers missed, from the draws of single runs.

    A fault of a reader at a time without a reading changes nothing.

    first_unit, second_unit  distances [cycle, vehicle] of the front end's units, as in `simulate`
    """
    cycles, vehicles = len(motion.position_nm), len(rngs)
    units, readings = sensed(
        config, motion, rngs, faults, markers=markers, marker_accuracy_mm=1_000, dropout=0, missed=0, foreign=0,
        first_unit=first_unit, second_unit=second_unit, anywhen=True,
    )  # fmt: skip
    inputs = absent_everywhere(system, cycles, vehicles)
    inputs["true_cycle_distance_nm"][:] = motion.distance_nm[:, None]
    inputs["true_length_nm"][:] = config.vehicle_length_mm * NM_PER_MM
    for unit in units:
        inputs[f"{unit.name}_mm"] = np.where(unit.present, unit.distance_mm, 0)
        inputs[f"{unit.name}_mm.present"], inputs[f"{unit.name}_next_wander_nm"] = unit.present, unit.wander_nm
    for run, read in enumerate(readings):
        for one in read:
            if one.cycle < cycles:
                _write(inputs, reading_inputs(config, one, int(motion.position_nm[one.cycle])), one.cycle, run)
    return inputs


def _measure(
    inputs: dict[str, Array],
    name: str,
    law: ErrorLaw,
    true: NDArray[np.int64],
    period_ms: int,
    drawn: Drawn,
    rng: np.random.Generator,
) -> None:
    cycles, vehicles = true.shape
    bias = rng.uniform(-1, 1, vehicles) + rng.normal(0, 0.05, (cycles, vehicles))
    wanted = rng.uniform(-1, 1, (cycles // 100 + 1, vehicles))
    present = rng.random((cycles, vehicles)) >= drawn.figures[f"{name}_dropout"]
    for run, faults in enumerate(drawn.faults):
        for fault in faults:
            if fault.kind == "drop-out" and fault.strikes(name):
                present[fault.span, run] = False
    step, wander = measured(true, period_ms, law, drawn.figures[f"{name}_severity"], bias, wanted, present)
    for run, faults in enumerate(drawn.faults):
        of_unit = [fault for fault in faults if fault.strikes(name)]
        if of_unit:
            step[:, run] = np.where(present[:, run], faulty(name, step[:, run], of_unit), 0)
    inputs[f"{name}_mm"], inputs[f"{name}_mm.present"] = step, present
    inputs[f"{name}_next_wander_nm"] = wander


def _read(
    inputs: dict[str, Array],
    config: OdometryConfig,
    end: int,
    offset_mm: int,
    position: NDArray[np.int64],
    markers: Sequence[tuple[int, int]],
    accuracy_mm: Mapping[int, int],
    drawn: Drawn,
    rng: np.random.Generator,
) -> None:
    """Write the readings of one reader into the inputs."""
    most = np.array([accuracy_mm[marker] for marker, _ in markers], dtype=np.float64)
    cycles, vehicles = position.shape
    shifts = rng.uniform(-0.9, 0.9, (vehicles, len(markers))) * most
    unread = rng.random((vehicles, len(markers))) < drawn.figures[MISSED][:, None]
    identities = np.array([marker for marker, _ in markers])
    for run in range(vehicles):
        readings = passages(position[:, run], 0, end, offset_mm, markers, shifts[run], accuracy_mm)
        lost = set(identities[unread[run]].tolist())
        seen = [one for one in readings if one.marker not in lost]
        faults = [one for one in drawn.faults[run] if one.strikes(READERS[end])]
        for one in with_faults(READERS[end], seen, markers, faults, anywhen=True):
            if one.cycle < cycles:
                _write(inputs, reading_inputs(config, one, int(position[one.cycle, run])), one.cycle, run)


def _write(inputs: dict[str, Array], cells: Mapping[str, int | bool], cycle: int, run: int) -> None:
    for name, value in cells.items():
        inputs[name][cycle, run] = value
        if f"{name}.present" in inputs:
            inputs[f"{name}.present"][cycle, run] = True
