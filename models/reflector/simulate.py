"""Simulated radar frames, odometer and balises as step streams of the reflector machine, its ghosts included.

The map is simulated too: its next reflector is the one ahead of the reported position, so each stream is made step by step with
the machine running. A stream contains the ghosts: the interpreter checks on it that the assumption holds.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from safeloc.language.nodes import Value
from safeloc.language.units import NM_PER_MM
from safeloc.models.reflector.simulation.draws import OfOne
from safeloc.models.reflector.simulation.many import on_board, simulate_many
from safeloc.models.reflector.simulation.radar import ECHO, MODELS, Instants, Radars, empty_slots, intensity_cdb
from safeloc.models.reflector.simulation.scene import (
    FIGURE_1,
    FIGURE_2,
    KINDS,
    NOWHERE,
    STOPS_MM,
    Balise,
    Reflector,
    Route,
    Scene,
)
from safeloc.models.reflector.step_inputs import completed
from safeloc.models.reflector.variables import ReflectorConfig
from safeloc.runtime.streams.steps import Cell
from safeloc.simulation import sensors
from safeloc.simulation.many_runs import refuse_beyond_ranges
from safeloc.simulation.motion import Leg, Motion, Motions, VehicleConfig, move
from safeloc.simulation.sensors import Distances, measure

__all__ = [
    "FIGURE_1", "FIGURE_2", "KINDS", "STOPS_MM", "Balise", "Radar", "Reflector", "Route", "Scene", "intensity_cdb", "next_on_map",
    "simulate",
]  # fmt: skip

Steps = list[dict[str, Cell]]


def simulate(
    config: ReflectorConfig,
    *,
    seed: int,
    scene: Scene | None = None,
    legs: Sequence[Leg] | None = None,
    motion: Motion | None = None,
    measured: Distances | None = None,
) -> Steps:
    """Return a run as steps: inputs, ghost inputs, and the remark `truth_mm` (rounded down).

    legs, motion  the vehicle's movement, from 0 on; 20 m/s and a stop beyond fig. 1 by default
    measured      distances of an odometer that other machines read as well, with its faults
    """
    scene, rng = scene or Scene(), np.random.default_rng(seed)
    if motion is None:
        vehicle = VehicleConfig(max_speed_mm_s=int(config.max_speed_mm_s * 0.9))
        motion = move(vehicle, legs or [Leg(20_000, 45), Leg(0, 25)], config.period_ms)
    sensors.KINDS.require(scene.sensor_faults, places=["wheel"], length=len(motion.position_nm))
    KINDS.require(scene.disturbances, places=[""], length=len(motion.position_nm))
    if any(len(one.ends_mm) != len(motion.position_nm) for one in scene.others):
        raise ValueError(
            f"another vehicle needs a place for each cycle of the run, {len(motion.position_nm)}; give `ends_mm` so many."
        )
    odometer = measured or measure(
        "wheel", motion, config.odometer, rng, dropout=scene.dropout, faults=scene.sensor_faults
    )
    motions = Motions.alone(motion)
    inputs = simulate_many(config, scene, motions, odometer.as_column, [scene.disturbances], OfOne(rng))
    refuse_beyond_ranges(on_board(config.model_dump_json(), None).system, inputs)
    return _steps(config, motion, {name: values[:, 0].tolist() for name, values in inputs.items()})


def next_on_map(route: Route, reported: Mapping[str, Value], passed_mm: int | None) -> dict[str, Cell]:
    """Return the map's next reflector: beyond the balise that was passed, else the target, else the reported position.

    reported  outputs of the machine after the last step
    """
    if passed_mm is None and not reported["valid"]:
        return {}
    sighted = reported["reflector_model"] != 0
    here = reported["reflector_position_mm"] if sighted else reported["position_mm"] - reported["margin_below_mm"]
    found = route.ahead(int(here) if passed_mm is None else passed_mm)
    if found is None:
        return {}
    return {
        "next_position_mm": found.position_mm,
        "next_model": found.model,
        "next_view_from_mm": found.view_from_mm,
        "next_view_to_mm": found.view_to_mm,
        "next_clear_mm": route.clear_mm(found),
    }


_OPTIONAL = (
    "distance_mm", "balise", "balise_position_mm", "balise_accuracy_mm", "balise_since_mm", "balise_search_from_mm",
)  # fmt: skip
"""Inputs of odometer and balises, each present or absent, in the order of a step."""
_NEXT = ("next_position_mm", "next_model", "next_view_from_mm", "next_view_to_mm", "next_clear_mm")
"""Inputs of the next reflector, which are present together."""


def _steps(config: ReflectorConfig, motion: Motion, columns: Mapping[str, list[int]]) -> Steps:
    """Return the run of the only vehicle as steps."""
    slots = range(1, config.echo_slots + 1)
    more = ("distance_more_nm",) if config.checked_distance else ()
    echoes = [(slot, tuple(f"echo_{slot}_{name}" for name in ECHO)) for slot in slots]
    steps: Steps = []
    for cycle, place in enumerate(motion.position_nm):
        row = {name: values[cycle] for name, values in columns.items()}
        shown = [*more, *(name for name in _OPTIONAL if row[f"{name}.present"])]
        shown += _NEXT if row["next_position_mm.present"] else ()
        shown += ["next_reference_mm"] if row["next_reference_mm.present"] else []
        shown += ["frame_present"]
        shown += [name for slot, names in echoes if row[f"echo_{slot}_range_mm.present"] for name in names]
        given = completed(config, {name: _labelled(name, row[name]) for name in shown})
        step = {**no_origins(config), **given}
        step |= {name: row[name] for name in ("next_radar_bias_nm", "true_cycle_distance_nm", "next_wander_nm")}
        steps.append({**step, "truth_mm": int(place) // NM_PER_MM})
    return steps


def _labelled(name: str, value: int) -> Cell:
    return MODELS[value] if name.endswith("_model") else value


def no_origins(config: ReflectorConfig) -> dict[str, Cell]:
    """Return the ghosts of slots without an echo."""
    slots = range(1, config.echo_slots + 1)
    nothing = (("true_model", NOWHERE), ("origin_nm", 0), ("map_place_mm", 0), ("scaled_nm", 0))
    return {f"echo_{number}_{name}": cell for name, cell in nothing for number in slots}


class Radar:
    """The radar of one run, and what it meets along the route."""

    def __init__(self, config: ReflectorConfig, scene: Scene, rng: np.random.Generator) -> None:
        self._config, self._radars = config, Radars(config, scene, [scene.disturbances], OfOne(rng))

    def no_origins(self) -> dict[str, Cell]:
        """Return the ghosts of slots without an echo."""
        return no_origins(self._config)

    def frame(self, cycle: int, distance_nm: int, now: int) -> dict[str, Cell]:
        """Return the frame of a cycle that the vehicle ends at `now`, with the echoes' ghosts."""
        at = Instants(cycle, np.array([[distance_nm]]), np.array([[now]]))
        frames = self._radars.frames(at, empty_slots(self._config.echo_slots, (1,)))
        values: dict[str, Cell] = {"frame_present": bool(frames.present[0])}
        for slot in range(min(self._config.echo_slots, int(frames.number[0]))):
            for name, echoes in frames.echoes.items():
                values[f"echo_{slot + 1}_{name}"] = _labelled(f"_{name}", echoes[slot, 0].item())
        return values

    def bias_mm(self, cycle: int) -> int:
        """Return by how much the radar measures every range too long, mm."""
        return int(self._radars.biases_mm(cycle, 1)[0, 0])


