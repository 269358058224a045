"""Bogies counted in a train's own profile (FVA-3, FVA-6): what all channels that it passed have in common.

While a train passes a channel, its clusters of axles pass one by one. Each channel's course of energy, laid over the
distance behind the front end and freed of that channel's coupling, is the same picture; over many channels noise and
coupling average out. With a gauge of some metres the bogies of two coupled coaches are one cluster, and single axles
are not seen: the count of clusters is what is measured.
"""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from safeloc.signals.fibre.figures import FibreConfig

try:
    from scipy import ndimage, signal
except ModuleNotFoundError as error:
    from safeloc.errors import EngineError

    raise EngineError("fibre signals are read with scipy: pip install 'safeloc[signals]'.") from error

Numbers = NDArray[np.float64]
Single = NDArray[np.float32]
BEYOND_MM = 40_000
SMOOTH_MM = 2_000
LEAST_HEIGHT = 0.2
SLOWEST_MM_S = 3_000


@dataclass(frozen=True)
class Count:
    """Clusters of axles counted, the axles that follow from the kind of vehicle (None: not told), and whether to rely on it.

    confident   as many profiles in a row agree as are asked for
    """

    clusters: int
    axles: int | None
    confident: bool


@dataclass(frozen=True, eq=False)
class _Moment:
    """One window: the front axle's place, the length between outermost axles, and every channel's energy."""

    front_mm: float
    energy: Single


class Counter:
    """Counts one train's clusters of axles."""

    def __init__(self, config: FibreConfig) -> None:
        self._config = config
        self._moments: deque[_Moment] = deque()
        self._profile: Numbers | None = None
        self._gathered = 0
        self._next: int | None = None
        self._counts: deque[int] = deque(maxlen=config.counting.agree)

    def follow(self, front_mm: float, length_mm: float, speed_mm_s: float, energy: Single) -> None:
        """One window: where the front axle is, how long the train is between its outermost axles, how fast (signed)."""
        if abs(speed_mm_s) < SLOWEST_MM_S or (self._moments and self._turned(front_mm, speed_mm_s)):
            self._start_again()
        if abs(speed_mm_s) < SLOWEST_MM_S:
            return
        self._moments.append(_Moment(front_mm, energy))
        ahead = 1 if speed_mm_s > 0 else -1
        passed = self._channel(front_mm - ahead * (length_mm + BEYOND_MM), ahead)
        if self._next is None:
            self._next = self._channel(front_mm + ahead * BEYOND_MM, ahead) + ahead
        while (passed - self._next) * ahead >= 0:
            self._gather(self._next, length_mm, ahead)
            self._next += ahead
        self._forget(ahead)

    @property
    def count(self) -> Count | None:
        """The last count; None before there is one."""
        if not self._counts:
            return None
        clusters = self._counts[-1]
        agreed = len(self._counts) == self._counts.maxlen and len(set(self._counts)) == 1
        each = self._config.counting.axles_per_vehicle
        return Count(clusters, each * (clusters - 1) if each and clusters > 1 else None, agreed)

    def _turned(self, front_mm: float, speed_mm_s: float) -> bool:
        return (front_mm - self._moments[0].front_mm) * speed_mm_s < 0

    def _start_again(self) -> None:
        self._moments.clear()
        self._profile, self._gathered, self._next = None, 0, None

    def _channel(self, place_mm: float, ahead: int) -> int:
        """The last channel, in direction of travel, whose middle lies behind a place."""
        inter = self._config.interrogator
        number = (place_mm - inter.span_mm / 2) / inter.channel_mm
        return math.floor(number) if ahead > 0 else math.ceil(number)

    def _forget(self, ahead: int) -> None:
        """Moments before the front came near the next channel."""
        assert self._next is not None
        inter = self._config.interrogator
        place = self._next * inter.channel_mm + inter.span_mm / 2
        while len(self._moments) > 1 and (place - self._moments[1].front_mm) * ahead > BEYOND_MM:
            self._moments.popleft()

    def _gather(self, channel: int, length_mm: float, ahead: int) -> None:
        """One channel's course, laid over the distance behind the front axle."""
        inter, counting = self._config.interrogator, self._config.counting
        if not 0 <= channel < inter.channels:
            return
        behind = np.array(
            [(one.front_mm - channel * inter.channel_mm - inter.span_mm / 2) * ahead for one in self._moments]
        )
        course = np.array([one.energy[channel] for one in self._moments], dtype=np.float64)
        order = np.argsort(behind, kind="stable")
        bins = np.arange(-BEYOND_MM, length_mm + BEYOND_MM, counting.bin_mm)
        course = np.interp(bins, behind[order], course[order])
        if self._profile is None:
            self._profile = np.zeros(len(bins))
        shared = min(len(bins), len(self._profile))
        self._profile = self._profile[:shared] + course[:shared] / max(
            float(course.mean()), float(np.finfo(np.float64).tiny)
        )
        self._gathered += 1
        if self._gathered * inter.channel_mm >= counting.run_mm:
            self._counts.append(clusters(self._profile, self._config))
            self._profile, self._gathered = None, 0


def clusters(profile: Numbers, config: FibreConfig) -> int:
    """Clusters of axles in a profile over distance: tops with a dip between them, none much lower than the rest."""
    smooth = ndimage.gaussian_filter1d(profile, SMOOTH_MM / config.counting.bin_mm)
    base = float(np.percentile(smooth, 5))
    height = float(np.percentile(smooth - base, 90))
    tops, _ = signal.find_peaks(
        smooth - base, height=LEAST_HEIGHT * height, prominence=config.counting.dip_percent / 100 * height
    )
    return len(tops)
