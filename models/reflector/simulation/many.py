"""Many vehicles with the reflector machine on one run at once, cycle by cycle with the machine on board, as arrays over vehicles.

The radars' frames follow from the run alone; the map's next reflector follows from what the machine reports. One vehicle is the
case of one column (`safeloc.models.reflector.simulate`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from safeloc.codegen.batch_steps import Stepped, compile_steps
from safeloc.language.expr import NumVar
from safeloc.language.system import TransitionSystem, canonical, lower, without_ghosts
from safeloc.language.units import NM_PER_MM
from safeloc.models.reflector import machine
from safeloc.models.reflector.simulation.draws import Draws, between
from safeloc.models.reflector.simulation.radar import MODELS, Radars, empty_slots
from safeloc.models.reflector.simulation.scene import Balise, Route, Scene
from safeloc.models.reflector.variables import ReflectorConfig
from safeloc.simulation.faults import Fault
from safeloc.simulation.many_runs import Array, absent_everywhere, through_border
from safeloc.simulation.motion import Motion
from safeloc.simulation.sensors import Distances

_TOLD = ("valid", "reflector_model", "reflector_position_mm", "position_mm", "margin_below_mm")


@lru_cache(maxsize=8)
def _with_world(config: str) -> TransitionSystem:
    """Return the machine with its world for a configuration (JSON)."""
    return lower(machine(ReflectorConfig.model_validate_json(config)))


@lru_cache(maxsize=8)
def on_board(config: str, libraries: Path | None) -> Stepped:
    """Return the machine without its world, compiled once for each configuration (JSON)."""
    return compile_steps(without_ghosts(_with_world(config)), _TOLD, folder=libraries)


def simulate_many(
    config: ReflectorConfig,
    scene: Scene,
    motion: Motion,
    odometers: Distances,
    disturbances: Sequence[Sequence[Fault]],
    draws: Draws,
    libraries: Path | None = None,
) -> dict[str, Array]:
    """Return the inputs of vehicles, ghosts included: name -> array [cycle, vehicle].

    odometers     their distances, arrays [cycle, vehicle]
    disturbances  of each vehicle's radar; those of the scene are not read
    libraries     folder for compiled machines; None: a temporary one
    """
    made = config.model_dump_json()
    inputs = _of_vehicles(config, _with_world(made), motion, odometers)
    passed, radars = _passed(motion, scene.route), Radars(config, scene, disturbances, draws)
    numbers = np.zeros(odometers.distance_mm.shape, dtype=np.int64)
    slots = empty_slots(config.echo_slots, numbers.shape)
    before = motion.start_nm
    for cycle, now in enumerate(motion.position_nm.tolist()):
        if cycle in passed:
            _read_balise(config, inputs, cycle, passed[cycle], now, draws)
        echoes = {name: values[:, cycle] for name, values in slots.items()}
        frames = radars.frames(cycle, now - before, now, echoes)
        inputs["frame_present"][cycle] = frames.present
        numbers[cycle] = frames.number
        before = now
    inputs["next_radar_bias_nm"][:] = radars.biases_mm(len(motion.position_nm)) * NM_PER_MM
    for slot in range(config.echo_slots):
        inputs |= {f"echo_{slot + 1}_{name}": values[slot] for name, values in slots.items()}
        inputs[f"echo_{slot + 1}_range_mm.present"] = numbers > slot
    code = on_board(made, libraries)
    runs = code.begin(through_border(code.system, {var.name: inputs[var.name] for var in code.system.inputs})[0])
    line = _Map(scene.route, _with_world(made), inputs)
    for cycle in range(len(motion.position_nm)):
        line.answer(cycle, runs.told, passed.get(cycle))
        runs.step(cycle)
    return inputs


def _of_vehicles(
    config: ReflectorConfig, system: TransitionSystem, motion: Motion, odometers: Distances
) -> dict[str, Array]:
    """Return the inputs without balises, map and radar."""
    inputs = absent_everywhere(system, *odometers.distance_mm.shape)
    inputs["distance_mm"][:] = np.where(odometers.present, odometers.distance_mm, 0)
    inputs["distance_mm.present"][:] = odometers.present
    if config.checked_distance and odometers.more_nm is not None:
        inputs["distance_more_nm"][:] = odometers.more_nm
    inputs["true_cycle_distance_nm"][:] = motion.distance_nm[:, None]
    inputs["next_wander_nm"][:] = _last_measured(odometers)
    return inputs


def _last_measured(odometers: Distances) -> NDArray[np.int64]:
    """Return the wander after the last cycle with a distance; 0 before the first one."""
    numbers = np.arange(1, len(odometers.present) + 1)[:, None]
    last = np.maximum.accumulate(np.where(odometers.present, numbers, 0), axis=0)
    padded = np.vstack([np.zeros((1, odometers.wander_nm.shape[1]), dtype=np.int64), odometers.wander_nm])
    return np.asarray(np.take_along_axis(padded, last, axis=0), dtype=np.int64)


def _passed(motion: Motion, route: Route) -> dict[int, Balise]:
    """Return the balise passed in each cycle that has one; of several the first one of the route."""
    before = np.concatenate([[motion.start_nm], motion.position_nm[:-1]])
    low, high = np.minimum(before, motion.position_nm), np.maximum(before, motion.position_nm)
    found: dict[int, Balise] = {}
    for balise in reversed(route.balises):
        place = balise.position_mm * NM_PER_MM
        found |= dict.fromkeys(np.flatnonzero((low < place) & (place <= high)).tolist(), balise)
    return found


def _read_balise(
    config: ReflectorConfig, inputs: Mapping[str, Array], cycle: int, balise: Balise, now: int, draws: Draws
) -> None:
    everyone = np.arange(inputs["balise"].shape[1])
    error = (between(draws, everyone, -0.8, 0.8) * balise.accuracy_mm).astype(np.int64)
    since = round(now / NM_PER_MM) - balise.position_mm + error
    cells: dict[str, Array | int] = {
        "balise": balise.identity,
        "balise_position_mm": balise.position_mm,
        "balise_accuracy_mm": balise.accuracy_mm,
        "balise_since_mm": np.clip(since, -config.max_cycle_distance_mm, config.max_cycle_distance_mm),
    }
    if balise.search_from_mm is not None:
        cells["balise_search_from_mm"] = balise.search_from_mm
    for name, value in cells.items():
        inputs[name][cycle], inputs[f"{name}.present"][cycle] = value, True


class _Map:
    """The map of vehicles on one route: it answers with the next reflector beyond what each machine reports."""

    def __init__(self, route: Route, system: TransitionSystem, inputs: Mapping[str, Array]) -> None:
        reflectors = sorted(route.reflectors, key=lambda one: one.position_mm)
        self._places = np.array([one.position_mm for one in reflectors], dtype=np.int64)
        said = {
            "next_position_mm": [one.position_mm for one in reflectors],
            "next_model": [MODELS.index(one.model) for one in reflectors],
            "next_view_from_mm": [one.view_from_mm for one in reflectors],
            "next_view_to_mm": [one.view_to_mm for one in reflectors],
            "next_clear_mm": [route.clear_mm(one) for one in reflectors],
        }
        rest = {var.name: canonical(var) for var in system.inputs if isinstance(var, NumVar)}
        self._said = {name: np.array([*values, rest[name]], dtype=np.int64) for name, values in said.items()}
        self._inputs = inputs

    def answer(self, cycle: int, told: Mapping[str, Array], balise: Balise | None) -> None:
        """Write the next reflector: beyond the balise that was passed, else the target, else the reported position."""
        if balise is None:
            reported = told["position_mm"] - told["margin_below_mm"]
            here = np.where(told["reflector_model"] != 0, told["reflector_position_mm"], reported)
            number = np.where(told["valid"], np.searchsorted(self._places, here, side="right"), len(self._places))
        else:
            ahead = np.searchsorted(self._places, balise.position_mm, side="right")
            number = np.full(len(told["valid"]), ahead)
        found = number < len(self._places)
        if not found.any():
            return
        for name, values in self._said.items():
            self._inputs[name][cycle] = values[number]
        self._inputs["next_position_mm.present"][cycle] = found
        if balise is not None and balise.reference:
            self._inputs["next_reference_mm"][cycle] = self._inputs["next_position_mm"][cycle] - balise.position_mm
            self._inputs["next_reference_mm.present"][cycle] = found
