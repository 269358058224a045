"""Simulated distances of a vehicle's units, and the distances that the machine `motion` reports for them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from safeloc.codegen.compiled import Compiled, compile_system
from safeloc.language.system import lower, without_ghosts
from safeloc.models.motion import MotionConfig, build, parts
from safeloc.simulation.faults import Fault
from safeloc.simulation.motion import Motion
from safeloc.simulation.sensors import Distances, measure


@lru_cache(maxsize=8)
def _on_board(config: str) -> Compiled:
    """Return the machine without its world, compiled once for each configuration (JSON)."""
    return compile_system(without_ghosts(lower(build(parts(MotionConfig.model_validate_json(config))).machine)))


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
    odometer, check = measure(name, motion, config.odometer, rng, faults=faults), None
    if config.check is not None:
        check = measure("check", motion, config.check, rng)
    return Measured(odometer, check, reported(config, odometer, check))


def reported(config: MotionConfig, odometer: Distances, check: Distances | None) -> Distances:
    """Return the distances that motion reports; without a check unit, those that the odometer measured."""
    if config.check is None or check is None:
        return odometer
    board = _on_board(config.model_dump_json())
    state, step, more = board.first(), np.zeros_like(odometer.step_mm), np.zeros_like(odometer.step_mm)
    present = np.zeros_like(odometer.present)
    for cycle in range(len(step)):
        inputs = {
            name: int(unit.step_mm[cycle])
            for name, unit in (("odometer_mm", odometer), ("check_mm", check))
            if unit.present[cycle]
        }
        state, _ = board.step(state, board.read(inputs))
        outputs = board.named_outputs(state)
        step[cycle], present[cycle], more[cycle] = outputs["distance_mm"], outputs["told"], outputs["more_nm"]
    return replace(odometer, step_mm=step, present=present, more_nm=more)
