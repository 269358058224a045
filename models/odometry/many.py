"""Many vehicles with the odometry machine at once: the sensors of `simulate`, as arrays over vehicles.

Each vehicle drives one of a few motions and draws the errors of each unit, and the places of each reader's markers, from a stream of its own.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from safeloc.language.system import TransitionSystem
from safeloc.language.units import NM_PER_MM
from safeloc.models.odometry.ghosts import READERS
from safeloc.models.odometry.late_marker import late_marker
from safeloc.models.odometry.simulate import reading_inputs, units_of
from safeloc.models.odometry.variables import OdometryConfig
from safeloc.models.vocabulary.error_law import ErrorLaw
from safeloc.models.vocabulary.measuring_world import Physics
from safeloc.simulation import reader_faults, sensors
from safeloc.simulation.faults import Fault, Kinds
from safeloc.simulation.many_runs import Array, Drawn, DrawnFigure, ManyRuns, absent_everywhere
from safeloc.simulation.motion import Motions
from safeloc.simulation.physics import conditions, reader_timing
from safeloc.simulation.physics.conditions import Conditions, Unit
from safeloc.simulation.physics.late_readings import late_readings
from safeloc.simulation.physics.lawful_wander import can_be_run, first_breach, lawful_wander
from safeloc.simulation.physics.map_errors import MapError
from safeloc.simulation.physics.reader_timing import Way, timing_of
from safeloc.simulation.physics.speed_radar import SHARED_RADAR
from safeloc.simulation.reader_faults import with_faults
from safeloc.simulation.sensors import (
    SEVERITY,
    Distances,
    Reading,
    draws_of,
    faulty,
    measure_many,
    measured,
    passages,
    read_markers,
)
from safeloc.simulation.vehicle_seed import VehicleSeed

MISSED = "missed"
SHARED_WHEEL = "wheel"
"""The name of the figures of a vehicle's wheels where other machines read the front one as well."""
_ACCURACY_MM = 1_000
ENDS = ("front", "rear")
READER_FIGURES: Mapping[str, DrawnFigure] = {
    **reader_timing.FIGURES, **reader_timing.mounting(ENDS[0]), **reader_timing.mounting(ENDS[1])
}  # fmt: skip
"""Figures of the readers at both ends."""


@dataclass(frozen=True, eq=False)
class Drives:
    """Drives that begin at 0 and never turn back: the place of end A, nm, array [cycle, drive], and each vehicle's drive."""

    position_nm: NDArray[np.int64]
    of_vehicle: NDArray[np.int64]


def figures_of(config: OdometryConfig) -> dict[str, DrawnFigure]:
    """Return the figures of the sensors that may be drawn."""
    found = {MISSED: DrawnFigure("share", 0, 1, 0.0, "markers that a reader does not report")}
    wheels, radars = (
        [name for name, law in units_of(config).items() if law.kind == kind] for kind in ("wheel", "radar")
    )
    found |= conditions.figures_of(wheels, radars)
    found |= READER_FIGURES
    for name in units_of(config):
        found[f"{name}_severity"] = DrawnFigure(
            "share", 0, 100, 0.9, f"error of {name} as a share of what its law allows; above 1 it breaks the law"
        )
        found[f"{name}_dropout"] = DrawnFigure("share", 0, 1, 0.0, f"cycles in which {name} measures nothing")
    return found


def kinds_of(config: OdometryConfig) -> dict[str | int, Kinds]:
    """Return the kinds of fault of each unit and reader."""
    return {**dict.fromkeys(units_of(config), sensors.KINDS), **dict.fromkeys(READERS, reader_faults.KINDS)}


def simulate_many(
    config: OdometryConfig,
    system: TransitionSystem,
    drives: Drives,
    markers: Sequence[tuple[int, int]],
    accuracy_mm: Mapping[int, int],
    drawn: Drawn,
) -> ManyRuns:
    """Return the runs of the vehicles along a line with these markers; errors of markers reach nine tenths of their accuracy."""
    position = drives.position_nm[:, drives.of_vehicle]
    cycles, vehicles = position.shape
    inputs = absent_everywhere(system, cycles, vehicles)
    true = np.diff(position, axis=0, prepend=np.int64(0))
    inputs["true_cycle_distance_nm"][:] = true
    inputs["true_length_nm"][:] = config.vehicle_length_mm * NM_PER_MM
    met = Conditions(drawn.figures, drawn.seeds, position, true, config.vehicle_length_mm)
    for name, law in units_of(config).items():
        unit = _measured(name, law, true, config.period_ms, drawn)
        if law.kind == "wheel":
            unit = met.measured(_unit(config, name, law), unit, drawn.faults)
        if law.kind == "radar":
            unit = met.measured_by_radar(_unit(config, name, law), unit, drawn.faults)
        inputs[f"{name}_mm"], inputs[f"{name}_mm.present"] = unit.distance_mm, unit.present
        inputs[f"{name}_next_wander_nm"] = unit.wander_nm
    maps = met.maps(max((place for _, place in markers), default=0))
    for end, offset in enumerate((0, config.vehicle_length_mm)):
        _read(inputs, config, end, offset, position, markers, accuracy_mm, maps, drawn)
    return ManyRuns(inputs)


