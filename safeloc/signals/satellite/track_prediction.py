"""E*(t) from E(t-1) and the portion of the map run in between, and nothing else (SAT-1; [0042], [0058], [0059])."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from safeloc.errors import InputError
from safeloc.signals.satellite.places import Vector


@dataclass(frozen=True, slots=True)
class Portion:
    """A mapped portion: Earth-fixed points (m) joined by straight lines, and the distance (m) at the first point.

    InputError for fewer than two points, or two equal ones in a row.
    """

    start_m: float
    points: tuple[Vector, ...]

    def __post_init__(self) -> None:
        steps = [math.dist(a, b) for a, b in zip(self.points, self.points[1:], strict=False)]
        if not steps or not all(0 < step < math.inf for step in steps):
            raise InputError("a portion of track needs two or more finite points, no two alike in a row; mend the map.")

    def at(self, distance_m: float) -> tuple[Vector, Vector]:
        """Point and unit vector along the track. InputError beyond the ends: nothing is extrapolated."""
        left = distance_m - self.start_m
        for a, b in zip(self.points, self.points[1:], strict=False):
            length = math.dist(a, b)
            if 0 <= left <= length:
                along = ((b[0] - a[0]) / length, (b[1] - a[1]) / length, (b[2] - a[2]) / length)
                return (a[0] + left * along[0], a[1] + left * along[1], a[2] + left * along[2]), along
            left -= length
        raise InputError(f"{distance_m} m is not on the mapped portion; declare no prediction.")


@dataclass(frozen=True, slots=True)
class TrackState:
    """Distance (m), speed (m/s) and acceleration (m/s2) along the track."""

    distance_m: float
    speed_m_per_s: float
    acceleration_m_per_s2: float

    def after(self, seconds: float) -> TrackState:
        """The same at constant acceleration. InputError unless time goes forward."""
        if not 0 < seconds < math.inf:
            raise InputError(f"{seconds} s is no time forward; drop the epoch.")
        gained = self.acceleration_m_per_s2 * seconds
        way_m = (self.speed_m_per_s + gained / 2) * seconds
        return TrackState(self.distance_m + way_m, self.speed_m_per_s + gained, self.acceleration_m_per_s2)


def on_portion(state: TrackState, portions: Sequence[Portion]) -> list[tuple[Vector, Vector]]:
    """Point and velocity on every portion still possible: one, or two past an undecided switch, to predict on each.

    InputError when no portion is given or the state is off one of them: no prediction then.
    """
    if not portions:
        raise InputError("no portion of track is known for this state; declare no prediction.")
    places = [portion.at(state.distance_m) for portion in portions]
    speed = state.speed_m_per_s
    return [(point, (speed * along[0], speed * along[1], speed * along[2])) for point, along in places]
