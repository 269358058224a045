"""Simulated distances of a vehicle's units, and the distances that the machine `motion` reports for them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import numpy as np

from safeloc.codegen.batch_steps import Stepped, compile_steps
from safeloc.language.system import lower, without_ghosts
from safeloc.models.motion import MotionConfig, build, parts
from safeloc.models.vocabulary.error_law import ErrorLaw
from safeloc.simulation.faults import Fault
from safeloc.simulation.many_runs import absent_everywhere, through_border
from safeloc.simulation.motion import Motion, Motions
from safeloc.simulation.physics.conditions import Conditions, Wheel
from safeloc.simulation.sensors import SEVERITY, Distances, measure, measure_many
from safeloc.simulation.vehicle_seed import VehicleSeed

_TOLD = ("distance_mm", "reported", "more_nm")


@lru_cache(maxsize=8)
def _on_board(config: str, libraries: Path | None) -> Stepped:
    """Return the machine without its world, compiled once for each configuration (JSON)."""
    system = without_ghosts(lower(build(parts(MotionConfig.model_validate_json(config))).machine))
    return compile_steps(system, _TOLD, folder=libraries)


@dataclass(frozen=True)
class Measured:
    """Distances of the vehicle's units, and those that motion reports to the machines that share the odometer."""

    odometer: Distances
    check: Distances | None
    reported: Distances


def measured_by(
    name: str, config: MotionConfig, motion: Motion, rng: np.random.Generator, faults: Sequence[Fault]
) -> Measured:
    """Return the distances of both units along a drive; `name` and `faults` are those of the odometer."""
    odometer = measure(name, motion, config.odometer, rng, faults=faults)
    check = None if config.check is None else measure("check", motion, config.check, rng)
    return Measured(odometer, check, reported(config, odometer, check))


def measured_by_many(
    name: str,
    config: MotionConfig,
    motions: Motions,
    seeds: Sequence[VehicleSeed],
    faults: Sequence[Sequence[Fault]],
    libraries: Path | None,
    met: Conditions | None = None,
) -> Measured:
    """Return the same of many vehicles, each with its motion, seed and faults: arrays [cycle, vehicle].

    libraries  folder for compiled machines; None: a temporary one
    met        rail and wheels of the vehicles; None: the odometer errs as its law says
    """
    odometer = _measured(name, config.odometer, motions, seeds, faults)
    if met is not None:
        wheel = Wheel(name, name, config.odometer, config.physics, config.period_ms)
        odometer = met.measured(wheel, odometer, faults)
    check = None if config.check is None else _measured("check", config.check, motions, seeds, [()] * len(seeds))
    return Measured(odometer, check, _reported(config, odometer, check, libraries))


def _measured(
    name: str, law: ErrorLaw, motions: Motions, seeds: Sequence[VehicleSeed], faults: Sequence[Sequence[Fault]]
) -> Distances:
    vehicles, rngs = len(seeds), [seed.rng(f"motion {name}") for seed in seeds]
    severity, dropout = [SEVERITY] * vehicles, [0.0] * vehicles
    true, period = motions.distance_nm, motions.period_ms
    return measure_many(name, true, period, law, rngs, dropout=dropout, severity=severity, faults=faults)


def reported(config: MotionConfig, odometer: Distances, check: Distances | None) -> Distances:
    """Return the distances that motion reports; without a check unit, those that the odometer measured."""
    if check is None:
        return odometer
    return _reported(config, odometer.as_column, check.as_column, None).of(0)


def _reported(config: MotionConfig, odometer: Distances, check: Distances | None, libraries: Path | None) -> Distances:
    if config.check is None or check is None:
        return odometer
    code = _on_board(config.model_dump_json(), libraries)
    inputs = absent_everywhere(code.system, *odometer.distance_mm.shape)
    for name, unit in (("odometer_mm", odometer), ("check_mm", check)):
        inputs[name], inputs[f"{name}.present"] = np.where(unit.present, unit.distance_mm, 0), unit.present
    told = code.through(through_border(code.system, inputs)[0])
    step, present, more = (told[name] for name in _TOLD)
    return replace(odometer, distance_mm=step, present=present, more_nm=more)