def _unit(config: OdometryConfig, name: str, law: ErrorLaw) -> Unit:
    """Return the wheel or radar of either device, that of the rear one as far behind as the reader there."""
    behind_mm = config.vehicle_length_mm if name.startswith("rear") else 0
    limits = Physics.of(config, config.lone_limit_cycles + 1)
    return Unit(name, name, law, limits, config.period_ms, behind_mm)


def simulate_shared(
    config: OdometryConfig,
    system: TransitionSystem,
    motions: Motions,
    seeds: Sequence[VehicleSeed],
    faults: Sequence[Sequence[Fault]],
    markers: Sequence[tuple[int, int]],
    shared: Sequence[Distances | None],
    met: Conditions,
    maps: Sequence[MapError],
) -> dict[str, Array]:
    """Return the inputs of vehicles, each with its motion, without drop-outs and markers missed.

    Markers lie up to nine tenths of their accuracy from their places on the map, other ones for each reader and vehicle. A fault of a reader at a
    time without a reading changes nothing.

    shared     distances [cycle, vehicle] of the front end's units that other machines read as well; None: a unit of its own
    met, maps  rail and wheels of the vehicles, which are those of the shared odometer, and the error of each one's map
    """
    cycles, vehicles = motions.position_nm.shape
    inputs = absent_everywhere(system, cycles, vehicles)
    inputs["true_cycle_distance_nm"][:] = motions.distance_nm
    inputs["true_length_nm"][:] = config.vehicle_length_mm * NM_PER_MM
    for name, law, other in zip(units_of(config), units_of(config).values(), [*shared, None, None], strict=False):
        unit = other or measure_many(
            name, motions.distance_nm, motions.period_ms, law, [seed.rng(f"odometry {name}") for seed in seeds],
            dropout=[0.0] * vehicles, severity=[SEVERITY] * vehicles,
            faults=[[fault for fault in own if fault.where not in READERS] for own in faults],
        )  # fmt: skip
        if other is None and law.kind == "wheel":
            wheel = replace(_unit(config, name, law), figures=SHARED_WHEEL)
            unit = met.measured(wheel, unit, faults)
        if other is None and law.kind == "radar":
            radar = replace(_unit(config, name, law), figures=SHARED_RADAR)
            unit = met.measured_by_radar(radar, unit, faults)
        inputs[f"{name}_mm"] = np.where(unit.present, unit.distance_mm, 0)
        inputs[f"{name}_mm.present"], inputs[f"{name}_next_wander_nm"] = unit.present, unit.wander_nm
    accuracy_mm = dict.fromkeys((marker for marker, _ in markers), _ACCURACY_MM)
    places = np.array([place for _, place in markers], dtype=np.float64)
    for run, seed in enumerate(seeds):
        motion, beside = motions.of(run), maps[run].at(places).tolist()
        for end, (name, offset) in enumerate(zip(READERS, (0, config.vehicle_length_mm), strict=True)):
            read = read_markers(
                motion, end, offset, markers, accuracy_mm, seed.rng(f"odometry {name}"),
                own_share=maps[run].own_share, beside_mm=beside,
            )  # fmt: skip
            own = [fault for fault in faults[run] if fault.where == name]
            _tell(inputs, config, read, end, motion.position_nm, markers, own, met.figures, seed, run)
    return inputs


