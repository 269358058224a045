"""The angle between a receiver's course over ground and the track, from two of its own fixes that lie far enough apart.

Errors of fixes a few seconds apart are nearly equal, so the course between them is far more accurate than either place.
It reveals a false fix better than the distance off the track: a train runs along its track, false fixes mostly move across it.
"""

from __future__ import annotations

import math
from collections import deque

from safeloc.models.guard.variables import GuardConfig
from safeloc.railway.guard.tracks import Tracks

_LONGEST = 3
"""Fixes farther apart than this many times `course_base_mm` give no course: over such distances tracks bend both ways."""


class Courses:
    """The fixes of the last seconds in the plane of the map, passed on or not."""

    def __init__(self, config: GuardConfig, tracks: Tracks) -> None:
        self._config, self._tracks = config, tracks
        self._fixes: deque[tuple[int, float, float]] = deque()

    def forget(self) -> None:
        """Forget all fixes."""
        self._fixes.clear()

    def angle_mrad(self, time_ms: int, x: float, y: float) -> int | None:
        """Return the angle between the course to this fix and the way's direction, 0 to half a turn, and keep the fix.

        None without a course: no fix of the last `course_age_ms` lies `course_base_mm` or more from this one, the latest of
        those that do lies too far away, or the way passes here in both directions. InputError for coordinates outside the
        coordinate system.
        """
        here = self._tracks.plane(x, y)
        while self._fixes and time_ms - self._fixes[0][0] > self._config.course_age_ms:
            self._fixes.popleft()
        begin = self._begin(*here)
        self._fixes.append((time_ms, *here))
        return None if begin is None else self._angle(begin, here)

    def _begin(self, x: float, y: float) -> tuple[float, float] | None:
        base = self._config.course_base_mm / 1_000
        for _, east, north in reversed(self._fixes):
            far = math.hypot(x - east, y - north)
            if far >= base:
                return (east, north) if far <= _LONGEST * base else None
        return None

    def _angle(self, begin: tuple[float, float], end: tuple[float, float]) -> int | None:
        """Compare with the track halfway between both fixes, where the chord of a curve is parallel to it."""
        (ax, ay), (bx, by) = begin, end
        heading = self._tracks.heading(((ax + bx) / 2, (ay + by) / 2))
        if heading is None:
            return None
        return round(abs(math.remainder(math.atan2(by - ay, bx - ax) - heading, math.tau)) * 1_000)
