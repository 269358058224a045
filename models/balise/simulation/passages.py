"""The antenna's passages over balise groups, and the telegrams that it reads there, with their ghosts and named faults."""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from safeloc.language.units import NM_PER_MM
from safeloc.models.balise.groups import Group, telegram
from safeloc.models.balise.simulation.late_group import LateGroup
from safeloc.models.balise.variables import BaliseConfig
from safeloc.runtime.streams.steps import Cell
from safeloc.simulation.faults import Fault, Kinds, plain
from safeloc.simulation.many_runs import DrawnFigure
from safeloc.simulation.motion import Motion
from safeloc.simulation.physics import reader_timing
from safeloc.simulation.physics.map_errors import OWN_SHARE, MapError
from safeloc.simulation.physics.reader_timing import ReaderTiming, Way, timing_of
from safeloc.simulation.vehicle_seed import VehicleSeed

_DISPLACED_MM = 40_000
"""Displacement of a group beyond twice the tolerance and twice its accuracy."""
_OTHER_TRACKS = 900_000
"""Identities from here on belong to groups of other tracks."""
KINDS = Kinds(
    "a balise group",
    plain(
        "missed", "corrupted", "incomplete", "wrong way", "early", "late", "duplicate", "stale", "malformed",
        "other identity",
    ),
)  # fmt: skip
"""Each at one group, by its identity, for the whole run. `early` and `late` displace the group farther than any interval reaches."""

ANTENNA_FIGURES: Mapping[str, DrawnFigure] = {**reader_timing.FIGURES, **reader_timing.mounting("antenna")}
"""Figures of the reader of balises, of `antenna_timing`."""

Cells = Mapping[str, Cell]


@dataclass(frozen=True)
class Passage:
    """The antenna's passage over one group: the time at balise 1 (ms since the start), and the places of front end and balise 1 (nm).

    accuracy_mm  of the group's place on the map
    stamped_nm   place of the front end at the time stamp, and then `time_ms` is its time; None: the reader stamps in time
    """

    group: Group
    time_ms: float
    front_nm: int
    spot_nm: int
    fault: str = ""
    accuracy_mm: int = 0
    stamped_nm: int | None = None


@dataclass(frozen=True)
class Telegram:
    """A telegram as the machine gets it, and the ghosts of its reading: none for one of another track."""

    cells: Cells
    ghosts: Cells


@dataclass(frozen=True, eq=False)
class Antenna:
    """Readings by one vehicle of the groups that it passes.

    missed   the share of groups that are not read
    foreign  the share of cycles without another telegram that bring one of another track
    counted  the share of readings with a latched counter
    faults   of `KINDS`
    map_     the error of the vehicle's map; None: each group errs by itself, up to nine tenths of its accuracy
    timing   how late it stamps its readings and how it is mounted, with the draws of that; None: in time, at its place
    """

    rng: np.random.Generator
    missed: float
    foreign: float
    counted: float
    faults: Sequence[Fault] = ()
    map_: MapError | None = None
    timing: tuple[ReaderTiming, np.random.Generator] | None = None


def antenna_timing(
    figures: Mapping[str, NDArray[np.float64]], vehicle: int, seed: VehicleSeed
) -> tuple[ReaderTiming, np.random.Generator]:
    """Return the timing of a vehicle's reader from `ANTENNA_FIGURES`, arrays [vehicle], with the draws of its latencies."""
    return timing_of(figures, vehicle, "antenna"), seed.rng("latency antenna")


# ------------------------------------------------------------------ passages


def passages(
    config: BaliseConfig, groups: Sequence[Group], national_mm: int, motion: Motion, antenna: Antenna
) -> list[Passage]:
    """Return every passage over a group, cycle by cycle, in the order of the groups within a cycle."""
    spots = _spots(config, groups, national_mm, antenna)
    if not spots:
        return []
    front = np.array([spot.front_nm for spot in spots], dtype=np.int64)
    after = motion.position_nm
    before = np.concatenate([[motion.start_nm], after[:-1]])
    found = []
    for cycle, number in _met(before, after, front):
        spot, begin, end = spots[number], int(before[cycle]), int(after[cycle])
        share = (spot.front_nm - begin) / (end - begin)
        lost = not spot.fault and antenna.rng.random() < antenna.missed
        time_ms = (int(cycle) + share) * config.period_ms
        found.append(replace(spot, time_ms=time_ms, fault="missed" if lost else spot.fault))
    return found if antenna.timing is None else _stamped(config, found, motion, *antenna.timing)


def _stamped(
    config: BaliseConfig, met: Sequence[Passage], motion: Motion, timing: ReaderTiming, rng: np.random.Generator
) -> list[Passage]:
    """Return the passages with the latency of the reader: the time and the place of its stamp; missed where it has no time to read."""
    if timing.plain:
        return list(met)
    way = Way(motion.start_nm, motion.position_nm, config.period_ms)
    drawn, found = timing.latencies(rng, len(met)), []
    for number, one in enumerate(met):
        heard = drawn.heard(number, way.speed_mm_s(one.time_ms))
        time_ms = one.time_ms + float(drawn.late_ms[number])
        fault = one.fault if heard or one.fault else "missed"
        found.append(replace(one, time_ms=time_ms, stamped_nm=round(way.at_nm(time_ms)), fault=fault))
    return found


