"""Simulated sensors as step streams of the odometry machine, its ghosts included.

Because a stream contains the ghosts, the interpreter can check on it that it obeys the assumption.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from safeloc.language.units import NM_PER_MM
from safeloc.models.odometry.ghosts import READERS
from safeloc.models.odometry.variables import OdometryConfig
from safeloc.models.odometry.world import far_away_mm
from safeloc.models.vocabulary.error_law import ErrorLaw
from safeloc.simulation import reader_faults, sensors
from safeloc.simulation.faults import Fault
from safeloc.simulation.motion import Leg, Motion, VehicleConfig, move, plan
from safeloc.simulation.reader_faults import with_faults
from safeloc.simulation.sensors import Distances, Reading, measure, read_markers

Steps = list[dict[str, int | bool]]
_NO_MARKERS = {f"{name}_{what}": nothing for name in READERS for what, nothing in (("spot_nm", 0), ("stray", False))}

NO_SATELLITES = {"satellite_margin_below_mm": 0, "satellite_margin_above_mm": 0}
"""Inputs of a machine that takes positions of satellites, in a cycle without one."""


def vehicle_of(config: OdometryConfig) -> VehicleConfig:
    """Return a vehicle that stays within the configured limits."""
    return VehicleConfig(
        length_mm=max(1_000, config.vehicle_length_mm), max_speed_mm_s=int(config.max_speed_mm_s * 0.9)
    )


def simulate(
    config: OdometryConfig,
    *,
    seed: int,
    seconds: float = 300.0,
    markers: Sequence[tuple[int, int]] | None = None,
    marker_accuracy_mm: int | Mapping[int, int] = 1_000,
    dropout: float = 0.01,
    missed: float = 0.05,
    foreign: float = 0.002,
    legs: Sequence[Leg] | None = None,
    motion: Motion | None = None,
    faults: Sequence[Fault] = (),
) -> Steps:
    """Return one run as steps: inputs, ghost inputs, and the remark `truth_mm` (rounded down).

    markers  (identity, place in mm) in order of place; every 250 m by default
    marker_accuracy_mm  of all markers, or of each by its identity
    motion   the vehicle's run; without it, the run over `legs`, or over a random service
    faults   named faults of `front_wheel`, `front_radar`, ... (`sensors.KINDS`) and of `front_marker`, `rear_marker`
             (`reader_faults.KINDS`); while one is active the assumption may be broken
    """
    rng = np.random.default_rng(seed)
    vehicle = vehicle_of(config)
    if motion is None:
        motion = move(vehicle, legs or plan(vehicle, seconds, rng), config.period_ms)
    units = _units(config, motion, rng, [fault for fault in faults if fault.where not in READERS], dropout)
    known = markers if markers is not None else [(n + 1, (n - 200) * 250_000) for n in range(400)]
    of_readers = [fault for fault in faults if fault.where in READERS]
    reader_faults.KINDS.require(of_readers, length=len(motion.position_nm))
    readings: list[Reading] = []
    for end, (name, offset) in enumerate(zip(READERS, (0, config.vehicle_length_mm), strict=True)):
        read = read_markers(motion, end, offset, known, marker_accuracy_mm, rng, missed=missed, foreign=foreign)
        readings += with_faults(name, read, known, of_readers)
    return _steps(config, motion, units, readings)


def _units(
    config: OdometryConfig, motion: Motion, rng: np.random.Generator, faults: Sequence[Fault], dropout: float
) -> list[Distances]:
    laws = units_of(config)
    sensors.KINDS.require(faults, places=list(laws), length=len(motion.position_nm))
    return [measure(name, motion, law, rng, dropout=dropout, faults=faults) for name, law in laws.items()]


def units_of(config: OdometryConfig) -> dict[str, ErrorLaw]:
    """Return the law of each unit by its name: those of the front end first."""
    ends = ("front", "rear")[: config.devices]
    return {f"{end}_{law.kind}": law for end in ends for law in (config.first_unit, config.second_unit)}


def _steps(
    config: OdometryConfig, motion: Motion, distances: Sequence[Distances], readings: Sequence[Reading]
) -> Steps:
    steps: Steps = []
    true, before = motion.distance_nm, {unit.name: 0 for unit in distances}
    for number in range(len(true)):
        step: dict[str, int | bool] = {"true_cycle_distance_nm": int(true[number])}
        step |= {"true_length_nm": config.vehicle_length_mm * NM_PER_MM, **_NO_MARKERS}
        step |= NO_SATELLITES if config.satellite_markers else {}
        for unit in distances:
            if unit.present[number]:
                step[f"{unit.name}_mm"] = int(unit.distance_mm[number])
                before[unit.name] = int(unit.wander_nm[number])
            step[f"{unit.name}_next_wander_nm"] = before[unit.name]
        step["truth_mm"] = int(motion.position_nm[number]) // NM_PER_MM
        steps.append(step)
    for reading in readings:
        if reading.cycle < len(steps):  # a reading may be repeated after the run's end
            steps[reading.cycle] |= reading_inputs(config, reading, int(motion.position_nm[reading.cycle]))
    return steps


def reading_inputs(config: OdometryConfig, reading: Reading, truth_nm: int) -> dict[str, int | bool]:
    """Return the inputs of a cycle with a reading, its ghosts included; `truth_nm` is the place of end A in that cycle."""
    return {**_reading(reading), **_marker(config, reading, truth_nm)}


def _marker(config: OdometryConfig, reading: Reading, truth_nm: int) -> dict[str, int | bool]:
    """Return the ghosts of a reading: the true place of its marker, and whether the marker's map place is far away from it."""
    if reading.place_mm is None:
        return {}
    name, length_mm = READERS[reading.end], config.vehicle_length_mm if reading.end else 0
    spot_nm = truth_nm - (reading.since_mm + length_mm) * NM_PER_MM
    stray = abs(reading.place_mm * NM_PER_MM - spot_nm) > far_away_mm(config) * NM_PER_MM
    return {f"{name}_spot_nm": spot_nm, f"{name}_stray": stray}


def _reading(reading: Reading) -> dict[str, int | bool]:
    name = READERS[reading.end]
    if reading.place_mm is None:
        return {name: reading.marker}
    return {
        name: reading.marker,
        f"{name}_position_mm": reading.place_mm,
        f"{name}_accuracy_mm": reading.accuracy_mm,
        f"{name}_since_mm": reading.since_mm,
    }
