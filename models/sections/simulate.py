"""Simulated trains through a line area as step streams of area and sections, the trains themselves included.

A journey is a list of events in time; between them trains run at given speeds, and the fibre system reports them, or
does not. Since the streams contain the trains, the interpreter checks that they obey the assumption.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from safeloc.errors import InputError
from safeloc.language.nodes import Value
from safeloc.language.units import UM_PER_MM
from safeloc.models.sections import SectionsConfig
from safeloc.runtime.streams.steps import Cell

Steps = list[dict[str, Cell]]


@dataclass(frozen=True)
class TrainRun:
    """One train: its arrival at the low end, its motion, and the reports of it.

    speeds      (from this second on, mm/s); negative: backwards
    withheld    (from, to) seconds in which no trusted report comes
    splits_at   second from which its last `left_behind_mm` stand still, and its integrity is not confirmed any more
    """

    slot: int
    enters_s: int
    length_mm: int
    speeds: tuple[tuple[int, int], ...]
    withheld: tuple[tuple[int, int], ...] = ()
    splits_s: int | None = None
    left_behind_mm: int = 0


@dataclass(frozen=True)
class FollowerRun:
    """A vehicle that comes in uncounted, at a border that reports occupancy alone: its front is at that end at `comes_s`.

    speeds  (from this second on, mm/s), inward; before the first of them it comes at that speed
    """

    comes_s: int
    length_mm: int
    speeds: tuple[tuple[int, int], ...]
    at_low: bool = True

    def run_mm(self, second: int) -> int:
        """Return the run of its front inward from the end until the second, mm; negative before it comes in."""
        since = second - self.comes_s
        if since < 0:
            return since * self.speeds[0][1]
        return sum([speed for begin, speed in self.speeds if begin <= past][-1] for past in range(since))


@dataclass(frozen=True)
class Scene:
    """An area and its events. Places in mm, times in s.

    loose     rear and front of a vehicle that stands in the area uncounted, if there is one, and the speed at which it
              runs from the start
    disturbed (from, to) seconds in which the axle counters are disturbed
    clear     seconds at which the counters report an empty area
    follower  a vehicle that comes in uncounted, instead of one that stands there from the start
    outside_mm  length of the stretch just outside each end of which detection says whether it is clear
    inner_mm  detection sections inside the area, which say in every second whether they are clear

    Where borders report occupancy alone, detection says in every second what is true: of the area, and of the stretches outside.
    """

    ends_mm: tuple[int, int]
    sections_mm: tuple[tuple[int, int], ...]
    trains: tuple[TrainRun, ...]
    seconds: int
    loose: tuple[int, int] | None = None
    loose_speed_mm_s: int = 0
    disturbed: tuple[tuple[int, int], ...] = ()
    clear: tuple[int, ...] = ()
    follower: FollowerRun | None = None
    outside_mm: int = 1_000_000
    inner_mm: tuple[tuple[int, int], ...] = ()


def first_state(scene: Scene) -> dict[str, Value]:
    """Return the open values at the start: the ends, the cuts, and the place of the uncounted vehicle."""
    rear, front = scene.loose or (scene.ends_mm[0], scene.ends_mm[0])
    first: dict[str, Value] = {
        "area.low_end_mm": scene.ends_mm[0],
        "area.high_end_mm": scene.ends_mm[1],
        "area.loose_there": scene.loose is not None,
        "area.loose_rear_um": rear * UM_PER_MM,
        "area.loose_front_um": front * UM_PER_MM,
    }
    for number, (start, end) in enumerate(scene.sections_mm, 1):
        first |= {f"section_{number}.from_mm": start, f"section_{number}.to_mm": end}
    for number, (start, end) in enumerate(scene.inner_mm, 1):
        first |= {f"area.inner_{number}_from_mm": start, f"area.inner_{number}_to_mm": end}
    return first


def simulate(config: SectionsConfig, scene: Scene, *, seed: int, accuracy_mm: int = 10_000) -> Steps:
    """Return one run as steps. Reports are off by up to `accuracy_mm`. InputError for a scene that does not fit."""
    if len(scene.sections_mm) != config.sections or any(run.slot > config.area.trains for run in scene.trains):
        raise InputError(
            f"the scene has {len(scene.sections_mm)} sections and slots up to {max((r.slot for r in scene.trains), default=0)}; the "
            f"configuration has {config.sections} and {config.area.trains}."
        )
    if len(scene.inner_mm) != config.area.inner_detection:
        raise InputError(
            f"the scene has {len(scene.inner_mm)} detection sections inside the area; the configuration has "
            f"{config.area.inner_detection} (area.inner_detection)."
        )
    if scene.follower is not None and (config.area.borders == "counted" or scene.loose is not None):
        raise InputError(
            "the scene has a follower: it comes in where borders report occupancy alone (area.borders), and is the only "
            "uncounted vehicle; give the configuration that option, and the scene no loose vehicle."
        )
    world = _World(config, scene, np.random.default_rng(seed), accuracy_mm)
    return [world.step(second) for second in range(scene.seconds)]


@dataclass(frozen=True)
class _Train:
    """A train: its plan, its true ends (um), and whether it is counted in."""

    run: TrainRun
    rear: int
    front: int
    inside: bool = False


class _World:
    def __init__(self, config: SectionsConfig, scene: Scene, rng: np.random.Generator, accuracy_mm: int) -> None:
        self._config, self._scene, self._rng, self._accuracy_mm = config, scene, rng, accuracy_mm
        outside_mm = 1 if config.area.borders == "occupancy" else 0
        low = (scene.ends_mm[0] - outside_mm) * UM_PER_MM
        self._trains = {run.slot: _Train(run, low - run.length_mm * UM_PER_MM, low) for run in scene.trains}
        loose = scene.loose or (scene.ends_mm[0], scene.ends_mm[0])
        self._loose = (loose[0] * UM_PER_MM, loose[1] * UM_PER_MM)
        self._loose_there = scene.loose is not None
        if scene.follower is not None:
            self._loose = self._follower_at(scene.follower, -1)

    def step(self, second: int) -> dict[str, Cell]:
        """Return one cycle of one second."""
        healthy = not _during(self._scene.disturbed, second)
        before = self._outside()
        trains: dict[str, Cell] = {}
        for number in range(1, self._config.area.trains + 1):
            trains |= {f"area.train_{number}_{key}": value for key, value in self._report_of(number, second).items()}
        loose = self._loose_runs(second)
        if self._config.area.borders == "occupancy":
            loose |= self._detected(healthy, before)
        else:
            clear = healthy and second in self._scene.clear and self._is_empty()
            loose |= {"area.counters_clear": clear, "area.axle_between": not self._is_empty()}
        return {"area.counters_healthy": healthy, **trains, **loose, **self._detected_inside(second)}

    def _detected_inside(self, second: int) -> dict[str, Cell]:
        """Return what detection inside the area says, and of each train the vehicle at its rear end."""
        found: dict[str, Cell] = {}
        parts = {number: _parts(train, second) for number, train in self._trains.items()}
        loose = [self._loose] if self._loose_there else []
        vehicles = [*(part for all_ in parts.values() for part in all_), *loose]
        for number, (start, end) in enumerate(self._scene.inner_mm, 1):
            inside = any(rear <= end * UM_PER_MM and front >= start * UM_PER_MM for rear, front in vehicles)
            found[f"area.inner_{number}_clear"] = not inside
        if self._scene.inner_mm:
            for number in range(1, self._config.area.trains + 1):
                rear, front = parts[number][0] if number in parts else (0, 0)
                found |= {
                    f"area.train_{number}_next_part_rear_um": rear,
                    f"area.train_{number}_next_part_front_um": front,
                }
        return found

    def _detected(self, healthy: bool, before: tuple[bool, bool]) -> dict[str, Cell]:
        """Return what train detection says: of the area, and whether either side was clear throughout the second."""
        low, high = self._ends_um()
        inside = any(front >= low and rear <= high for rear, front in self._vehicles())
        sides = [not (then or now) for then, now in zip(before, self._outside(), strict=True)]
        came_low = self._scene.follower is not None and self._scene.follower.at_low
        in_time = {f"area.train_{number}_is_reported_late": False for number in range(1, self._config.area.trains + 1)}
        return {
            **in_time,
            "area.counters_clear": healthy and not inside,
            "area.low_side_clear": sides[0],
            "area.high_side_clear": sides[1],
            "area.next_loose_comes_in_low": came_low,
        }

    def _ends_um(self) -> tuple[int, int]:
        return self._scene.ends_mm[0] * UM_PER_MM, self._scene.ends_mm[1] * UM_PER_MM

    def _vehicles(self) -> list[tuple[int, int]]:
        """Return rear and front of every vehicle, um."""
        follows = [self._loose] if self._loose_there or self._scene.follower is not None else []
        return [*((train.rear, train.front) for train in self._trains.values()), *follows]

    def _outside(self) -> tuple[bool, bool]:
        """Return whether somebody is just outside the low end, and the high end."""
        (low, high), reach = self._ends_um(), self._scene.outside_mm * UM_PER_MM
        vehicles = self._vehicles()
        return (
            any(rear < low and front >= low - reach for rear, front in vehicles),
            any(front > high and rear <= high + reach for rear, front in vehicles),
        )

    def _report_of(self, number: int, second: int) -> Mapping[str, Cell]:
        quiet: dict[str, Cell] = {
            "event": "NONE", "report_age_ms": 0, "trusted": False, "integer": False,
            "downwards": False, "next_rear_um": 0, "next_front_um": 0,
        }  # fmt: skip
        train = self._trains.get(number)
        if train is None:
            return quiet
        train = self._moved(train, second)
        event = self._event(train, second)
        told = train.inside and (event == "NONE" or self._config.area.borders == "occupancy")
        train = replace(train, inside=event.startswith("ENTERS") or (train.inside and event == "NONE"))
        self._trains[number] = train
        true: dict[str, Cell] = {"next_rear_um": train.rear, "next_front_um": train.front}
        reported = told and not _during(train.run.withheld, second)
        return {**quiet, **true, "event": event, **(self._report(train, second) if reported else {})}

    def _moved(self, train: _Train, second: int) -> _Train:
        """Return both ends after the second; a part left behind stands."""
        if second < train.run.enters_s:
            return train
        since = second - train.run.enters_s
        speed = [mm_s for begin, mm_s in train.run.speeds if begin <= since][-1]
        step = speed * UM_PER_MM
        split = train.run.splits_s is not None and second >= train.run.splits_s
        return replace(train, rear=train.rear + (0 if split else step), front=train.front + step)

    def _event(self, train: _Train, second: int) -> str:
        """Return what counters count, or what the train tells: that it left, as soon as its report must show it."""
        low, high = self._ends_um()
        sure = self._accuracy_mm * UM_PER_MM if self._config.area.borders == "occupancy" else 0
        if second == train.run.enters_s:
            return "ENTERS_LOW"
        if train.inside and train.rear > high + sure:
            return "LEAVES_HIGH"
        return "LEAVES_LOW" if train.inside and train.front < low - sure else "NONE"

    def _report(self, train: _Train, second: int) -> dict[str, Cell]:
        split = train.run.splits_s is not None and second >= train.run.splits_s
        rear = train.front - (train.run.length_mm - train.run.left_behind_mm) * UM_PER_MM if split else train.rear
        lag = [int(self._rng.uniform(0, 0.9) * self._accuracy_mm) for _ in range(2)]
        return {
            "rear_mm": rear // UM_PER_MM - lag[0],
            "front_mm": -(-train.front // UM_PER_MM) + lag[1],
            "report_age_ms": 0,
            "trusted": True,
            "integer": not split,
        }

    def _is_empty(self) -> bool:
        return not self._loose_there and not any(train.inside for train in self._trains.values())

    def _loose_runs(self, second: int) -> dict[str, Cell]:
        low, high = self._ends_um()
        if self._scene.follower is not None:
            self._loose = self._follower_at(self._scene.follower, second)
            self._loose_there = self._loose[1] >= low and self._loose[0] <= high
        else:
            step = self._scene.loose_speed_mm_s * UM_PER_MM
            self._loose = (self._loose[0] + step, self._loose[1] + step)
            self._loose_there = self._loose_there and self._loose[1] >= low and self._loose[0] <= high
        return {
            "area.next_loose_there": self._loose_there,
            "area.next_loose_rear_um": self._loose[0],
            "area.next_loose_front_um": self._loose[1],
        }

    def _follower_at(self, one: FollowerRun, second: int) -> tuple[int, int]:
        """Return rear and front of the follower, um."""
        (low, high), run, length = self._ends_um(), one.run_mm(second) * UM_PER_MM, one.length_mm * UM_PER_MM
        return (low + run - length, low + run) if one.at_low else (high - run, high - run + length)


def _parts(train: _Train, second: int) -> list[tuple[int, int]]:
    """Return rear and front of each part of the train, um, the last one first."""
    run = train.run
    if run.splits_s is None or second < run.splits_s:
        return [(train.rear, train.front)]
    lost, rest = run.left_behind_mm * UM_PER_MM, (run.length_mm - run.left_behind_mm) * UM_PER_MM
    return [(train.rear, train.rear + lost), (train.front - rest, train.front)]


def _during(spans: Sequence[tuple[int, int]], second: int) -> bool:
    return any(begin <= second < end for begin, end in spans)