def _met(before: NDArray[np.int64], after: NDArray[np.int64], front: NDArray[np.int64]) -> Sequence[tuple[int, int]]:
    """Return the cycles, from `before` to `after`, in which the front end passes its places, each with the number of the place."""
    if (before <= after).all():  # a run that never turns back passes each place once
        met = np.flatnonzero((front > before[0]) & (front <= after[-1]))
        return sorted(zip(np.searchsorted(after, front[met]).tolist(), met.tolist(), strict=True))
    passed = np.argwhere((before[:, None] < front) & (front <= after[:, None]))
    return [(int(cycle), int(number)) for cycle, number in passed]


def _spots(config: BaliseConfig, groups: Sequence[Group], national_mm: int, antenna: Antenna) -> list[Passage]:
    """Return the true places of balise 1 and of the front end at each reading, with up to nine tenths of the permitted errors, or
    with those of the vehicle's map.
    """
    own = OWN_SHARE if antenna.map_ is None else antenna.map_.own_share
    kinds = {fault.where: fault.kind for fault in antenna.faults}
    signs = {"early": -1, "late": 1}
    ahead = 0.0 if antenna.timing is None else antenna.timing[0].mounting_mm
    spots = []
    for group in groups:
        fault = kinds.get(group.identity, "")
        accuracy = national_mm if group.accuracy_mm is None else min(national_mm, group.accuracy_mm)
        error = antenna.rng.uniform(-own, own) * accuracy
        error += (
            0.0 if antenna.map_ is None else float(antenna.map_.at(np.array([group.place_mm], dtype=np.float64))[0])
        )
        detection = antenna.rng.uniform(-0.9, 0.9) * config.detection_mm
        shift = signs.get(fault, 0) * _displaced_mm(config, group, national_mm)
        spot = int((group.place_mm + shift + error) * NM_PER_MM)
        front = spot + int((config.antenna_mm + detection - ahead) * NM_PER_MM)
        spots.append(Passage(group, 0.0, front, spot, fault, accuracy))
    return spots


def _displaced_mm(config: BaliseConfig, group: Group, national_mm: int) -> int:
    """Return the distance of a displaced group from its place on the map."""
    return 2 * (config.tolerance_mm + max(national_mm, group.accuracy_mm or 0)) + _DISPLACED_MM


# ------------------------------------------------------------------ telegrams


