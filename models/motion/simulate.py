"""Simulated distances of a vehicle's units, and the distances that the machine `motion` reports for them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from safeloc.codegen.batch_steps import Stepped, compile_steps
from safeloc.language.system import lower, without_ghosts
from safeloc.models.motion import MotionConfig, build, parts
from safeloc.models.vocabulary.error_law import ErrorLaw
from safeloc.simulation.faults import Fault
from safeloc.simulation.many_runs import absent_everywhere, through_border
from safeloc.simulation.motion import Motion, Motions
from safeloc.simulation.physics.conditions import Conditions, Unit
from safeloc.simulation.physics.lawful_wander import can_be_run, first_breach, lawful_wander, wander_within
from safeloc.simulation.physics.speed_radar import SHARED_RADAR
from safeloc.simulation.sensors import SEVERITY, Distances, measure, measure_many
from safeloc.simulation.vehicle_seed import VehicleSeed

_TOLD = ("distance_mm", "reported", "more_nm")
_APART = "units_apart_nm"
"""State of the machine: part of the reported distance's error where the check unit is the lawful one."""


@lru_cache(maxsize=8)
def _on_board(config: str, libraries: Path | None) -> Stepped:
    """Return the machine without its world, compiled once for each configuration (JSON)."""
    system = without_ghosts(lower(build(parts(MotionConfig.model_validate_json(config))).machine))
    (apart,) = (var for var in system.state if var.name == _APART)
    return compile_steps(replace(system, outputs={**system.outputs, _APART: apart}), (*_TOLD, _APART), folder=libraries)


@dataclass(frozen=True, eq=False)
class LawfulUnit:
    """The unit that keeps its law, which the world may choose: by hindsight, the one whose laws hold for longer.

    is_check           whether it is the check unit, array [vehicle]
    wander_nm          its one-off error after each cycle, as the odometer's
    between_pulses_nm  the place between two pulses at which the vehicle last stood, after each cycle
    """

    is_check: NDArray[np.bool_]
    wander_nm: NDArray[np.int64]
    between_pulses_nm: NDArray[np.int64]


@dataclass(frozen=True)
class Measured:
    """Distances of the vehicle's units, and those that motion reports to the machines that share the odometer.

    lawful  which unit the world takes for the lawful one
    """

    odometer: Distances
    check: Distances | None
    reported: Distances
    lawful: LawfulUnit


def measured_by(
    name: str, config: MotionConfig, motion: Motion, rng: np.random.Generator, faults: Sequence[Fault]
) -> Measured:
    """Return the distances of both units along a drive; `name` and `faults` are those of the odometer."""
    odometer = measure(name, motion, config.odometer, rng, faults=faults)
    check = None if config.check is None else measure("check", motion, config.check, rng)
    return Measured(odometer, check, reported(config, odometer, check), _odometer_lawful(odometer.wander_nm, 1))


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
        wheel = Unit(name, name, config.odometer, config.physics, config.period_ms)
        odometer = met.measured(wheel, odometer, faults)
    check = None if config.check is None else _measured("check", config.check, motions, seeds, [()] * len(seeds))
    if met is not None and config.check is not None and check is not None and config.check.kind == "radar":
        radar = Unit(SHARED_RADAR, "check", config.check, config.physics, config.period_ms)
        check = met.measured_by_radar(radar, check, [()] * len(seeds))
    lawful = _odometer_lawful(odometer.wander_nm, len(seeds))
    if met is not None and _by_physics(met).any() and check is not None:
        lawful = _by_hindsight(config, met, odometer, check)
    return Measured(odometer, check, _reported(config, odometer, check, lawful, libraries), lawful)


def _odometer_lawful(wander_nm: NDArray[np.int64], vehicles: int) -> LawfulUnit:
    return LawfulUnit(np.zeros(vehicles, dtype=np.bool_), wander_nm, np.zeros_like(wander_nm))


def _by_physics(met: Conditions) -> NDArray[np.bool_]:
    """Return which vehicles have a wheel or a radar that is simulated from its physics."""
    return met.by_physics | met.radars_by_physics(SHARED_RADAR)


def _by_hindsight(config: MotionConfig, met: Conditions, odometer: Distances, check: Distances) -> LawfulUnit:
    """Return the lawful unit of vehicles: the check unit, with a wander that explains it, where its laws hold for longer than the odometer's.

    Where the check unit is the lawful one, a vehicle that counts as standing has to stay between two pulses, and the wander rests there.
    """
    assert config.check is not None
    of_odometer, of_check = (can_be_run(one.distance_mm, one.present, config.physics) for one in (odometer, check))
    _, broken = lawful_wander(met.true_nm, odometer.distance_mm, of_odometer, config.odometer, config.period_ms)
    still = np.zeros(of_check.shape, dtype=np.bool_)
    if config.unmeasured is not None:
        floor = config.check.floor_mm_s * config.period_ms // 1_000
        still = of_odometer & of_check & (odometer.distance_mm == 0) & (np.abs(check.distance_mm) <= floor)
    wander, unlawful = lawful_wander(met.true_nm, check.distance_mm, of_check & ~still, config.check, config.period_ms)
    place, creeps = _between_pulses(config, met.true_nm, still)
    is_check = _by_physics(met) & (first_breach(unlawful | creeps) > first_breach(broken))
    return LawfulUnit(is_check, np.where(is_check, wander, odometer.wander_nm), np.where(is_check, place, 0))


def _between_pulses(
    config: MotionConfig, true_nm: NDArray[np.int64], still: NDArray[np.bool_]
) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Return the place between two pulses of vehicles that count as standing, where they do not as they last stood; and where there is none.

    It is anywhere when a stop begins.
    """
    if config.unmeasured is None:
        return np.zeros_like(true_nm), np.zeros_like(still)
    whole = config.unmeasured.between_pulses_nm
    slack = np.where(still, config.unmeasured.creep_nm(config.period_ms), whole)
    before = np.zeros((1, true_nm.shape[1]), dtype=np.int64)
    off, slack = np.vstack([before, np.where(still, true_nm, 0)]), np.vstack([before + whole, slack])
    place, none = wander_within(off, slack, whole // 2)
    numbers = np.arange(1, len(still) + 1)[:, None]
    last = np.maximum.accumulate(np.where(still, numbers, 0), axis=0)
    return np.take_along_axis(np.vstack([before, place[1:]]), last, axis=0), none[1:]


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
    lawful = _odometer_lawful(odometer.as_column.wander_nm, 1)
    return _reported(config, odometer.as_column, check.as_column, lawful, None).of(0)


def _reported(
    config: MotionConfig, odometer: Distances, check: Distances | None, lawful: LawfulUnit, libraries: Path | None
) -> Distances:
    if config.check is None or check is None:
        return odometer
    code = _on_board(config.model_dump_json(), libraries)
    inputs = absent_everywhere(code.system, *odometer.distance_mm.shape)
    for name, unit in (("odometer_mm", odometer), ("check_mm", check)):
        inputs[name], inputs[f"{name}.present"] = np.where(unit.present, unit.distance_mm, 0), unit.present
    told = code.through(through_border(code.system, inputs)[0])
    step, present, more = (told[name] for name in _TOLD)
    wander = lawful.wander_nm + np.where(lawful.is_check, told[_APART] + lawful.between_pulses_nm, 0)
    return replace(odometer, distance_mm=step, present=present, wander_nm=wander, more_nm=more)
