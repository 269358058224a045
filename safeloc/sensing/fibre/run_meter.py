"""Measures the run of a train from block to block by its pattern alone (FWG-9), smoothly and without drift.

Measured ends of a train jump by metres from block to block; speeds are smooth, with an error of some per cent. The run follows
the speed and is slowly corrected towards the measured middle of the train. A train is rigid, so both ends have this run.
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.units import MS_PER_S
from safeloc.sensing.fibre.features import Bounds, TrainSeen
from safeloc.sensing.fibre.figures import FibreConfig

_DRAWN_PERCENT = 5
"""Per cent of the difference between run and place that one block corrects [D]: the least error over simulated trains."""


@dataclass(frozen=True)
class _Reckoned:
    """The tracked train, the time since when it is tracked, and its middle by speed and place together."""

    track: int
    since_ms: int
    middle_mm: float


class RunMeter:
    """Measures the run of one train, block by block; another track number starts a new measurement."""

    def __init__(self, config: FibreConfig) -> None:
        self._settling_ms = 2 * config.detection.fit_ms
        self._block_ms = config.window_ms * config.band.windows_per_block
        self._last: _Reckoned | None = None

    def follow(self, train: TrainSeen | None, time_ms: int) -> int | None:
        """Return the run since the previous block, mm; None while an end is not visible, and until the course has settled."""
        if train is None or train.low is None or train.high is None:
            self._last = None
            return None
        middle = (_middle(train.low.path_mm) + _middle(train.high.path_mm)) / 2
        last = self._last
        if last is None or last.track != train.track:
            self._last = _Reckoned(train.track, time_ms, middle)
            return None
        reckoned = last.middle_mm + _middle(train.speed_mm_s) * self._block_ms / MS_PER_S
        reckoned += (middle - reckoned) * _DRAWN_PERCENT / 100
        settled = time_ms - last.since_ms >= self._settling_ms
        self._last = _Reckoned(train.track, last.since_ms, reckoned)
        return round(reckoned) - round(last.middle_mm) if settled else None


def _middle(bounds: Bounds) -> float:
    return (bounds.low + bounds.high) / 2
