"""The radars of many vehicles: their frames as arrays over cells, a cycle of a vehicle each.

Cells are those of all cycles at once, or of one cycle (`Draws.at_once`), in the order of an array [cycle, vehicle].
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache

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

_NOBODY_MM = 10**9
"""How far ahead another vehicle is that is not ahead."""
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
class Instants:
    """Cycles of vehicles from `first` on: the run in each, and the place at its end, nm; arrays [cycle, vehicle]."""

    first: int
    distance_nm: NDArray[np.int64]
    now_nm: NDArray[np.int64]

    @property
    def cells(self) -> int:
        """The number of cells."""
        return self.now_nm.size

    @cached_property
    def ends_nm(self) -> NDArray[np.int64]:
        """The places at the end of the cycles, array [cell]."""
        return self.now_nm.ravel()


@dataclass(frozen=True, eq=False)
class Frames:
    """The frames of cells.

    present  whether there is a frame, array [cell]
    echoes   `ECHO`: name -> array [slot, cell], of which the filled slots are written
    number   of echoes of each cell; those beyond the slots are lost
    """

    present: NDArray[np.bool_]
    echoes: dict[str, Array]
    number: NDArray[np.int64]

    def add(self, which: Which, **values: Array | int | bool) -> None:
        """Put an echo of each of these cells into its next free slot."""
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


@lru_cache(maxsize=64)
def _intensities_cdb(view_from_mm: int, minimum_cdb: int) -> NDArray[np.int64]:
    """Return the intensity for each range up to twice the view zone's beginning, mm."""
    ranges = range(2 * view_from_mm)
    return np.array([intensity_cdb(one, view_from_mm, minimum_cdb) for one in ranges], dtype=np.int64)


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

    def _numbers(self, kind: str, first: int, cycles: int) -> NDArray[np.int64]:
        """Return the number of the fault that acts, array [cycle, vehicle]; -1 without one."""
        found = np.full((cycles, len(self.vehicles)), -1)
        for number, (vehicle, fault) in enumerate(self._of_kind.get(kind, ())):
            end = cycles if fault.end is None else max(0, fault.end - first)
            found[max(0, fault.begin - first) : end, vehicle] = number
        return found

    def acting(self, kind: str, first: int, cycles: int) -> NDArray[np.bool_]:
        """Return whether a fault of a kind acts, array [cell]."""
        return (self._numbers(kind, first, cycles) >= 0).ravel()

    def each(self, kind: str, first: int, cycles: int) -> Iterator[tuple[Fault, Which]]:
        """Yield the faults of a kind, each with the cells in which it acts."""
        numbers = self._numbers(kind, first, cycles).ravel()
        for number, (_, fault) in enumerate(self._of_kind.get(kind, ())):
            yield fault, np.flatnonzero(numbers == number)

    def figures(self, kind: str, name: str, first: int, cycles: int) -> NDArray[np.float64]:
        """Return a figure of the fault that acts, array [cell]; 0 without one."""
        found = np.zeros(cycles * len(self.vehicles))
        for fault, which in self.each(kind, first, cycles):
            found[which] = KINDS.figure(fault, name)
        return found