def _is_ghost(name: str) -> bool:
    return name.endswith(("true_model", "origin_nm", "map_place_mm", "scaled_nm"))


def board(step: Mapping[str, Cell]) -> dict[str, Cell]:
    """Return a simulated step without ghosts and remarks, as the vehicle itself gets it."""
    left_out = ("true_cycle_distance_nm", "next_wander_nm", "next_radar_bias_nm", "truth_mm")
    return {name: value for name, value in step.items() if not _is_ghost(name) and name not in left_out}


def outputs_along(config: ReflectorConfig, stream: Sequence[Mapping[str, Cell]]) -> list[Mapping[str, Value]]:
    """Return the outputs of the machine on board after each step of a simulated stream."""
    code = on_board(config.model_dump_json(), None).python
    state, outputs = code.first(), list[Mapping[str, Value]]()
    for record in stream:
        state, _ = code.step(state, code.read(board(record)))
        outputs.append(code.named_outputs(state))
    return outputs


def lawful(step: Mapping[str, Cell]) -> dict[str, Cell]:
    """Return a simulated step with its ghosts, without the remark."""
    return {name: value for name, value in step.items() if name != "truth_mm"}


# ------------------------------------------------------------------ motion to a stop


def stopping(period_ms: int, moves: Sequence[tuple[int, int, int, float]]) -> Motion:
    """Return a motion made of moves, each from standstill to standstill: distance (mm, negative: backwards), top speed (mm/s),
    acceleration and brake (mm/s2), and the time it then stands (s). It begins at 0."""
    period = period_ms / 1_000
    speeds: list[float] = []
    place = 0.0
    places: list[float] = []
    for distance, top, rate, stand in moves:
        for share, speed in _trapezoid(abs(distance), top, rate, period):
            places.append(place + math.copysign(share, distance))
            speeds.append(math.copysign(speed, distance))
        place += distance
        rest = max(1, round(stand / period))
        places += [place] * rest
        speeds += [0.0] * rest
    position = np.rint(np.array(places) * NM_PER_MM).astype(np.int64)
    return Motion(period_ms, position, np.array(speeds), 0)


def _trapezoid(distance: int, top: int, rate: int, period: float) -> list[tuple[float, float]]:
    """Return distance and speed at the end of each cycle: speed up, run, brake."""
    top_speed = min(float(top), math.sqrt(distance * rate))
    ramp = top_speed / rate
    cruise = (distance - top_speed * ramp) / top_speed
    made = []
    for number in range(1, math.ceil((2 * ramp + cruise) / period)):
        t = number * period
        left = 2 * ramp + cruise - t
        if t < ramp:
            made.append((rate * t * t / 2, rate * t))
        elif left > ramp:
            made.append((rate * ramp * ramp / 2 + top_speed * (t - ramp), top_speed))
        else:
            made.append((distance - rate * left * left / 2, rate * left))
    return made
