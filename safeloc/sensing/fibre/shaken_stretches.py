"""Finds stretches of shaken fibre in one window, and estimates the places of a train's outermost axles in them.

An axle shakes the fibre around it; the energy falls with the fourth power of distance. The louder the train, the farther from
the axle is the last channel above the threshold: with r the ratio of level to threshold, an axle
at a distance d of near * sqrt(sqrt(r) - 1) just reaches the threshold.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from safeloc.sensing.array_types import Flags, Singles
from safeloc.sensing.fibre.figures import FibreConfig

_LEAST_CHANNELS = 3
_NEIGHBOURHOOD_MM = 120_000
_LEVEL_SHARE = 0.15


@dataclass(frozen=True)
class Stretch:
    """Shaken fibre from channel `first` to `last`, and the estimated places of the outermost axles, in mm of fibre.

    cut_low, cut_high   the stretch touches that end of the fibre, so the train may extend beyond it
    """

    first: int
    last: int
    low_mm: float
    high_mm: float
    cut_low: bool
    cut_high: bool


def stretches(ratio: Singles, shaken: Flags, config: FibreConfig) -> list[Stretch]:
    """Return the stretches of one window in order along the fibre.

    ratio   energy over quiet level, [channels]; `shaken`: where it exceeds the threshold
    """
    channels = np.flatnonzero(shaken)
    if len(channels) < _LEAST_CHANNELS:
        return []
    gap = config.detection.gap_mm // config.interrogator.channel_mm + 1
    parts = np.split(channels, np.flatnonzero(np.diff(channels) > gap) + 1)
    return [_run(ratio, part, config) for part in parts if _is_solid(part)]


def _is_solid(channels: NDArray[np.intp]) -> bool:
    """Return whether the channels can be a train's: noise at one place shakes only the two channels that share it."""
    return len(channels) >= _LEAST_CHANNELS and bool((np.diff(channels) == 1).any())


def _run(ratio: Singles, channels: NDArray[np.intp], config: FibreConfig) -> Stretch:
    first, last = int(channels[0]), int(channels[-1])
    inter = config.interrogator
    near = max(1, _NEIGHBOURHOOD_MM // inter.channel_mm)
    span = last - first + 1
    half = (span - 1) * inter.channel_mm / 2
    low = min(half, _edge(ratio[first : first + min(near, span)], config))
    high = min(half, _edge(ratio[last - min(near, span) + 1 : last + 1][::-1], config))
    middle = inter.span_mm / 2
    return Stretch(
        first,
        last,
        first * inter.channel_mm + middle + low,
        last * inter.channel_mm + middle - high,
        first == 0,
        last == inter.channels - 1,
    )


def _edge(ratio: Singles, config: FibreConfig) -> float:
    """Return the distance of the axle inward from the last channel's middle, in mm; `ratio` begins at that end."""
    detection, inter = config.detection, config.interrogator
    threshold = 10 ** (detection.threshold_cdb / 1_000)
    level = max(float(np.sort(ratio)[int(_LEVEL_SHARE * len(ratio))]), threshold)
    away = detection.near_mm * np.sqrt(np.sqrt(level / threshold) - 1)
    return float(away) + inter.span_mm / 2 - inter.channel_mm / 2
