"""Many vehicles with the reflector machine at once, cycle by cycle with the machine on board, as arrays over vehicles.

The radars' frames follow from the runs alone; the map's next reflector follows from what the machine reports. One vehicle is the
case of one column (`safeloc.models.reflector.simulate`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from safeloc.codegen.batch_steps import Stepped, compile_steps
from safeloc.language.system import TransitionSystem, lower, without_ghosts
from safeloc.language.units import NM_PER_MM
from safeloc.models.reflector import machine
from safeloc.models.reflector.simulation.draws import Draws, between
from safeloc.models.reflector.simulation.map_ahead import TOLD, MapAhead
from safeloc.models.reflector.simulation.misplaced import Misplaced
from safeloc.models.reflector.simulation.radar import Instants, Radars, empty_slots
from safeloc.models.reflector.simulation.scene import Balise, Route, Scene
from safeloc.models.reflector.variables import ReflectorConfig
from safeloc.simulation.faults import Fault
from safeloc.simulation.many_runs import Array, absent_everywhere, through_border
from safeloc.simulation.motion import Motions
from safeloc.simulation.physics.gauss_markov import Floats
from safeloc.simulation.sensors import Distances


@lru_cache(maxsize=8)
def _with_world(config: str) -> TransitionSystem:
    """Return the machine with its world for a configuration (JSON)."""
    return lower(machine(ReflectorConfig.model_validate_json(config)))


@lru_cache(maxsize=8)
def on_board(config: str, libraries: Path | None) -> Stepped:
    """Return the machine without its world, compiled once for each configuration (JSON)."""
    return compile_steps(without_ghosts(_with_world(config)), TOLD, folder=libraries)


def simulate_many(
    config: ReflectorConfig,
    scene: Scene,
    motions: Motions,
    odometers: Distances,
    disturbances: Sequence[Sequence[Fault]],
    draws: Draws,
    libraries: Path | None = None,
    misplaced: Misplaced | None = None,
) -> dict[str, Array]:
    """Return the inputs of vehicles, ghosts included: name -> array [cycle, vehicle].

    odometers     their distances, arrays [cycle, vehicle]
    disturbances  of each vehicle's radar; those of the scene are not read
    libraries     folder for compiled machines; None: a temporary one
    misplaced     reflectors and balises that are not where the map has them; None: all are
    """
    inputs, passed = sensed(config, scene, motions, odometers, disturbances, draws, misplaced)
    if not scene.route.reflectors:  # the map answers nothing, so no input follows from what the machines report
        return inputs
    code = on_board(config.model_dump_json(), libraries)
    runs = code.begin(through_border(code.system, {var.name: inputs[var.name] for var in code.system.inputs})[0])
    line = MapAhead(scene.route, inputs)
    for cycle, balises in enumerate(passed):
        line.answer(cycle, runs.told, balises)
        runs.step(cycle)
    return inputs


def sensed(
    config: ReflectorConfig,
    scene: Scene,
    motions: Motions,
    odometers: Distances,
    disturbances: Sequence[Sequence[Fault]],
    draws: Draws,
    misplaced: Misplaced | None,
) -> tuple[dict[str, Array], NDArray[np.int64]]:
    """Return the inputs without the map's, and the number of the balise that is passed, -1 for none: arrays [cycle, vehicle]."""
    inputs = _of_vehicles(config, _with_world(config.model_dump_json()), motions, odometers)
    beside = {} if misplaced is None else misplaced.balises
    passed = _passed(motions, scene.route, beside)
    radars = Radars(config, scene, disturbances, draws, None if misplaced is None else misplaced.reflectors)
    _sense(config, inputs, motions, scene.route.balises, passed, radars, draws, beside)
    if misplaced is not None:
        misplaced.explain(config, inputs, motions.position_nm)
    return inputs, passed


