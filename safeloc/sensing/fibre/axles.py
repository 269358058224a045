"""Counts the bogies of a train in its energy profile (FVA-3, FVA-6), which is common to all channels that it passed.

While a train passes a channel, its clusters of axles pass one by one. The energy of a channel, plotted over the distance from
the middle of the train and normalised by the channel's coupling, is the same for all channels; over many of them noise and
coupling average out. With a gauge of some metres the bogies of two coupled coaches are one cluster, and single axles are not
visible. So the count is one of clusters.

A count describes the train as it passed the first channels of the profile, with vehicles that it may have lost since. So a
count is withheld if the train may have run more than `count_valid_run_mm` since its profile began, however long it stood.
"""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass

import numpy as np

from safeloc.sensing.array_types import Floats, Singles
from safeloc.sensing.fibre.figures import FibreConfig

try:
    from scipy import ndimage, signal
except ModuleNotFoundError as error:
    from safeloc.errors import EngineError

    raise EngineError("fibre signals are read with scipy: pip install 'safeloc[signals]'.") from error

_BEYOND_MM = 40_000
_SMOOTH_MM = 2_000
_LEAST_HEIGHT = 0.2
_FAINTEST = 0.03
_SLOWEST_MM_S = 3_000
_TURNED_MM = 30_000
_DEGREE = 2
_TINY = float(np.finfo(np.float64).tiny)


@dataclass(frozen=True)
class Count:
    """The counted clusters of axles, the axles that follow for the configured kind of vehicle (None: none configured).

    confident   the required number of consecutive profiles agree
    """

    clusters: int
    axles: int | None
    confident: bool


@dataclass(frozen=True)
class _Profiled:
    """Clusters in a complete profile, and the run (mm) at which the train's last axle had passed its first channel."""

    clusters: int
    began_mm: float


@dataclass(frozen=True, eq=False)
class _Moment:
    """One window: time, run so far, measured place of the train's middle, and energy of every channel."""

    time_ms: float
    run_mm: float
    middle_mm: float
    energy: Singles


