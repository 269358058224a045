"""Tracks trains from window to window by overlap and order along the fibre, never by nearest distance.

Between two windows a train moves less than the gap between two stretches, so a stretch overlaps only the track that it continues. Trains
that join or part give new tracks with the old ones as origin; this module does not guess which train is which. A course is
fitted over a few seconds, with one speed for both ends.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import count

import numpy as np

from safeloc.language.units import MS_PER_S
from safeloc.sensing.array_types import Floats
from safeloc.sensing.fibre.figures import FibreConfig
from safeloc.sensing.fibre.shaken_stretches import Stretch

_LEAST_POINTS = 8
_HALF = 2
_TRIM = 2.5
_USUAL_SHARE = 0.8


@dataclass(frozen=True)
class Seen:
    """A stretch with its time, ms."""

    time_ms: float
    stretch: Stretch


@dataclass(frozen=True)
class Fit:
    """A straight course at the last window: places of the outermost axles in mm of fibre, speed, and quality of the fit.

    off_low_mm, off_high_mm   greatest distance of a single window's end from the course
    usual_off_mm              distance that four in five windows do not exceed, at either end
    apart_mm_s                measured difference of the speeds of both ends
    """

    low_mm: float
    high_mm: float
    speed_mm_s: float
    off_low_mm: float
    off_high_mm: float
    usual_off_mm: float
    apart_mm_s: float


@dataclass(eq=False)
class Track:
    """A train, or a candidate for one. `origin`: tracks that joined to, or parted into, this one."""

    number: int
    origin: tuple[int, ...]
    keep: int
    seen: deque[Seen] = field(default_factory=deque)
    born_ms: float = 0.0
    first_mm: float = 0.0
    confirmed: bool = False

    def add(self, time_ms: float, stretch: Stretch) -> None:
        """Continue the track with this stretch."""
        if not self.seen:
            self.born_ms, self.first_mm = time_ms, (stretch.low_mm + stretch.high_mm) / _HALF
        self.seen.append(Seen(time_ms, stretch))
        while len(self.seen) > self.keep:
            self.seen.popleft()

    @property
    def last(self) -> Stretch:
        """The newest stretch."""
        return self.seen[-1].stretch

    def fit(self) -> Fit | None:
        """Return the course over the stored windows; None if there are too few."""
        if len(self.seen) < _LEAST_POINTS:
            return None
        time = np.array([one.time_ms - self.seen[-1].time_ms for one in self.seen]) / MS_PER_S
        low, low_speed, off_low = _line(time, [one.stretch.low_mm for one in self.seen])
        high, high_speed, off_high = _line(time, [one.stretch.high_mm for one in self.seen])
        usual = max(_usual(off_low), _usual(off_high))
        speed = _one_speed(low_speed, high_speed, self.last)
        cut = self.last.cut_low or self.last.cut_high
        worst_low, worst_high = float(off_low.max()), float(off_high.max())
        return Fit(low, high, speed, worst_low, worst_high, usual, 0.0 if cut else abs(high_speed - low_speed))

    def judge(self, fit: Fit, config: FibreConfig) -> None:
        """Confirm the track as a train once it has lasted and moved steadily; revoke this if it cannot be a train."""
        detection, middle = config.detection, (fit.low_mm + fit.high_mm) / _HALF
        if _impossible(fit, config):
            self.confirmed = False
        if _impossible(fit, config) or (not self.confirmed and _unsteady(fit, config)):
            self.born_ms, self.first_mm = self.seen[-1].time_ms, middle
            return
        lasted = self.seen[-1].time_ms - self.born_ms >= detection.confirm_ms
        self.confirmed = self.confirmed or (lasted and abs(middle - self.first_mm) >= detection.moved_mm)


def _impossible(fit: Fit, config: FibreConfig) -> bool:
    """Return whether the track is faster or longer than any train."""
    too_fast = abs(fit.speed_mm_s) > config.detection.most_speed_mm_s
    return too_fast or fit.high_mm - fit.low_mm > config.detection.most_length_mm


def _unsteady(fit: Fit, config: FibreConfig) -> bool:
    """Return whether the ends jump, have different speeds or are too close: not yet a train."""
    detection = config.detection
    jumps = fit.usual_off_mm > detection.scatter_mm
    return jumps or fit.apart_mm_s > detection.apart_mm_s or fit.high_mm - fit.low_mm < detection.least_length_mm


def _line(seconds: Floats, places: Sequence[float]) -> tuple[float, float, Floats]:
    """Fit place at second 0 and speed, without outliers from a first fit; return them with the distances of all windows."""
    place = np.array(places)
    at_zero, speed = _least_squares(seconds, place)
    off = np.abs(place - at_zero - speed * seconds)
    near = off <= _TRIM * np.median(off)
    at_zero, speed = _least_squares(seconds[near], place[near])
    return at_zero, speed, np.abs(place - at_zero - speed * seconds)


def _usual(off: Floats) -> float:
    return float(np.sort(off)[int(_USUAL_SHARE * len(off))])


def _least_squares(seconds: Floats, place: Floats) -> tuple[float, float]:
    spread = seconds - seconds.mean()
    speed = float(spread @ place / (spread @ spread))
    return float(place.mean() - speed * seconds.mean()), speed


def _one_speed(low: float, high: float, stretch: Stretch) -> float:
    """Return the common speed of both ends, ignoring an end beyond the fibre."""
    if stretch.cut_low:
        return high
    return low if stretch.cut_high else (low + high) / _HALF


class Follower:
    """The tracks of a fibre; `tracks` are those with a stretch in the last window, in order along the fibre."""

    def __init__(self, config: FibreConfig) -> None:
        self._numbers = count(1)
        self._fastest_mm_s = config.detection.most_speed_mm_s
        self._hold_ms = config.detection.hold_ms
        self._channel_mm = config.interrogator.channel_mm
        self._keep = max(_LEAST_POINTS, round(config.detection.fit_ms / config.window_ms))
        self.tracks: list[Track] = []
        self._unseen: list[Track] = []

    def follow(self, time_ms: float, found: Sequence[Stretch]) -> list[Track]:
        """Continue the tracks with one window's stretches; return the tracks that ended.

        A track without a stretch may continue within a short time, at places that it can have reached meanwhile.
        """
        known = [*self.tracks, *self._unseen]
        heirs = {
            track.number: [stretch for stretch in found if self._continues(track, stretch, time_ms)] for track in known
        }
        self.tracks = [
            self._heir(stretch, [track for track in known if stretch in heirs[track.number]], heirs)
            for stretch in found
        ]
        for track, stretch in zip(self.tracks, found, strict=True):
            track.add(time_ms, stretch)
        gone = [track for track in known if track not in self.tracks]
        self._unseen = [track for track in gone if not heirs[track.number] and self._may_come_back(track, time_ms)]
        return [track for track in gone if track not in self._unseen]

    def _heir(self, stretch: Stretch, parents: list[Track], heirs: dict[int, list[Stretch]]) -> Track:
        """Return the track of a stretch: that of the only train there, if this is its only stretch; else a new one."""
        seen = [track for track in parents if track in self.tracks] or parents
        trains = [track for track in seen if track.confirmed] or seen
        if len(trains) == 1 and heirs[trains[0].number] == [stretch]:
            return trains[0]
        return Track(next(self._numbers), tuple(one.number for one in trains), self._keep)

    def _may_come_back(self, track: Track, time_ms: float) -> bool:
        return track.confirmed and time_ms - track.seen[-1].time_ms <= self._hold_ms

    def drop(self) -> list[Track]:
        """Forget all tracks and return them."""
        dropped, self.tracks, self._unseen = [*self.tracks, *self._unseen], [], []
        return dropped

    def _continues(self, track: Track, stretch: Stretch, time_ms: float) -> bool:
        """Return whether the stretch overlaps the places that the track can have reached since it was last seen."""
        before, since_ms = track.last, time_ms - track.seen[-1].time_ms
        slack = self._fastest_mm_s * since_ms / MS_PER_S + self._channel_mm
        low, high = before.first * self._channel_mm - slack, before.last * self._channel_mm + slack
        return stretch.first * self._channel_mm <= high and stretch.last * self._channel_mm >= low
