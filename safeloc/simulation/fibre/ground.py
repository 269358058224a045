"""Simulates vibration of the ground: axles and cars as moving sources of noise, and bending by the weight of axles.

Strain is in 1e-9. At distance d a source acts with 1 / (1 + (d / near)^2) of its noise: fully when near, falling with the square
of the distance when far. An axle's weight bends the track: down below it, up beside it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from safeloc.config import Config, quantity
from safeloc.sensing.array_types import Floats
from safeloc.simulation.fibre.trains import Train

_REFERENCE_M_S = 30.0


class GroundFigures(Config):
    """Parameters of vibration and its propagation."""

    near_mm: int = quantity(4_000, "mm", 500, 50_000, "[M] from rail to cable beside the track")
    cut: int = quantity(15, "times the near distance", 3, 100, "[D] farther, less than 1/200 of the amplitude")
    corner_hz: int = quantity(200, "Hz", 1, 10_000, "[M] rolling noise in the ground")
    bend: int = quantity(30, "1e-9 strain", 0, 10_000, "[M] below a standing axle")
    bend_mm: int = quantity(3_000, "mm", 500, 20_000, "[M] half width of the bend")
    road_near_mm: int = quantity(25_000, "mm", 1_000, 500_000, "[M] a road beside the line")
    road_corner_hz: int = quantity(20, "Hz", 1, 1_000, "[M] cars on tyres shake slowly")


@dataclass(frozen=True)
class Car:
    """A car on a road beside the line: place at second 0, constant speed, and rms strain in 1e-9 beside it."""

    start_m: float
    speed_m_s: float
    strain: float = 5.0


class Noise:
    """Noise of unit rms below a corner frequency, continuous across blocks; [frames, sources]."""

    def __init__(self, sources: int, corner_hz: float, frame_hz: float, rng: np.random.Generator) -> None:
        width = max(1, round(frame_hz / corner_hz))
        window = np.hanning(width + 2)[1:-1]
        self._weights = window / np.sqrt((window**2).sum())
        self._rng = rng
        self._tail = rng.standard_normal((width - 1, sources))

    def next(self, frames: int) -> Floats:
        """Return the noise of the next frames."""
        fresh = self._rng.standard_normal((frames, self._tail.shape[1]))
        white = np.concatenate([self._tail, fresh])
        self._tail = white[len(white) - len(self._tail) :]
        made = np.zeros((frames, white.shape[1]))
        for number, weight in enumerate(self._weights):
            made += weight * white[number : number + frames]
        return made


class Sources:
    """All moving sources of noise of one run."""

    def __init__(
        self,
        trains: Sequence[Train],
        cars: Sequence[Car],
        figures: GroundFigures,
        frame_hz: float,
        rng: np.random.Generator,
    ) -> None:
        self._trains, self._cars, self._figures = tuple(trains), tuple(cars), figures
        self._rolling = [Noise(len(one.axles_m()), figures.corner_hz, frame_hz, rng) for one in trains]
        self._uneven = [one.loudness() * rng.uniform(0.7, 1.4, len(one.axles_m())) for one in trains]
        self._road = Noise(len(self._cars), figures.road_corner_hz, frame_hz, rng)

    def strain(self, seconds: Floats, cells_m: Floats) -> Iterator[tuple[slice, Floats]]:
        """Yield pieces (cells, strain [frames, cells]) to be added up; `cells_m` must not decrease."""
        for train, rolling, uneven in zip(self._trains, self._rolling, self._uneven, strict=True):
            noise = rolling.next(len(seconds)) * uneven * self._level(train, seconds)[:, None]
            places = train.axle_places_m(seconds)
            for axle in range(places.shape[1]):
                yield from self._axle(places[:, axle], noise[:, axle], cells_m)
        road = self._road.next(len(seconds))
        for number, car in enumerate(self._cars):
            place = car.start_m + car.speed_m_s * seconds
            yield from self._spread(place, road[:, number] * car.strain, cells_m, self._figures.road_near_mm / 1_000)

    def _level(self, train: Train, seconds: Floats) -> Floats:
        moving = np.abs(train.course.speed_m_s(seconds)) / _REFERENCE_M_S
        return np.asarray(train.strain * np.maximum(moving, train.standing))

    def _axle(self, place: Floats, noise: Floats, cells_m: Floats) -> Iterator[tuple[slice, Floats]]:
        yield from self._spread(place, noise, cells_m, self._figures.near_mm / 1_000)
        width = self._figures.bend_mm / 1_000
        near = _near(place, cells_m, 4 * width)
        if near.stop > near.start:
            square = ((cells_m[near][None, :] - place[:, None]) / width) ** 2
            yield near, self._figures.bend * (1 - square) * np.exp(-square / 2)

    def _spread(self, place: Floats, noise: Floats, cells_m: Floats, near_m: float) -> Iterator[tuple[slice, Floats]]:
        near = _near(place, cells_m, self._figures.cut * near_m)
        if near.stop > near.start:
            away = (cells_m[near][None, :] - place[:, None]) / near_m
            yield near, noise[:, None] / (1 + away * away)


def _near(place: Floats, cells_m: Floats, reach_m: float) -> slice:
    first, last = np.searchsorted(cells_m, [place.min() - reach_m, place.max() + reach_m])
    return slice(int(first), int(last))
