"""What motion tells of the distances that a vehicle's units measured: run through the machine itself."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np

from safeloc.backends.compiled import Compiled, compile_system
from safeloc.models.motion import MotionConfig, build, parts
from safeloc.simulation.sensors import Distances
from safeloc.system import lower, without_ghosts


@lru_cache(maxsize=8)
def _on_board(config: str) -> Compiled:
    """The machine without its environment, by its configuration (JSON)."""
    return compile_system(without_ghosts(lower(build(parts(MotionConfig.model_validate_json(config))).machine)))


def told(config: MotionConfig, odometer: Distances, check: Distances | None) -> Distances:
    """The distances that those hear who share the odometer; without a check unit, those that it measured."""
    if config.check is None or check is None:
        return odometer
    board = _on_board(config.model_dump_json())
    state, step, more = board.first(), np.zeros_like(odometer.step_mm), np.zeros_like(odometer.step_mm)
    present = np.zeros_like(odometer.present)
    for cycle in range(len(step)):
        heard = {
            name: int(unit.step_mm[cycle])
            for name, unit in (("odometer_mm", odometer), ("check_mm", check))
            if unit.present[cycle]
        }
        state, _ = board.step(state, board.read(heard))
        said = board.named_outputs(state)
        step[cycle], present[cycle], more[cycle] = said["distance_mm"], said["told"], said["more_nm"]
    return replace(odometer, step_mm=step, present=present, more_nm=more)