def _sense(
    config: ReflectorConfig,
    inputs: dict[str, Array],
    motions: Motions,
    balises: Sequence[Balise],
    passed: NDArray[np.int64],
    radars: Radars,
    draws: Draws,
    beside: Mapping[int, Floats],
) -> None:
    """Write readings of balises and frames of the radars into the inputs, all cycles at once or one after the other."""
    numbers = np.zeros(passed.shape, dtype=np.int64)
    slots, distance = empty_slots(config.echo_slots, passed.shape), motions.distance_nm
    size = max(1, len(passed)) if draws.at_once else 1
    for first in range(0, len(passed), size):
        some = slice(first, first + size)
        at = Instants(first, distance[some], motions.position_nm[some])
        _read_balises(config, inputs, balises, passed[some], at, draws, beside)
        echoes = {name: values[:, some].reshape(config.echo_slots, -1) for name, values in slots.items()}
        frames = radars.frames(at, echoes)
        inputs["frame_present"][some] = frames.present.reshape(at.now_nm.shape)
        numbers[some] = frames.number.reshape(at.now_nm.shape)
    inputs["next_radar_bias_nm"][:] = radars.biases_mm(0, len(passed)) * NM_PER_MM
    for slot in range(config.echo_slots):
        inputs |= {f"echo_{slot + 1}_{name}": values[slot] for name, values in slots.items()}
        inputs[f"echo_{slot + 1}_range_mm.present"] = numbers > slot


def _of_vehicles(
    config: ReflectorConfig, system: TransitionSystem, motions: Motions, odometers: Distances
) -> dict[str, Array]:
    """Return the inputs without balises, map and radar."""
    inputs = absent_everywhere(system, *odometers.distance_mm.shape)
    inputs["distance_mm"][:] = np.where(odometers.present, odometers.distance_mm, 0)
    inputs["distance_mm.present"][:] = odometers.present
    if config.checked_distance and odometers.more_nm is not None:
        inputs["distance_more_nm"][:] = odometers.more_nm
    inputs["true_cycle_distance_nm"][:] = motions.distance_nm
    inputs["next_wander_nm"][:] = _last_measured(odometers)
    return inputs


def _last_measured(odometers: Distances) -> NDArray[np.int64]:
    """Return the wander after the last cycle with a distance; 0 before the first one."""
    numbers = np.arange(1, len(odometers.present) + 1)[:, None]
    last = np.maximum.accumulate(np.where(odometers.present, numbers, 0), axis=0)
    padded = np.vstack([np.zeros((1, odometers.wander_nm.shape[1]), dtype=np.int64), odometers.wander_nm])
    return np.asarray(np.take_along_axis(padded, last, axis=0), dtype=np.int64)


def _passed(motions: Motions, route: Route, beside_mm: Mapping[int, Floats]) -> NDArray[np.int64]:
    """Return the number of the balise passed in each cycle, array [cycle, vehicle]: of several the first one of the route; -1 for none.

    beside_mm  how far beyond its place each vehicle meets the balise there, array [vehicle]
    """
    after = motions.position_nm
    before = np.vstack([np.full((1, after.shape[1]), motions.start_nm), after[:-1]])
    low, high = np.minimum(before, after), np.maximum(before, after)
    found = np.full(after.shape, -1)
    for number, balise in reversed(list(enumerate(route.balises))):
        place: Array | int = balise.position_mm * NM_PER_MM
        if balise.position_mm in beside_mm:
            place = place + np.rint(beside_mm[balise.position_mm] * NM_PER_MM).astype(np.int64)
        found[(low < place) & (place <= high)] = number
    return found


def _read_balises(
    config: ReflectorConfig,
    inputs: Mapping[str, Array],
    balises: Sequence[Balise],
    passed: NDArray[np.int64],
    at: Instants,
    draws: Draws,
    beside_mm: Mapping[int, Floats],
) -> None:
    begin = at.first * passed.shape[1]
    for number, balise in enumerate(balises):
        which = np.flatnonzero(passed == number)
        if not len(which):
            continue
        error = (between(draws, "balise", which, -0.8, 0.8) * balise.accuracy_mm).astype(np.int64)
        if balise.position_mm in beside_mm:
            error = error - np.rint(beside_mm[balise.position_mm][which % passed.shape[1]]).astype(np.int64)
        since = np.rint(at.ends_nm[which] / NM_PER_MM).astype(np.int64) - balise.position_mm + error
        cells: dict[str, Array | int] = {
            "balise": balise.identity,
            "balise_position_mm": balise.position_mm,
            "balise_accuracy_mm": balise.accuracy_mm,
            "balise_since_mm": np.clip(since, -config.max_cycle_distance_mm, config.max_cycle_distance_mm),
        }
        if balise.search_from_mm is not None:
            cells["balise_search_from_mm"] = balise.search_from_mm
        for name, value in cells.items():
            inputs[name].reshape(-1)[begin + which], inputs[f"{name}.present"].reshape(-1)[begin + which] = value, True
