"""Simulated trains as axle loads that move along the track: vehicles, bogies, wheel bases, and a course over time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from safeloc.errors import InputError
from safeloc.sensing.array_types import Floats


@dataclass(frozen=True)
class Vehicle:
    """One vehicle. Lengths in m: over buffers, between the middles of its bogies, wheel base of a bogie.

    bogie_m   0: no bogies, but two axles `wheelbase_m` apart
    loudness  amplitude relative to a coach
    """

    length_m: float
    bogie_m: float
    wheelbase_m: float
    loudness: float = 1.0

    def axles_m(self) -> list[float]:
        """Return the places of the axles behind the vehicle's end."""
        middle, half = self.length_m / 2, self.wheelbase_m / 2
        bogies = [middle] if self.bogie_m == 0 else [middle - self.bogie_m / 2, middle + self.bogie_m / 2]
        return [bogie + side * half for bogie in bogies for side in (-1, 1)]


COACH = Vehicle(26.4, 19.0, 2.5)  # UIC-X coach [M, sure]
LOCOMOTIVE = Vehicle(18.9, 10.4, 2.6, loudness=2.0)  # Traxx [M, fairly sure]
ORE_WAGON = Vehicle(19.04, 14.0, 1.8)  # Facs 124: length [S], bogies [M]
TWO_AXLE_WAGON = Vehicle(14.0, 0.0, 8.0)  # [M]


@dataclass(frozen=True)
class Course:
    """A train's course: place of end A at second 0, in m along the track, and speed in m/s as (second, speed) points,
    linear between.

    Before the first point and after the last the speed is constant. Negative: towards smaller places.
    """

    start_m: float
    speeds: tuple[tuple[float, float], ...]

    def __post_init__(self) -> None:
        seconds = [second for second, _ in self.speeds]
        if not seconds or any(late <= early for early, late in pairwise(seconds)):
            raise InputError("a course needs at least one (second, speed), in ascending order of seconds.")

    def speed_m_s(self, seconds: Floats) -> Floats:
        """Return the speed at these times."""
        points = np.array(self.speeds, dtype=np.float64)
        return np.interp(seconds, points[:, 0], points[:, 1])

    def place_m(self, seconds: Floats) -> Floats:
        """Return the place of end A: the exact integral of the speed from 0 to these times >= 0."""
        knots = np.array([0.0, *(second for second, _ in self.speeds if second > 0)])
        speeds = self.speed_m_s(knots)
        run = np.concatenate([[0.0], np.cumsum(np.diff(knots) * (speeds[1:] + speeds[:-1]) / 2)])
        last = np.clip(np.searchsorted(knots, seconds, side="right") - 1, 0, len(knots) - 1)
        since = seconds - knots[last]
        return np.asarray(self.start_m + run[last] + since * (speeds[last] + self.speed_m_s(seconds)) / 2)


@dataclass(frozen=True)
class Train:
    """Vehicles from end A on, and their course.

    ahead     end A points towards greater places; else towards smaller ones
    strain    rms strain at an axle at 30 m/s, in 1e-9; it grows with speed
    standing  share of it that remains at standstill (engines)
    """

    vehicles: tuple[Vehicle, ...]
    course: Course
    ahead: bool = True
    strain: float = 2.5
    standing: float = 0.0

    @property
    def length_m(self) -> float:
        """The length over buffers."""
        return sum(vehicle.length_m for vehicle in self.vehicles)

    def axles_m(self) -> Floats:
        """Return the places of all axles behind end A."""
        ends = np.concatenate([[0.0], np.cumsum([vehicle.length_m for vehicle in self.vehicles])])
        return np.array([end + axle for end, one in zip(ends, self.vehicles, strict=False) for axle in one.axles_m()])

    def loudness(self) -> Floats:
        """Return the loudness of each axle."""
        return np.array([one.loudness for one in self.vehicles for _ in one.axles_m()])

    def axle_places_m(self, seconds: Floats) -> Floats:
        """Return the places of the axles along the track, [time, axle]."""
        sign = 1.0 if self.ahead else -1.0
        return self.course.place_m(seconds)[:, None] - sign * self.axles_m()[None, :]

    def ends_m(self, second: float) -> tuple[float, float]:
        """Return the places of both ends on the track, the smaller first."""
        end_a = float(self.course.place_m(np.array([second]))[0])
        return (end_a - self.length_m, end_a) if self.ahead else (end_a, end_a + self.length_m)


def coaches(count: int, course: Course, *, ahead: bool = True, strain: float = 2.5) -> Train:
    """Return a train of a locomotive and `count` coaches."""
    return Train((LOCOMOTIVE, *[COACH] * count), course, ahead, strain)


def steady(vehicles: Sequence[Vehicle], start_m: float, speed_m_s: float) -> Train:
    """Return a train at constant speed with end A in front."""
    return Train(tuple(vehicles), Course(start_m, ((0.0, speed_m_s),)), speed_m_s >= 0)