def faulty_unit(
    config: OdometryConfig, met: Conditions, told: Mapping[str, tuple[NDArray[np.int64], NDArray[np.bool_]]]
) -> NDArray[np.int64]:
    """Return the unit of each vehicle that breaks its law, as the world numbers it: of several units the first that does; 0 for none.

    told  of each unit by its name: what it told in each cycle, mm, and whether it told anything, arrays [cycle, vehicle]
    """
    found = np.zeros(len(met.seeds), dtype=np.int64)
    by_physics = met.by_physics | met.radars_by_physics(SHARED_RADAR)
    if not by_physics.any():
        return found
    laws, cycles = units_of(config), len(met.true_nm)
    earliest = np.where(by_physics, cycles, 0)
    for name, (told_mm, present) in told.items():
        counts = can_be_run(told_mm, present, Physics.of(config, config.lone_limit_cycles + 1))
        _, broken = lawful_wander(met.true_nm, told_mm, counts, laws[name], config.period_ms)
        first = first_breach(broken)
        found = np.where(first < earliest, 1 + list(laws).index(name), found)
        earliest = np.minimum(earliest, first)
    return found


def _measured(name: str, law: ErrorLaw, true: NDArray[np.int64], period_ms: int, drawn: Drawn) -> Distances:
    """Return what a unit of each vehicle measures by its law, with its faults."""
    rngs = [seed.rng(name) for seed in drawn.seeds]
    bias, wanted, present = draws_of(rngs, len(true), drawn.figures[f"{name}_dropout"].tolist())
    for run, faults in enumerate(drawn.faults):
        for fault in faults:
            if fault.kind == "drop-out" and fault.strikes(name):
                present[fault.span, run] = False
    step, wander = measured(true, period_ms, law, drawn.figures[f"{name}_severity"], bias, wanted, present)
    for run, faults in enumerate(drawn.faults):
        of_unit = [fault for fault in faults if fault.strikes(name)]
        if of_unit:
            step[:, run] = np.where(present[:, run], faulty(name, step[:, run], of_unit), 0)
    return Distances(name, step, present, wander)


def _read(
    inputs: dict[str, Array],
    config: OdometryConfig,
    end: int,
    offset_mm: int,
    position: NDArray[np.int64],
    markers: Sequence[tuple[int, int]],
    accuracy_mm: Mapping[int, int],
    maps: Sequence[MapError],
    drawn: Drawn,
) -> None:
    """Write the readings of one reader into the inputs."""
    most = np.array([accuracy_mm[marker] for marker, _ in markers], dtype=np.float64)
    identities = np.array([marker for marker, _ in markers])
    places = np.array([place for _, place in markers], dtype=np.float64)
    for run, seed in enumerate(drawn.seeds):
        rng = seed.rng(READERS[end])
        own = maps[run].own_share
        shifts = rng.uniform(-own, own, len(markers)) * most + maps[run].at(places)
        readings = passages(position[:, run], 0, end, offset_mm, markers, shifts, accuracy_mm)
        lost = set(identities[rng.random(len(markers)) < drawn.figures[MISSED][run]].tolist())
        seen = [one for one in readings if one.marker not in lost]
        faults = [one for one in drawn.faults[run] if one.strikes(READERS[end])]
        _tell(inputs, config, seen, end, position[:, run], markers, faults, drawn.figures, seed, run)


def _tell(
    inputs: dict[str, Array],
    config: OdometryConfig,
    readings: Sequence[Reading],
    end: int,
    position_nm: NDArray[np.int64],
    markers: Sequence[tuple[int, int]],
    faults: Sequence[Fault],
    figures: Mapping[str, NDArray[np.float64]],
    seed: VehicleSeed,
    run: int,
) -> None:
    """Write what the reader of one vehicle tells: its readings as late as it stamps them, with its faults."""
    timing = timing_of(figures, run, ENDS[end])
    offset_mm = config.vehicle_length_mm if end else 0
    late = late_readings(
        readings, Way(0, position_nm, config.period_ms), offset_mm, timing, seed.rng(f"latency {READERS[end]}")
    )
    for one in with_faults(READERS[end], late, markers, faults, anywhen=True):
        if one.cycle < len(position_nm):
            truth_nm = int(position_nm[one.cycle])
            cells = reading_inputs(config, one, truth_nm)
            if one.spot_nm is not None and one.place_mm is not None:
                ran_nm = truth_nm - (int(position_nm[one.cycle - 1]) if one.cycle else 0)
                cells |= late_marker(config, one, truth_nm, ran_nm, timing.mounting_mm)
            _write(inputs, cells, one.cycle, run)


def _write(inputs: dict[str, Array], cells: Mapping[str, int | bool], cycle: int, run: int) -> None:
    for name, value in cells.items():
        inputs[name][cycle, run] = value
        if f"{name}.present" in inputs:
            inputs[f"{name}.present"][cycle, run] = True
