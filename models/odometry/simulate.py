"""Simulated sensors as step streams of the odometry machine, its ghosts included.

Because a stream contains the ghosts, the interpreter can check on it that it obeys the assumption.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

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
from safeloc.simulation.sensors import SEVERITY, Distances, Reading, measure_many, read_markers, skip_measure

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
    first_unit: Distances | None = None,
    second_unit: Distances | None = None,
) -> Steps:
    """Return one run as steps: inputs, ghost inputs, and the remark `truth_mm` (rounded down).

    markers  (identity, place in mm) in order of place; every 250 m by default
    marker_accuracy_mm  of all markers, or of each by its identity
    motion   the vehicle's run; without it, the run over `legs`, or over a random service
    faults   named faults of `front_wheel`, `front_radar`, ... (`sensors.KINDS`) and of `front_marker`, `rear_marker`
             (`reader_faults.KINDS`); while one is active the assumption may be broken
    first_unit, second_unit  distances of the front end's units, if other machines use the same; they contain their faults already
    """
    rng = np.random.default_rng(seed)
    vehicle = vehicle_of(config)
    if motion is None:
        motion = move(vehicle, legs or plan(vehicle, seconds, rng), config.period_ms)
    units, (readings,) = sensed(
        config, motion, [rng], [faults], markers=markers, marker_accuracy_mm=marker_accuracy_mm, dropout=dropout,
        missed=missed, foreign=foreign, first_unit=first_unit and first_unit.as_column,
        second_unit=second_unit and second_unit.as_column,
    )  # fmt: skip
    return _steps(config, motion, [unit.of(0) for unit in units], readings)


def sensed(
    config: OdometryConfig,
    motion: Motion,
    rngs: Sequence[np.random.Generator],
    faults: Sequence[Sequence[Fault]],
    *,
    markers: Sequence[tuple[int, int]] | None,
    marker_accuracy_mm: int | Mapping[int, int],
    dropout: float,
    missed: float,
    foreign: float,
    first_unit: Distances | None,
    second_unit: Distances | None,
    anywhen: bool = False,
) -> tuple[list[Distances], list[list[Reading]]]:
    """Return what the units and readers of vehicles on one run tell, each vehicle with its generator and faults.

    Distances are arrays [cycle, vehicle]; the readings of each vehicle are those of both readers. With `anywhen` a reader's fault may
    begin and end without a reading; else InputError.
    """
    ends = ("front", "rear")[: config.devices]
    laws = (config.first_unit, config.second_unit)
    names, cycles = [f"{end}_{law.kind}" for end in ends for law in laws], len(motion.position_nm)
    of_readers = [[fault for fault in own if fault.where in READERS] for own in faults]
    of_units = [[fault for fault in own if fault.where not in READERS] for own in faults]
    for own in of_units:
        sensors.KINDS.require(own, places=names, length=cycles)
    for own in of_readers:
        reader_faults.KINDS.require(own, length=cycles)
    shared, units = [first_unit, second_unit], list[Distances]()
    for name, law, other in zip(names, laws * len(ends), [*shared, None, None], strict=False):
        if other is None:
            units.append(_measured(name, law, motion, rngs, dropout, of_units))
            continue
        for rng in rngs:
            skip_measure(rng, cycles)
        units.append(replace(other, name=name))
    known = markers if markers is not None else [(n + 1, (n - 200) * 250_000) for n in range(400)]
    readings: list[list[Reading]] = [[] for _ in rngs]
    for end, (name, offset) in enumerate(zip(READERS, (0, config.vehicle_length_mm), strict=True)):
        for vehicle, rng in enumerate(rngs):
            read = read_markers(motion, end, offset, known, marker_accuracy_mm, rng, missed=missed, foreign=foreign)
            readings[vehicle] += with_faults(name, read, known, of_readers[vehicle], anywhen=anywhen)
    return units, readings


def _measured(
    name: str,
    law: ErrorLaw,
    motion: Motion,
    rngs: Sequence[np.random.Generator],
    dropout: float,
    faults: Sequence[Sequence[Fault]],
) -> Distances:
    vehicles, true = len(rngs), motion.distance_nm[:, None]
    return measure_many(
        name,
        true,
        motion.period_ms,
        law,
        rngs,
        dropout=[dropout] * vehicles,
        severity=[SEVERITY] * vehicles,
        faults=faults,
    )


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