class Radars:
    """The radars of vehicles in one scene, each with its disturbances; `scene.disturbances` are not read.

    beside_mm  how far beyond its place each vehicle meets the reflector there: place, mm -> array [vehicle]; none without any
    """

    def __init__(
        self,
        config: ReflectorConfig,
        scene: Scene,
        disturbances: Sequence[Sequence[Fault]],
        draws: Draws,
        beside_mm: Mapping[int, NDArray[np.float64]] | None = None,
    ) -> None:
        self._config, self._scene, self._draws = config, scene, draws
        self._beside_nm = {
            place: np.rint(mm * NM_PER_MM).astype(np.int64) for place, mm in (beside_mm or {}).items() if mm.any()
        }
        self._disturbed, self._vehicles = Disturbances(disturbances), len(disturbances)
        route = scene.route
        seen = sorted((*route.reflectors, *route.beside), key=lambda one: one.position_mm)
        self._reflectors = [one for one in seen if one.position_mm not in route.missing]
        self._others_mm = [np.array(one.ends_mm, dtype=np.int64) for one in scene.others]

    def frames(self, at: Instants, slots: dict[str, Array]) -> Frames:
        """Return the frames of some cycles; fill these empty slots, arrays [slot, cell]."""
        all_ = np.arange(at.cells)
        paused = self._draws.shares("pause", all_) < self._scene.pauses
        if self._disturbed.have("pause"):
            paused |= self._disturbed.acting("pause", at.first, len(at.now_nm))
        frames = Frames(~paused, slots, np.zeros(at.cells, dtype=np.int64))
        which = np.flatnonzero(~paused)
        share = self._config.frame_latency_ms / self._config.period_ms * between(self._draws, "latency", which, 0, 0.8)
        at_frame = at.ends_nm[which] - (at.distance_nm.ravel()[which] * share).astype(np.int64)
        others = [self._ahead_mm(ends, at, which, at_frame) for ends in self._others_mm]
        for range_mm in (ahead_mm + self._config.radar_offset_mm for ahead_mm in others):
            met = range_mm < min(self._config.strong_range_mm, self._config.range_limit_mm)
            _add_thing(frames, which[met], range_mm[met], MODELS.index(NOWHERE), -4_000)
        self._reflected(frames, at, which, at_frame, np.min(others, axis=0, initial=_NOBODY_MM))
        if self._disturbed.have("decoy"):
            self._decoys(frames, at, paused)
        self._clutter(frames, which, at_frame)
        return frames

    def _in_reach(self, one: Reflector, at: Instants) -> bool:
        """Return whether a radar may receive a reflector from some place at which a vehicle is in these cycles."""
        farthest_mm = int(np.abs(at.distance_nm).max(initial=0)) / NM_PER_MM + 1
        if one.position_mm in self._beside_nm:
            farthest_mm += int(np.abs(self._beside_nm[one.position_mm]).max()) / NM_PER_MM
        beyond_mm = one.position_mm + self._config.radar_offset_mm
        nearest, last = (
            beyond_mm - int(end) / NM_PER_MM for end in (at.now_nm.max(initial=0), at.now_nm.min(initial=0))
        )
        return nearest <= 2 * one.view_from_mm + farthest_mm and one.view_to_mm - farthest_mm <= last

    def _ahead_mm(self, ends_mm: Array, at: Instants, which: Which, at_frame: NDArray[np.int64]) -> Array:
        """Return how far ahead of each cell the end of another vehicle is; `_NOBODY_MM` where it is behind."""
        ahead_mm = ends_mm[at.first + which // self._vehicles] - at_frame // NM_PER_MM
        return np.where(ahead_mm >= 0, ahead_mm, _NOBODY_MM)

    def _reflected(
        self, frames: Frames, at: Instants, which: Which, at_frame: NDArray[np.int64], free_mm: Array
    ) -> None:
        """Add the echoes of the reflectors near the vehicles, the nearest first; those more than `free_mm` ahead are hidden."""
        near = [(number, one) for number, one in enumerate(self._reflectors) if self._in_reach(one, at)]
        if not near:
            return
        sighted = np.ones(len(which), dtype=np.bool_)
        if self._disturbed.have("blind"):
            sighted = ~self._disturbed.acting("blind", at.first, len(at.now_nm))[which]
        for number, one in near:
            away_mm = one.position_mm + self._beside(one, which) / NM_PER_MM - at_frame / NM_PER_MM
            range_mm = np.rint(away_mm).astype(np.int64) + self._config.radar_offset_mm
            near_enough = (one.view_to_mm <= range_mm) & (range_mm < 2 * one.view_from_mm)
            seen = near_enough & (away_mm <= free_mm) & sighted
            if seen.any():
                self._echo(frames, at, number, which[seen], range_mm[seen])

    def _echo(self, frames: Frames, at: Instants, number: int, which: Which, range_mm: NDArray[np.int64]) -> None:
        error, most, minimum = self._scene.error_mm, self._config.range_limit_mm, self._config.minimum_intensity_cdb
        one = self._reflectors[number]
        noise = (between(self._draws, f"noise {number}", which, -0.8, 0.8) * (error - 1)).astype(np.int64)
        scaled = self._scaled_mm(at, which, range_mm)
        strong = _intensities_cdb(one.view_from_mm, minimum)[np.maximum(range_mm, 0)]
        if self._disturbed.have("weak"):
            strong = strong - 2_000 * self._disturbed.acting("weak", at.first, len(at.now_nm))[which]
        frames.add(
            which,
            range_mm=np.clip(range_mm + self._bias_mm(at)[which] + scaled + noise, 0, most),
            error_mm=error,
            model=MODELS.index(one.model),
            intensity_cdb=strong,
            lateral_mm=3_000 + between(self._draws, f"lateral {number}", which, -100, 100).astype(np.int64),
            true_model=MODELS.index(one.model),
            origin_nm=one.position_mm * NM_PER_MM + self._beside(one, which),
            map_place_mm=one.position_mm,
            scaled_nm=scaled * NM_PER_MM,
        )

    def _beside(self, one: Reflector, which: Which) -> Array | int:
        """Return how far beyond its place a reflector stands for the vehicles of these cells, nm."""
        beside = self._beside_nm.get(one.position_mm)
        return 0 if beside is None else beside[which % self._vehicles]

    def _bias_mm(self, at: Instants) -> NDArray[np.int64]:
        return self.biases_mm(at.first, len(at.now_nm)).ravel()

    def biases_mm(self, first: int, cycles: int) -> NDArray[np.int64]:
        """Return by how much each radar measures every range too long, mm: array [cycle, vehicle]."""
        if not self._disturbed.have("shift", "drift"):
            return np.zeros((cycles, self._vehicles), dtype=np.int64)
        found = self._disturbed.figures("shift", "by_mm", first, cycles)
        for drift, which in self._disturbed.each("drift", first, cycles):
            found[which] += KINDS.figure(drift, "by_mm") * (which // self._vehicles + first - drift.begin + 1)
        return found.astype(np.int64).reshape(cycles, self._vehicles)

    def _scaled_mm(self, at: Instants, which: Which, range_mm: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return by how much each radar measures its range too long in proportion, mm."""
        if not self._disturbed.have("scale"):
            return np.zeros(len(which), dtype=np.int64)
        by_ppm = self._disturbed.figures("scale", "by_ppm", at.first, len(at.now_nm))[which]
        return np.asarray((range_mm * by_ppm).astype(np.int64) // PPM_PER_ONE, dtype=np.int64)

    def _decoys(self, frames: Frames, at: Instants, paused: NDArray[np.bool_]) -> None:
        for decoy, which in self._disturbed.each("decoy", at.first, len(at.now_nm)):
            model = MODELS.index(KINDS.figure(decoy, "model"))
            _add_thing(frames, which[~paused[which]], KINDS.figure(decoy, "by_mm"), model, -5_000)

    def _clutter(self, frames: Frames, which: Which, at_frame: NDArray[np.int64]) -> None:
        """Add strong echoes of no model, and echoes with a reflector's signature that are too weak."""
        met = self._draws.shares("clutter", which) < self._scene.clutter
        if not met.any():
            return
        which, at_frame = which[met], at_frame[met]
        range_mm = between(self._draws, "clutter range", which, 2_000, 150_000).astype(np.int64)
        strong = self._draws.shares("clutter strength", which) < 0.5
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