class Counter:
    """Counts one train's clusters of axles."""

    def __init__(self, config: FibreConfig) -> None:
        self._config = config
        self._moments: deque[_Moment] = deque()
        self._profile: Floats | None = None
        self._gathered = 0
        self._next: int | None = None
        self._counts: deque[_Profiled] = deque(maxlen=config.counting.agree)
        self._run_mm, self._began_mm, self._time_ms = 0.0, 0.0, math.nan

    def follow(self, time_ms: float, middle_mm: float, length_mm: float, speed_mm_s: float, energy: Singles) -> None:
        """Process one window with the measured place of the middle, length between outermost axles and signed speed."""
        self.runs(time_ms, speed_mm_s)
        if abs(speed_mm_s) < _SLOWEST_MM_S or (self._moments and self._turned(middle_mm, speed_mm_s)):
            self._start_again()
        if abs(speed_mm_s) < _SLOWEST_MM_S:
            return
        self._moments.append(_Moment(time_ms, self._run_mm, middle_mm, energy))
        ahead = 1 if speed_mm_s > 0 else -1
        reach = ahead * (length_mm / 2 + _BEYOND_MM)
        passed = self._channel(middle_mm - reach, ahead)
        if self._next is None:
            self._next = self._channel(middle_mm + reach, ahead) + ahead
        while (passed - self._next) * ahead >= 0:
            self._gather(self._next, length_mm, ahead)
            self._next += ahead
        self._forget(ahead, length_mm)

    @property
    def count(self) -> Count | None:
        """The last count; None before the first, and if the train may have run too far since its profile began."""
        if not self._counts or self._run_mm - self._counts[-1].began_mm > self._config.counting.count_valid_run_mm:
            return None
        clusters = self._counts[-1].clusters
        agreed = len(self._counts) == self._counts.maxlen and len({one.clusters for one in self._counts}) == 1
        each = self._config.counting.axles_per_vehicle
        return Count(clusters, each * (clusters - 1) if each and clusters > 1 else None, agreed)

    def runs(self, time_ms: float, speed_mm_s: float) -> None:
        """Add the greatest run up to this window, including the error of the speed, without counting in it."""
        if not math.isnan(self._time_ms):
            most = abs(speed_mm_s) + self._config.detection.speed_error_mm_s
            self._run_mm += most * (time_ms - self._time_ms) / 1_000
        self._time_ms = time_ms

    def _turned(self, middle_mm: float, speed_mm_s: float) -> bool:
        return (middle_mm - self._moments[0].middle_mm) * speed_mm_s < -_TURNED_MM * abs(speed_mm_s)

    def _start_again(self) -> None:
        self._moments.clear()
        self._profile, self._gathered, self._next = None, 0, None

    def _channel(self, place_mm: float, ahead: int) -> int:
        """Return the last channel, in direction of travel, whose middle lies behind a place."""
        inter = self._config.interrogator
        number = (place_mm - inter.span_mm / 2) / inter.channel_mm
        return math.floor(number) if ahead > 0 else math.ceil(number)

    def _forget(self, ahead: int, length_mm: float) -> None:
        """Drop moments from before the train came near the next channel, with a reserve for the fit."""
        assert self._next is not None
        inter = self._config.interrogator
        place = self._next * inter.channel_mm + inter.span_mm / 2
        reach = length_mm / 2 + 2 * _BEYOND_MM
        while len(self._moments) > 1 and (place - self._moments[1].middle_mm) * ahead > reach:
            self._moments.popleft()

    def _middles(self) -> Floats:
        """Return the middle at every stored moment, smoothed over the errors of single windows."""
        time = np.array([one.time_ms - self._moments[-1].time_ms for one in self._moments]) / 1_000
        middle = np.array([one.middle_mm for one in self._moments])
        if len(time) <= _DEGREE:
            return middle
        return np.asarray(np.polyval(np.polyfit(time, middle, _DEGREE), time), dtype=np.float64)

    def _gather(self, channel: int, length_mm: float, ahead: int) -> None:
        """Add one channel's energy over the distance from the train's middle, whose run is smoothed over all stored moments."""
        inter, counting = self._config.interrogator, self._config.counting
        if not 0 <= channel < inter.channels:
            return
        behind = (self._middles() - channel * inter.channel_mm - inter.span_mm / 2) * ahead
        course = np.array([one.energy[channel] for one in self._moments], dtype=np.float64)
        if np.any(np.diff(behind) <= 0):
            return
        bins_ahead = int((length_mm / 2 + _BEYOND_MM) // counting.bin_mm)
        course = np.interp(np.arange(-bins_ahead, bins_ahead + 1) * counting.bin_mm, behind, course)
        if self._profile is None:
            self._profile = np.zeros_like(course)
            self._began_mm = self._moments[max(0, int((behind <= length_mm / 2).sum()) - 1)].run_mm
        shared = min(len(course), len(self._profile))
        course = course / max(float(course.mean()), _TINY)
        self._profile = _middle_of(self._profile, shared) + _middle_of(course, shared)
        self._gathered += 1
        if self._gathered * inter.channel_mm >= counting.run_mm:
            self._counts.append(_Profiled(clusters(self._profile, self._config), self._began_mm))
            self._profile, self._gathered = None, 0


def _middle_of(profile: Floats, length: int) -> Floats:
    """Return as many bins about the middle; profile and length are odd, and the middle bin is the train's middle."""
    beyond = (len(profile) - length) // 2
    return profile[beyond : beyond + length]


def clusters(profile: Floats, config: FibreConfig) -> int:
    """Count the clusters of axles in a profile: peaks with a dip beside them in proportion to their own height.

    Because a locomotive is louder than its coaches, a peak's own dip counts; a ripple far below most peaks does not.
    """
    smooth = ndimage.gaussian_filter1d(profile, _SMOOTH_MM / config.counting.bin_mm)
    above = smooth - np.percentile(smooth, 5)
    _, found = signal.find_peaks(above, height=_FAINTEST * above.max(), prominence=0)
    heights, dips = found.get("peak_heights", np.empty(0)), found["prominences"]
    clear = heights[dips >= config.counting.dip_percent / 100 * heights]
    return int((clear >= _LEAST_HEIGHT * np.median(clear)).sum()) if len(clear) else 0
