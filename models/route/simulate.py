"""Simulated runs through switches as step streams of the route machine, and the map's answers to what it sees.

The map answers step by step to the hypotheses of the machine on board, so each stream is made with the machine running.
A stream contains the ghosts: the interpreter checks on it that the assumption holds.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from safeloc.codegen.compiled import Compiled, compile_system
from safeloc.errors import InputError
from safeloc.language.nodes import Value
from safeloc.language.system import lower, without_ghosts
from safeloc.language.units import NM_PER_MM
from safeloc.models.route import machine
from safeloc.models.route.variables import RouteConfig
from safeloc.railway.map.elements import Reflector
from safeloc.railway.map.routes import Route
from safeloc.runtime.streams.steps import Cell
from safeloc.simulation import sensors
from safeloc.simulation.faults import Fault
from safeloc.simulation.motion import Leg, Motion, VehicleConfig, move
from safeloc.simulation.sensors import Distances, measure

Steps = list[dict[str, Cell]]
_BY_OWN_TRACK_MM = 20_000
"""Farthest range at which the lateral place of an image tells that the reflector stands by the own track."""
_GATE_MM = 10_000
"""How much farther than its error a sighting may lie from the interval before the cycle: what is run, and what a lateral distance adds."""


@dataclass(frozen=True)
class Sight:
    """A reflector on a way, or seen from it: its distance from the common start, and the view zone before it, mm."""

    identity: str
    place_mm: int
    model: str
    view_from_mm: int
    view_to_mm: int


@dataclass(frozen=True)
class Way:
    """One of the routes: its number in the machine, the reflectors along it, in order, and those beside other tracks that are seen from it."""

    number: int
    sights: tuple[Sight, ...]
    beside: tuple[Sight, ...] = ()

    def nearest(self, model: str, expected_mm: float) -> Sight | None:
        """Return the reflector of a model that is nearest to a place; None if the way has none of that model."""
        fitting = [sight for sight in self.sights if sight.model == model]
        return min(fitting, key=lambda sight: abs(sight.place_mm - expected_mm), default=None)

    def others(self, model: str, low_mm: int, high_mm: int) -> bool:
        """Return whether a reflector of a model that stands beside another track would be between two places of the way."""
        return any(sight.model == model and low_mm <= sight.place_mm <= high_mm for sight in self.beside)


def way(number: int, route: Route, beside: Iterable[tuple[int, Reflector]] = ()) -> Way:
    """Return a route of a line as a way; its start is the common start. `beside`: reflectors of other branches, with their places."""
    seen = [(met.position_mm, met.element) for met in route.objects() if isinstance(met.element, Reflector)]
    return Way(number, tuple(_sights(seen)), tuple(_sights(beside)))


def _sights(found: Iterable[tuple[int, Reflector]]) -> Iterator[Sight]:
    for place, one in found:
        yield Sight(one.id, place, one.model, one.view_from_mm, one.view_to_mm)


def answers(ways: Sequence[Way], carried: Mapping[str, Value], sighting: Mapping[str, Cell]) -> dict[str, Cell]:
    """Return the map's inputs for a sighting: for each route, its nearest reflector of that model, and whether others are in view.

    carried   the machine's outputs, with the interval of every route; while none is possible, the map returns nothing
    """
    possible = any(carried[f"route_{one.number}_possible"] for one in ways)
    if "sighting_range_mm" not in sighting or not possible:
        return {}
    model, away = str(sighting["sighting_model"]), int(sighting["sighting_range_mm"])
    gate = int(sighting["sighting_error_mm"]) + _GATE_MM
    inputs: dict[str, Cell] = {}
    for one in ways:
        low, high = (int(carried[f"route_{one.number}_{end}_mm"]) for end in ("low", "high"))
        found = one.nearest(model, (low + high) / 2 + away)
        inputs[f"route_{one.number}_other_in_view"] = one.others(model, low + away - gate, high + away + gate)
        if found is not None:
            inputs |= {f"route_{one.number}_reflector_mm": found.place_mm, f"route_{one.number}_model": found.model}
    return inputs


def quiet(config: RouteConfig) -> dict[str, Cell]:
    """Return the inputs of a cycle with no sighting, no turn, no start and no known authority."""
    inputs: dict[str, Cell] = {"sighting_error_mm": 0, "sighting_model": "NONE", "sighting_by_own_track": False}
    inputs["course_taken"] = "UNDECIDED"
    for number in range(1, config.routes + 1):
        name = f"route_{number}"
        inputs |= {f"{name}_candidate": False, f"{name}_model": "NONE", f"{name}_course": "UNDECIDED"}
        inputs[f"{name}_other_in_view"] = False
    return {**inputs, "authorised_route": 0}


def simulate(
    config: RouteConfig,
    ways: Sequence[Way],
    taken: int,
    *,
    seed: int,
    legs: Sequence[Leg] = (),
    motion: Motion | None = None,
    dropout: float = 0.01,
    sensor_faults: Sequence[Fault] = (),
    authorised: int = 0,
    start_error_mm: int = 4_000,
    radar_error_mm: int = 200,
    missed: Collection[str] = (),
    misread: Mapping[str, str] | None = None,
) -> Steps:
    """Return a run along the way numbered `taken`: inputs, ghost inputs, and the remark `truth_mm` (rounded down).

    legs, motion   the vehicle's movement: one of the two
    sensor_faults  named faults of `odometer`; only a drop-out keeps the assumption
    authorised     number of the route that the movement authority names; 0: none
    missed   identities of reflectors that are never seen
    misread  identity of a reflector -> the wrong model that is recognised; this breaks the assumption
    InputError for a number that no way has, or more ways than the configuration has routes.
    """
    true = {one.number: one for one in ways}.get(taken)
    if true is None or not {one.number for one in ways} <= set(range(1, config.routes + 1)):
        raise InputError(f"route {taken} of {config.routes}: the ways are numbered {[one.number for one in ways]}.")
    rng = np.random.default_rng(seed)
    if motion is None:
        vehicle = VehicleConfig(max_speed_mm_s=max(100, int(config.max_speed_mm_s * 0.9)))
        motion = move(vehicle, legs, config.period_ms)
    sensors.KINDS.require(sensor_faults, places=["odometer"], length=len(motion.position_nm))
    distances = measure("odometer", motion, config.odometer, rng, dropout=dropout, faults=sensor_faults)
    run = _Run(
        config, ways, true, motion, distances, rng, start_error_mm, radar_error_mm, set(missed), dict(misread or {})
    )
    steps = [run.start(), *(run.step(number) for number in range(len(motion.position_nm)))]
    return [{**step, "authorised_route": authorised} for step in steps]


@lru_cache(maxsize=8)
def _on_board(config: str) -> Compiled:
    """Return the machine without its world, cached for further runs with the same configuration (JSON)."""
    return compile_system(without_ghosts(lower(machine(RouteConfig.model_validate_json(config)))))


class _Run:
    """A run under way: the machine on board, and the world it runs in."""

    def __init__(
        self, config: RouteConfig, ways: Sequence[Way], true: Way, motion: Motion, distances: Distances,
        rng: np.random.Generator, start_error_mm: int, radar_error_mm: int, missed: set[str], misread: dict[str, str],
    ) -> None:  # fmt: skip
        self._ways, self._true, self._motion, self._distances, self._rng = ways, true, motion, distances, rng
        self._start_error_mm, self._radar_error_mm = start_error_mm, radar_error_mm
        self._missed, self._misread, self._wander = missed, misread, 0
        self._in_sight: dict[str, Cell] = {"sighted_place_nm": 0, "sighted_model": "NONE", "sighted_elsewhere": False}
        self._offset = int(rng.uniform(-0.9, 0.9) * start_error_mm) * NM_PER_MM - motion.start_nm
        self._board: Compiled = _on_board(config.model_dump_json())
        self._state = self._board.first()
        self._quiet = quiet(config)

    def start(self) -> dict[str, Cell]:
        """Return the inputs and ghosts of the common start, from which every way leads on."""
        inputs = {**self._quiet, "start_error_mm": self._start_error_mm}
        inputs |= {f"route_{one.number}_candidate": True for one in self._ways}
        self._take(inputs)
        truth = self._motion.start_nm + self._offset
        return {**inputs, **self._ghosts(0, truth)}

    def step(self, number: int) -> dict[str, Cell]:
        """Return the inputs and ghosts of one cycle, and run it in the machine on board."""
        inputs = dict(self._quiet)
        if self._distances.present[number]:
            inputs["odometer_mm"] = int(self._distances.distance_mm[number])
            self._wander = int(self._distances.wander_nm[number])
        truth = int(self._motion.position_nm[number]) + self._offset
        inputs |= self._sighting(truth)
        inputs |= answers(self._ways, self._board.named_outputs(self._state), inputs)
        self._take(inputs)
        return {**inputs, **self._ghosts(int(self._motion.distance_nm[number]), truth)}

    def _sighting(self, truth_nm: int) -> dict[str, Cell]:
        """Return the sighting of the nearest reflector in view, beside whichever track, unless that one is missed."""
        every = (*self._true.sights, *self._true.beside)
        ahead = [(sight.place_mm * NM_PER_MM - truth_nm, sight) for sight in every]
        seen = [(away, sight) for away, sight in ahead if sight.view_to_mm <= away / NM_PER_MM <= sight.view_from_mm]
        if not seen or min(seen, key=lambda one: one[0])[1].identity in self._missed:
            return {}
        away, sight = min(seen, key=lambda one: one[0])
        measured = round(away / NM_PER_MM + self._rng.uniform(-0.9, 0.9) * self._radar_error_mm)
        model = self._misread.get(sight.identity, sight.model)
        own = sight in self._true.sights
        place = sight.place_mm * NM_PER_MM if own else 0
        self._in_sight = {"sighted_place_nm": place, "sighted_model": sight.model, "sighted_elsewhere": not own}
        return {
            "sighting_range_mm": max(measured, 0),
            "sighting_error_mm": self._radar_error_mm,
            "sighting_model": model,
            "sighting_by_own_track": own and away <= _BY_OWN_TRACK_MM * NM_PER_MM,
        }

    def _take(self, inputs: Mapping[str, Cell]) -> None:
        self._state, _ = self._board.step(self._state, self._board.read(inputs))

    def _ghosts(self, distance_nm: int, truth_nm: int) -> dict[str, Cell]:
        return {
            "true_cycle_distance_nm": distance_nm,
            "start_truth_nm": truth_nm,
            "next_wander_nm": self._wander,
            "start_route": self._true.number,
            **self._in_sight,
            "true_course": "UNDECIDED",
            "truth_mm": truth_nm // NM_PER_MM,
        }
