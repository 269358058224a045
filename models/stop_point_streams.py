"""Simulated stops at the platform of source fig. 2 as step streams of the stop-point machine, its ghosts included.

Position and its bounds are those that the reflector machine reports on a simulated run; speed comes with its error.
The vehicle's driving is given beforehand, well or badly: the machine's orders are what is looked at.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from safeloc.backends.compiled import compile_system
from safeloc.models.reflector import machine
from safeloc.models.reflector_parts.variables import ReflectorConfig
from safeloc.models.reflector_streams import FIGURE_2, STOPS_MM, Scene, board, simulate, stopping
from safeloc.models.stop_point_parts.variables import StopPointConfig
from safeloc.simulation.motion import Motion
from safeloc.simulation.sensors import NM_PER_MM
from safeloc.streams.steps import Cell
from safeloc.system import lower, without_ghosts

WINDOW_MM = 500
SPEED_MM_S, BRAKE_MM_S2, STAND_S = 20_000, 800, 6.0


@dataclass(frozen=True)
class Stop:
    """One drive to a stop point of the platform.

    number   the stop point, from 1 on
    off_mm   where the vehicle comes to stand first, from the stop point on
    moves    further movements (mm, negative: backwards), each at reduced speed and permitted
    """

    number: int = 1
    off_mm: int = 0
    moves: tuple[int, ...] = ()


IN_PLACE, OVERRUN, SHORT = Stop(), Stop(off_mm=3_000, moves=(-3_000,)), Stop(number=2, off_mm=-2_000, moves=(2_000,))


def simulate_stop(
    config: StopPointConfig, *, seed: int, stop: Stop = IN_PLACE, reduced_mm_s: int = 600
) -> list[dict[str, Cell]]:
    """One drive as steps: inputs, ghost inputs, and the remark `truth_mm`. The last cycles are a departure order."""
    rng = np.random.default_rng(seed)
    motion = _motion(stop, reduced_mm_s, ReflectorConfig().period_ms)
    seen = _reported(motion, seed)
    speeds = np.clip(motion.speed_mm_s, -config.max_speed_mm_s, config.max_speed_mm_s)
    steps = []
    for cycle, reported in enumerate(seen):
        true_speed = int(speeds[cycle])
        steps.append(
            {
                **reported,
                "speed_mm_s": true_speed if true_speed == 0 else true_speed + _error(rng, config),
                **_platform(config),
                "selected_stop": stop.number,
                "reposition_permitted": bool(stop.moves),
                "departure": cycle >= len(seen) - 1,
                "released": False,
                "next_truth_nm": int(motion.position_nm[cycle]),
                "next_true_speed_mm_s": true_speed,
                "truth_mm": int(motion.position_nm[cycle]) // NM_PER_MM,
            }
        )
    return steps


def _error(rng: np.random.Generator, config: StopPointConfig) -> int:
    return int(rng.uniform(-0.4, 0.4) * config.speed_error_mm_s)


def _motion(stop: Stop, reduced_mm_s: int, period_ms: int) -> Motion:
    first = STOPS_MM[stop.number - 1] + stop.off_mm
    moves = [(first, SPEED_MM_S, BRAKE_MM_S2, STAND_S)]
    moves += [(distance, reduced_mm_s, 300, STAND_S) for distance in stop.moves]
    return stopping(period_ms, moves)


def _platform(config: StopPointConfig) -> dict[str, Cell]:
    known = dict(enumerate(STOPS_MM[: config.stop_points], 1))
    places: dict[str, Cell] = {f"stop_{number}_position_mm": place for number, place in known.items()}
    sides = [f"stop_{number}_{side}_mm" for number in range(1, config.stop_points + 1) for side in ("before", "after")]
    return {**places, **dict.fromkeys(sides, WINDOW_MM)}


def _reported(motion: Motion, seed: int) -> list[dict[str, Cell]]:
    """What the reflector machine says on the way."""
    config = ReflectorConfig()
    code = compile_system(without_ghosts(lower(machine(config))))
    state, said = code.first(), list[dict[str, Cell]]()
    for record in simulate(config, seed=seed, scene=Scene(FIGURE_2), motion=motion):
        state, _ = code.step(state, code.read(board(record)))
        out = code.named_outputs(state)
        said.append(
            {
                "position_valid": out["valid"],
                "position_precise": out["precise"],
                "position_mm": out["position_mm"],
                "over_mm": out["over_mm"],
                "under_mm": out["under_mm"],
            }
        )
    return said
