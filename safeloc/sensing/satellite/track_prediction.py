"""Computes E*(t) from E(t-1) and the portion of the map run since, and nothing else (SAT-1; [0042], [0058], [0059])."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate, pairwise

from safeloc.errors import InputError
from safeloc.sensing.satellite.places import Vector

_FLOAT = 1e-13
"""Relative error bound of terms up to 6 / length that may cancel: fewer than a hundred last digits of a float."""


@dataclass(frozen=True)
class Portion:
    """A mapped portion: a smooth course through Earth-fixed points (m), from `start_m` on along the map.

    lengths_m  the map's length between neighbouring points; empty: their straight distances
    Between two points the course is a cubic whose direction at each point is that of the parabola through the point and
    its neighbours: exact on straight track, with an error of the fourth power of their distance in a curve.
    InputError for fewer than two points, two equal points in a row, or another number of lengths.
    """

    start_m: float
    points: tuple[Vector, ...]
    lengths_m: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        steps = [math.dist(a, b) for a, b in pairwise(self.points)]
        if not steps or not math.isfinite(self.start_m) or not all(0 < step < math.inf for step in steps):
            raise InputError("a portion of track needs two or more finite points, no two alike in a row; mend the map.")
        if self.lengths_m and not (len(self.lengths_m) == len(steps) and all(0 < m < math.inf for m in self.lengths_m)):
            raise InputError(f"{len(steps)} pieces of track need as many lengths above 0 m; mend the map.")

    @cached_property
    def distances_m(self) -> tuple[float, ...]:
        """The distances of the points along the map."""
        steps = self.lengths_m or tuple(math.dist(a, b) for a, b in pairwise(self.points))
        return tuple(accumulate(steps, initial=self.start_m))

    @property
    def end_m(self) -> float:
        """The end of the portion."""
        return self.distances_m[-1]

    def at(self, distance_m: float) -> tuple[Vector, Vector]:
        """Return the point, and its change with each metre of the map. InputError beyond the ends: nothing is extrapolated."""
        piece = self._piece(distance_m)
        return piece.at((distance_m - piece.from_m) / piece.length_m)

    def bend_per_m(self, low_m: float, high_m: float) -> float:
        """Return an upper bound of the curvature between two distances (1/m). InputError beyond the ends."""
        if not low_m <= high_m:
            raise InputError(f"from {low_m} m to {high_m} m there is no stretch; give the lower distance first.")
        first, last = self._index(low_m), self._index(high_m)
        return max(piece.bend_per_m for piece in self._pieces[first : last + 1])

    @cached_property
    def _pieces(self) -> tuple[_Piece, ...]:
        along = _directions(self.distances_m, self.points)
        ends = zip(pairwise(self.distances_m), pairwise(self.points), pairwise(along), strict=True)
        return tuple(_Piece(s0, s1 - s0, p0, p1, d0, d1) for (s0, s1), (p0, p1), (d0, d1) in ends)

    def _piece(self, distance_m: float) -> _Piece:
        return self._pieces[self._index(distance_m)]

    def _index(self, distance_m: float) -> int:
        if not self.start_m <= distance_m <= self.end_m:
            raise InputError(f"{distance_m} m is not on the mapped portion; declare no prediction.")
        return min(bisect_right(self.distances_m, distance_m), len(self.points) - 1) - 1


@dataclass(frozen=True, slots=True)
class _Piece:
    """A cubic between two points, given with the directions there."""

    from_m: float
    length_m: float
    start: Vector
    end: Vector
    start_along: Vector
    end_along: Vector

    def at(self, share: float) -> tuple[Vector, Vector]:
        """Return point and derivative by distance, at this share of the piece."""
        t, left, h = share, 1 - share, self.length_m
        a, b = (1 + 2 * t) * left * left, t * t * (3 - 2 * t)
        c, d = h * t * left * left, -h * t * t * left
        e, f, g = 6 * t * left / h, left * (1 - 3 * t), t * (3 * t - 2)
        ends = tuple(zip(self.start, self.end, self.start_along, self.end_along, strict=True))
        x, y, z = (a * p + b * q + c * u + d * v for p, q, u, v in ends)
        i, j, k = (e * (q - p) + f * u + g * v for p, q, u, v in ends)
        return (x, y, z), (i, j, k)

    @property
    def bend_per_m(self) -> float:
        """An upper bound of the curvature: the second derivative is linear, so greatest at an end; float errors are added."""
        h = self.length_m
        ends = tuple(zip(self.start, self.end, self.start_along, self.end_along, strict=True))
        first = (6 * (q - p) / h**2 - (4 * u + 2 * v) / h for p, q, u, v in ends)
        last = (6 * (p - q) / h**2 + (2 * u + 4 * v) / h for p, q, u, v in ends)
        return max(math.hypot(*first), math.hypot(*last)) * (1 + _FLOAT) + _FLOAT / h


def _directions(distances: Sequence[float], points: Sequence[Vector]) -> list[Vector]:
    """Return at every point the derivative of the parabola through it and its neighbours."""
    lengths = [b - a for a, b in pairwise(distances)]
    slopes = [_scaled(b, a, 1 / length) for (a, b), length in zip(pairwise(points), lengths, strict=True)]
    if len(slopes) == 1:
        return [slopes[0], slopes[0]]
    inner = [
        _mixed(before, after, after_m / (before_m + after_m))
        for (before, after), (before_m, after_m) in zip(pairwise(slopes), pairwise(lengths), strict=True)
    ]
    return [_mixed(slopes[0], inner[0], 2.0, -1.0), *inner, _mixed(slopes[-1], inner[-1], 2.0, -1.0)]


def _scaled(to: Vector, start: Vector, factor: float) -> Vector:
    return (to[0] - start[0]) * factor, (to[1] - start[1]) * factor, (to[2] - start[2]) * factor


def _mixed(one: Vector, other: Vector, share: float, rest: float | None = None) -> Vector:
    left = 1 - share if rest is None else rest
    x, y, z = (share * a + left * b for a, b in zip(one, other, strict=True))
    return x, y, z


@dataclass(frozen=True, slots=True)
class TrackState:
    """Distance (m), speed (m/s) and acceleration (m/s2) along the track."""

    distance_m: float
    speed_m_per_s: float
    acceleration_m_per_s2: float

    def after(self, seconds: float) -> TrackState:
        """Return the state after this time at constant acceleration. InputError unless time goes forward."""
        if not 0 < seconds < math.inf:
            raise InputError(f"{seconds} s is no time forward; drop the epoch.")
        gained = self.acceleration_m_per_s2 * seconds
        way_m = (self.speed_m_per_s + gained / 2) * seconds
        return TrackState(self.distance_m + way_m, self.speed_m_per_s + gained, self.acceleration_m_per_s2)


@dataclass(frozen=True, slots=True)
class OnTrack:
    """A state on a portion: the point, and its change with each metre (`along`) and each second (`velocity`)."""

    point_m: Vector
    along: Vector
    velocity_m_per_s: Vector


def on_portion(state: TrackState, portions: Sequence[Portion]) -> list[OnTrack]:
    """Return the state on every possible portion: one, or two beyond a switch while the way is unknown.

    InputError, and so no prediction, without a portion or if the state lies beyond one of them.
    """
    if not portions:
        raise InputError("no portion of track is known for this state; declare no prediction.")
    speed = state.speed_m_per_s
    places = [portion.at(state.distance_m) for portion in portions]
    return [OnTrack(point, a, (speed * a[0], speed * a[1], speed * a[2])) for point, a in places]
