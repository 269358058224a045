"""The run of a train from block to block, from the pattern alone (FWG-9): smooth, and not drifting from its places.

Places of a train's ends jump by metres from block to block, speeds are smooth and off by some per cent. The run is the
speed's, drawn slowly to where the train's middle is seen; a train is rigid, so it is the run of both its ends.
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.units import MS_PER_S
from safeloc.sensing.fibre.features import Bounds, TrainSeen
from safeloc.sensing.fibre.figures import FibreConfig

_DRAWN_PERCENT = 5
"""Share of the difference between run and place that one block takes away [D]: the least error over simulated trains."""


@dataclass(frozen=True)
class _Reckoned:
    """The track followed, since when, and where its middle is by speed and place together."""

    track: int
    since_ms: int
    middle_mm: float


class RunMeter:
    """Blocks of one train in order; a track with another number begins anew."""

    def __init__(self, config: FibreConfig) -> None:
        self._settling_ms = 2 * config.detection.fit_ms
        self._block_ms = config.window_ms * config.band.windows_per_block
        self._last: _Reckoned | None = None

    def follow(self, train: TrainSeen | None, time_ms: int) -> int | None:
        """Run since the block before, mm; None while an end is not seen, and until the course is fitted and settled."""
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