class Reading:
    """The readings of one vehicle along its run.

    wander_nm  that of its odometer after each cycle
    placed     from a cycle on, the identities of the groups whose places the map knows
    """

    def __init__(
        self,
        config: BaliseConfig,
        motion: Motion,
        wander_nm: NDArray[np.int64],
        placed: Mapping[int, frozenset[int]],
        antenna: Antenna,
    ) -> None:
        self._config, self._motion, self._wander_nm, self._placed = config, motion, wander_nm, placed
        self._antenna, self._rng = antenna, antenna.rng

    def telegrams(self, met: Sequence[Passage]) -> dict[int, Telegram]:
        """Return the telegrams by their cycles: of those that wait the oldest one; without any, sometimes one of another track."""
        due: dict[int, list[Passage]] = {}
        for passage in met:
            due.setdefault(self._cycle_of(passage), []).append(passage)
        begins, cycles = sorted(due), len(self._motion.position_nm)
        found: dict[int, Telegram] = {}
        waiting: list[Passage] = []
        cycle = 0
        while cycle < cycles:
            if not waiting:
                next_one = bisect_left(begins, cycle)
                quiet_until = begins[next_one] if next_one < len(begins) else cycles
                found |= self._of_other_tracks(cycle, quiet_until)
                cycle = quiet_until
            waiting += due.get(cycle, [])
            if cycle < cycles:
                read = self._oldest(waiting, cycle)
                found |= self._of_other_tracks(cycle, cycle + 1) if read is None else {cycle: read}
            cycle += 1
        return found

    def _cycle_of(self, passage: Passage) -> int:
        """Return the cycle that begins before the passage and ends at it or after it."""
        period, time_ms = self._config.period_ms, passage.time_ms
        cycle = math.ceil(time_ms / period) - 1
        while cycle * period >= time_ms:
            cycle -= 1
        while time_ms > (cycle + 1) * period:
            cycle += 1
        return cycle

    def _oldest(self, waiting: list[Passage], cycle: int) -> Telegram | None:
        """Take the oldest passage that was read from those that wait, and return its telegram; None if none was read."""
        while waiting:
            passage = waiting.pop(0)
            if passage.fault == "missed":
                continue
            if passage.fault == "duplicate":
                waiting.append(replace(passage, fault=""))
            return self._read(passage, cycle)
        return None

    def _of_other_tracks(self, begin: int, end: int) -> dict[int, Telegram]:
        """Return the telegrams of other tracks in cycles without another telegram."""
        if not self._antenna.foreign:
            self._rng.random(end - begin)
            return {}
        return {
            cycle: self._cross_talk(cycle) for cycle in range(begin, end) if self._rng.random() < self._antenna.foreign
        }

    def _cross_talk(self, cycle: int) -> Telegram:
        """Return a complete and undamaged telegram of another track: only its identity shows that."""
        group = Group(_OTHER_TRACKS + cycle % 1_000, 0, 2, linked=bool(self._rng.random() < 0.8))
        age_ms = int(self._rng.integers(0, self._config.period_ms))
        return Telegram(telegram(group, age_ms=age_ms, place=False), {})

    def _read(self, passage: Passage, cycle: int) -> Telegram:
        """Return the telegram and its ghosts; the age is rounded up, and the latched counter's error is part of the ghost's wander."""
        if passage.stamped_nm is not None:
            return self._read_late(passage, passage.stamped_nm, cycle)
        run = int(self._motion.position_nm[cycle]) - passage.front_nm
        age = math.ceil((cycle + 1) * self._config.period_ms - passage.time_ms)
        ghosts: dict[str, Cell] = {
            "read_place_nm": passage.spot_nm, "true_since_nm": run, "reading_wander_nm": 0
        }  # fmt: skip
        placed = self._placed[max(one for one in self._placed if one <= cycle)]
        read = telegram(passage.group, age_ms=age, place=passage.group.identity in placed)
        half = self._config.odometer.wander_nm
        since = round(run / NM_PER_MM + self._rng.uniform(-0.5, 0.5) * min(half / NM_PER_MM, 20))
        wander = int(self._wander_nm[cycle]) - (run - since * NM_PER_MM)
        if self._rng.random() < self._antenna.counted and abs(wander) <= half:
            read["telegram_since_mm"] = since
            ghosts["reading_wander_nm"] = wander
        return Telegram(_with_fault(read, passage.fault), ghosts)

    def _read_late(self, passage: Passage, stamped_nm: int, cycle: int) -> Telegram:
        """Return the telegram as the reader stamps it, and ghosts that keep its laws if any do."""
        now_nm, half = int(self._motion.position_nm[cycle]), self._config.odometer.wander_nm
        age = math.ceil((cycle + 1) * self._config.period_ms - passage.time_ms)
        placed = self._placed[max(one for one in self._placed if one <= cycle)]
        read = telegram(passage.group, age_ms=age, place=passage.group.identity in placed)
        noise_mm = self._rng.uniform(-0.5, 0.5) * min(half / NM_PER_MM, 20)
        since_mm = round((now_nm - stamped_nm) / NM_PER_MM + noise_mm)
        counted = self._rng.random() < self._antenna.counted
        if counted:
            read["telegram_since_mm"] = since_mm
        late = LateGroup(
            self._config, now_nm, now_nm - (int(self._motion.position_nm[cycle - 1]) if cycle else self._motion.start_nm),
            int(self._wander_nm[cycle]), age, since_mm if counted else None,
        )  # fmt: skip
        near_nm = passage.accuracy_mm * NM_PER_MM
        place_nm = passage.group.place_mm * NM_PER_MM
        if (
            abs(passage.spot_nm - place_nm) > _DISPLACED_MM * NM_PER_MM
        ):  # far off, and wherever it is chosen near there too
            place_nm, near_nm = passage.spot_nm, _DISPLACED_MM * NM_PER_MM // 2
        ghosts = late.ghosts(now_nm - passage.front_nm, passage.spot_nm, place_nm, near_nm)
        return Telegram(_with_fault(read, passage.fault), ghosts)


_CORRUPTED_MM = 12_345
_DISTANCES = ("telegram_reflector_mm", "telegram_search_mm")


def _with_fault(read: dict[str, Cell], fault: str) -> dict[str, Cell]:
    match fault:
        case "corrupted":
            wrong = {name: _CORRUPTED_MM for name in _DISTANCES if name in read}
            return {**read, "telegram_check": "FAILED", "telegram_position_mm": _CORRUPTED_MM, **wrong}
        case "incomplete":
            return _incomplete(read)
        case "wrong way":
            return {**read, "telegram_first": read["telegram_last"], "telegram_last": read["telegram_first"]}
        case "stale":
            return {**read, "telegram_age_ms": int(read["telegram_age_ms"]) + 5_000}
        case "malformed":
            return {name: value for name, value in read.items() if name != "telegram_age_ms"}
        case "other identity":
            return {**read, "telegram_group": _OTHER_TRACKS + 1}
        case _:
            return read  # other kinds change the time, place or number of passages, not the telegram


def _incomplete(read: dict[str, Cell]) -> dict[str, Cell]:
    """Return the telegram with only balise 1 of the group read."""
    total = max(2, int(read["telegram_total"]))
    return {**read, "telegram_total": total, "telegram_read": 1, "telegram_first": 1, "telegram_last": 1}
