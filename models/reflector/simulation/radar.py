"""The radars of many vehicles on one run: their frames, cycle by cycle, as arrays over vehicles."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from safeloc.language.units import NM_PER_MM, PPM_PER_ONE
from safeloc.models.reflector.echo import INTENSITY_FLOOR_CDB
from safeloc.models.reflector.simulation.draws import Draws, Which, between
from safeloc.models.reflector.simulation.scene import KINDS, NOWHERE, Reflector, Scene
from safeloc.models.reflector.variables import ReflectorConfig
from safeloc.models.vocabulary.reflectors import MODEL
from safeloc.simulation.faults import Fault
from safeloc.simulation.many_runs import Array

_CDB_A_DOUBLING = 1_200
"""Range law: 12 dB less for each doubling of range."""
MODELS = tuple(one.label for one in MODEL)
"""Labels of the models by their numbers."""
ECHO = {
    "range_mm": 0, "error_mm": 0, "model": MODELS.index(NOWHERE), "intensity_cdb": INTENSITY_FLOOR_CDB, "lateral_mm": 0,
    "true_model": MODELS.index(NOWHERE), "origin_nm": 0, "map_place_mm": 0, "scaled_nm": 0,
}  # fmt: skip
"""Inputs and ghosts of a slot, in order, with their values while the slot is empty."""


@dataclass(frozen=True, eq=False)
class Frames:
    """The frames of one cycle.

    present  whether there is a frame, array [vehicle]
    echoes   `ECHO`: name -> array [slot, vehicle], of which the filled slots are written
    number   of echoes of each vehicle; those beyond the slots are lost
    """

    present: NDArray[np.bool_]
    echoes: dict[str, Array]
    number: NDArray[np.int64]

    def add(self, which: Which, **values: Array | int | bool) -> None:
        """Put an echo of each of these vehicles into its next free slot."""
        slots, slot = len(self.echoes["range_mm"]), self.number[which]
        free = slot < slots
        for name, value in values.items():
            self.echoes[name][slot[free], which[free]] = value[free] if isinstance(value, np.ndarray) else value
        self.number[which] += 1


def empty_slots(slots: int, shape: tuple[int, ...]) -> dict[str, Array]:
    """Return arrays of `ECHO` in which all slots are empty: name -> array [slot, ...]."""
    return {name: np.full((slots, *shape), empty) for name, empty in ECHO.items()}


def intensity_cdb(range_mm: int, view_from_mm: int, minimum_cdb: int) -> int:
    """Return the intensity: the minimum where the view zone begins, and 12 dB more for each halving of the range."""
    return minimum_cdb + math.floor(_CDB_A_DOUBLING * math.log2(view_from_mm / max(1, range_mm)))


@dataclass(frozen=True, eq=False)
class Disturbances:
    """Faults of the radars, for each vehicle its own; of several of a kind in a cycle the first one counts."""

    vehicles: Sequence[Sequence[Fault]]
    _of_kind: dict[str, list[tuple[int, Fault]]] = field(init=False, default_factory=dict)

    def __post_init__(self) -> None:
        for vehicle, faults in enumerate(self.vehicles):
            for fault in reversed(faults):
                self._of_kind.setdefault(fault.kind, []).append((vehicle, fault))

    def have(self, *kinds: str) -> bool:
        """Return whether any vehicle has a fault of one of these kinds."""
        return any(kind in self._of_kind for kind in kinds)

    def hits(self, kind: str, cycle: int) -> dict[int, Fault]:
        """Return the fault of a kind that acts in a cycle, for each vehicle that has one."""
        return {vehicle: fault for vehicle, fault in self._of_kind.get(kind, ()) if fault.active(cycle)}

    def figures(self, kind: str, name: str, cycle: int) -> NDArray[np.float64]:
        """Return a figure of that fault, array [vehicle]; 0 without one."""
        found = np.zeros(len(self.vehicles))
        for vehicle, fault in self.hits(kind, cycle).items():
            found[vehicle] = KINDS.figure(fault, name)
        return found


class Radars:
    """The radars of vehicles in one scene, each with its disturbances; `scene.disturbances` are not read."""

    def __init__(
        self, config: ReflectorConfig, scene: Scene, disturbances: Sequence[Sequence[Fault]], draws: Draws
    ) -> None:
        self._config, self._scene, self._draws = config, scene, draws
        self._disturbed, self._all = Disturbances(disturbances), np.arange(len(disturbances))
        route = scene.route
        seen = sorted((*route.reflectors, *route.beside), key=lambda one: one.position_mm)
        self._reflectors = [one for one in seen if one.position_mm not in route.missing]

    def frames(self, cycle: int, distance_nm: int, now: int, slots: dict[str, Array]) -> Frames:
        """Return the frames of a cycle in which the vehicles run `distance_nm` and that they end at `now`, nm; fill these empty slots."""
        paused = self._draws.shares(self._all) < self._scene.pauses
        if self._disturbed.have("pause"):
            paused[list(self._disturbed.hits("pause", cycle))] = True
        frames = Frames(~paused, slots, np.zeros(len(self._all), dtype=np.int64))
        which = np.flatnonzero(~paused)
        share = self._config.frame_latency_ms / self._config.period_ms * between(self._draws, which, 0, 0.8)
        at_frame = now - (distance_nm * share).astype(np.int64)
        near = [one for one in self._reflectors if self._in_reach(one, distance_nm, now)]
        if near:
            self._reflected(frames, cycle, near, which, at_frame)
        if self._disturbed.have("decoy"):
            self._decoys(frames, cycle, paused)
        self._clutter(frames, which, at_frame)
        return frames

    def _in_reach(self, one: Reflector, distance_nm: int, now: int) -> bool:
        """Return whether a radar may receive a reflector from some place at which the vehicle is in the cycle."""
        range_mm = one.position_mm - now / NM_PER_MM + self._config.radar_offset_mm
        run_mm = abs(distance_nm) / NM_PER_MM + 1
        return one.view_to_mm - run_mm <= range_mm <= 2 * one.view_from_mm + run_mm

    def _reflected(
        self, frames: Frames, cycle: int, near: Sequence[Reflector], which: Which, at_frame: NDArray[np.int64]
    ) -> None:
        """Add the echoes of the reflectors near the vehicles, the nearest first."""
        blind = list(self._disturbed.hits("blind", cycle))
        sighted = ~np.isin(which, blind) if blind else np.True_
        for one in near:
            range_mm = np.rint(one.position_mm - at_frame / NM_PER_MM).astype(np.int64) + self._config.radar_offset_mm
            seen = (one.view_to_mm <= range_mm) & (range_mm < 2 * one.view_from_mm) & sighted
            if seen.any():
                self._echo(frames, cycle, one, which[seen], range_mm[seen])

    def _echo(self, frames: Frames, cycle: int, one: Reflector, which: Which, range_mm: NDArray[np.int64]) -> None:
        error, most, minimum = self._scene.error_mm, self._config.range_limit_mm, self._config.minimum_intensity_cdb
        noise = (between(self._draws, which, -0.8, 0.8) * (error - 1)).astype(np.int64)
        scaled = self._scaled_mm(cycle, which, range_mm)
        weak = list(self._disturbed.hits("weak", cycle))
        strong = np.array(
            [intensity_cdb(value, one.view_from_mm, minimum) for value in range_mm.tolist()], dtype=np.int64
        )
        frames.add(
            which,
            range_mm=np.clip(range_mm + self.bias_mm(cycle)[which] + scaled + noise, 0, most),
            error_mm=error,
            model=MODELS.index(one.model),
            intensity_cdb=strong - 2_000 * np.isin(which, weak) if weak else strong,
            lateral_mm=3_000 + between(self._draws, which, -100, 100).astype(np.int64),
            true_model=MODELS.index(one.model),
            origin_nm=one.position_mm * NM_PER_MM,
            map_place_mm=one.position_mm,
            scaled_nm=scaled * NM_PER_MM,
        )

    def bias_mm(self, cycle: int) -> NDArray[np.int64]:
        """Return by how much each radar measures every range too long, mm."""
        found = self._disturbed.figures("shift", "by_mm", cycle)
        for vehicle, drift in self._disturbed.hits("drift", cycle).items():
            found[vehicle] += KINDS.figure(drift, "by_mm") * (cycle - drift.begin + 1)
        return found.astype(np.int64)

    def biases_mm(self, cycles: int) -> NDArray[np.int64]:
        """Return `bias_mm` of all cycles: array [cycle, vehicle]."""
        if not self._disturbed.have("shift", "drift"):
            return np.zeros((cycles, len(self._all)), dtype=np.int64)
        return np.stack([self.bias_mm(cycle) for cycle in range(cycles)])

    def _scaled_mm(self, cycle: int, which: Which, range_mm: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return by how much each radar measures its range too long in proportion, mm."""
        by_ppm = self._disturbed.figures("scale", "by_ppm", cycle)[which]
        return np.asarray((range_mm * by_ppm).astype(np.int64) // PPM_PER_ONE, dtype=np.int64)

    def _decoys(self, frames: Frames, cycle: int, paused: NDArray[np.bool_]) -> None:
        for vehicle, decoy in self._disturbed.hits("decoy", cycle).items():
            if not paused[vehicle]:
                model = MODELS.index(KINDS.figure(decoy, "model"))
                _add_thing(frames, np.array([vehicle]), KINDS.figure(decoy, "by_mm"), model, -5_000)

    def _clutter(self, frames: Frames, which: Which, at_frame: NDArray[np.int64]) -> None:
        """Add strong echoes of no model, and echoes with a reflector's signature that are too weak."""
        met = self._draws.shares(which) < self._scene.clutter
        if not met.any():
            return
        which, at_frame = which[met], at_frame[met]
        range_mm = between(self._draws, which, 2_000, 150_000).astype(np.int64)
        strong = self._draws.shares(which) < 0.5
        letter = np.where(at_frame % 2 == 0, MODELS.index("A"), MODELS.index("B"))
        model = np.where(strong, MODELS.index(NOWHERE), letter)
        weak_cdb = self._config.minimum_intensity_cdb - 1
        _add_thing(frames, which, range_mm, model, np.where(strong, -4_000, weak_cdb))


def _add_thing(
    frames: Frames, which: Which, range_mm: Array | int, model: Array | int, intensity_cdb: Array | int
) -> None:
    """Add the echo of a thing beside the track."""
    frames.add(
        which, range_mm=range_mm, error_mm=200, model=model, intensity_cdb=intensity_cdb, lateral_mm=-4_000,
        true_model=MODELS.index(NOWHERE), origin_nm=0, map_place_mm=0, scaled_nm=0,
    )  # fmt: skip
