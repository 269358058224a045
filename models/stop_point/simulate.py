"""Simulated stops at a platform, by default that of source fig. 2, as step streams of the stop-point machine with ghosts.

The reflector machine, on a simulated run, reports position and bounds; the speed has its measuring error. The movement is
fixed beforehand, well or badly driven, and does not follow the machine's orders.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from safeloc.errors import InputError
from safeloc.language.nodes import Value
from safeloc.language.units import NM_PER_MM, NM_PER_UM
from safeloc.models.reflector.simulate import FIGURE_2, STOPS_MM, Balise, Scene, outputs_along, simulate, stopping
from safeloc.models.reflector.variables import ReflectorConfig
from safeloc.models.stop_point.variables import StopPointConfig
from safeloc.runtime.streams.steps import Cell
from safeloc.simulation.motion import Motion

_WINDOW_MM = 500
SPEED_MM_S, BRAKE_MM_S2, STAND_S = 20_000, 800, 6.0


SOURCE = ReflectorConfig(map_accuracy_mm=20, frame_latency_ms=0, balise_latency_ms=0)
_PLATFORM = Scene(replace(FIGURE_2, balises=(Balise(202, 100_000, accuracy_mm=50),)), error_mm=50)
"""A stop within half a metre needs a balise known to 5 cm, a radar and a survey as exact, and a front end that brings ranges to
the cycle's end: what the radar's self-test leaves open has to fit the window ([S] coded balises at platforms: 50 mm)."""


@dataclass(frozen=True)
class Stop:
    """One drive to a stop point of the platform.

    number   the stop point, from 1 on
    off_mm   place at which the vehicle first comes to stand, relative to the stop point
    moves    further movements (mm, negative: backwards), each at reduced speed and permitted
    """

    number: int = 1
    off_mm: int = 0
    moves: tuple[int, ...] = ()


@dataclass(frozen=True)
class StopPlace:
    """A stop point of the platform: place of end A of a stopped vehicle, and the window on either side; mm."""

    position_mm: int
    before_mm: int = _WINDOW_MM
    after_mm: int = _WINDOW_MM


_FIGURE_2_STOPS = tuple(StopPlace(place) for place in STOPS_MM)
IN_PLACE, OVERRUN, SHORT = Stop(), Stop(off_mm=3_000, moves=(-3_000,)), Stop(number=2, off_mm=-2_000, moves=(2_000,))


def simulate_stop(
    config: StopPointConfig, *, seed: int, stop: Stop = IN_PLACE, reduced_mm_s: int = 600
) -> list[dict[str, Cell]]:
    """Return one drive as steps: inputs, ghost inputs, and the remark `truth_mm`. In the last cycles there is a departure order."""
    motion = _motion(stop, reduced_mm_s, SOURCE.period_ms)
    given = Platform(_FIGURE_2_STOPS, stop.number, bool(stop.moves))
    return simulate_platform(config, given, motion, source=SOURCE, scene=_PLATFORM, seed=seed)


@dataclass(frozen=True)
class Platform:
    """Stop points of a platform in order, number of the selected one, and the permission to reposition."""

    stops: tuple[StopPlace, ...]
    selected: int
    permitted: bool


def simulate_platform(
    config: StopPointConfig, platform: Platform, motion: Motion, *, source: ReflectorConfig, scene: Scene, seed: int
) -> list[dict[str, Cell]]:
    """Return a given motion along a platform as steps; the reflector machine `source` reports the position on `scene`.

    InputError for more stop points than the configuration has.
    """
    if not 1 <= platform.selected <= len(platform.stops) <= config.stop_points:
        raise InputError(
            f"stop {platform.selected} of {len(platform.stops)}: the machine is configured for {config.stop_points} stops."
        )
    rng = np.random.default_rng(seed)
    seen = [_position(one) for one in outputs_along(source, simulate(source, seed=seed, scene=scene, motion=motion))]
    speeds = np.clip(motion.speed_mm_s, -config.max_speed_mm_s, config.max_speed_mm_s)
    steps = []
    for cycle, reported in enumerate(seen):
        true_speed = int(speeds[cycle])
        steps.append(
            {
                **reported,
                "speed_mm_s": true_speed if true_speed == 0 else true_speed + speed_error(rng, config),
                **places(config, platform.stops),
                "selected_stop": platform.selected,
                "reposition_permitted": platform.permitted,
                "departure": cycle >= len(seen) - 1,
                "released": False,
                "next_truth_nm": int(motion.position_nm[cycle]),
                "next_true_speed_mm_s": true_speed,
                "next_run_out_nm": run_out_nm(config, true_speed),
                "truth_mm": int(motion.position_nm[cycle]) // NM_PER_MM,
            }
        )
    return steps


def run_out_nm(config: StopPointConfig, speed_mm_s: int) -> int:
    """Return the run-out of a vehicle of that speed after an order to brake, by the guaranteed rate, nm; 0 if it runs back."""
    speed = max(speed_mm_s, 0)
    return (speed * config.reaction_ms + speed * speed * 1_000 // (2 * config.brake_mm_s2)) * NM_PER_UM


def speed_error(rng: np.random.Generator, config: StopPointConfig) -> int:
    """Draw the error of a measured speed, mm/s: up to four tenths of the permitted one."""
    return int(rng.uniform(-0.4, 0.4) * config.speed_error_mm_s)


def _motion(stop: Stop, reduced_mm_s: int, period_ms: int) -> Motion:
    first = STOPS_MM[stop.number - 1] + stop.off_mm
    moves = [(first, SPEED_MM_S, BRAKE_MM_S2, STAND_S)]
    moves += [(distance, reduced_mm_s, 300, STAND_S) for distance in stop.moves]
    return stopping(period_ms, moves)


def places(config: StopPointConfig, stops: Sequence[StopPlace]) -> dict[str, Cell]:
    """Return the map's inputs; a stop point that the platform does not have gets the window of the first one, if there is one."""
    inputs: dict[str, Cell] = {}
    for number in range(1, config.stop_points + 1):
        known = number <= len(stops)
        stop = stops[number - 1] if known else next(iter(stops), StopPlace(0))
        inputs |= {f"stop_{number}_position_mm": stop.position_mm} if known else {}
        inputs |= {f"stop_{number}_before_mm": stop.before_mm, f"stop_{number}_after_mm": stop.after_mm}
    return inputs


def _position(outputs: Mapping[str, Value]) -> dict[str, Cell]:
    """Return the reflector machine's report as inputs of this one; 0 where there is no position."""
    names = ("position_mm", "margin_above_mm", "margin_below_mm")
    interval: dict[str, Cell] = {name: outputs[name] if outputs["valid"] else 0 for name in names}
    return {"position_valid": outputs["valid"], "position_precise": outputs["precise"], **interval}
