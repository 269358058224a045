"""Finds known reflecting points in the returned light, and an end of the fibre without absorber (FWG-5).

Points and patterns are measured with the same clock and the same light: if a train's pattern arrives at the time of a point's
reflection, the train is at the point, whatever the index of refraction.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from safeloc.errors import EngineError
from safeloc.sensing.array_types import Singles
from safeloc.sensing.fibre.figures import FibreConfig

try:
    from scipy import ndimage
except ModuleNotFoundError as error:
    raise EngineError("fibre signals are read with scipy: pip install 'safeloc[signals]'.") from error

_END_CHANNELS = 3
_DARK = 1 / 1_000


@dataclass(frozen=True)
class Reflections:
    """Findings from reflected light.

    seen      reflecting point -> its measured place, mm of fibre (middle of the lit piece)
    missing   points that were not found, or not clearly
    end_reflects   the end reflects light: it has no absorber
    dark_percent   share of channels in dark stretches of three and more, in percent
    faded          channels with an end too dark for a meaningful phase, [channels]
    """

    seen: dict[str, float]
    missing: tuple[str, ...]
    end_reflects: bool
    dark_percent: float
    faded: NDArray[np.bool_]


def reflections(intensity: Singles, config: FibreConfig) -> Reflections:
    """Evaluate the intensity of one block, [light channels]."""
    inter, rules = config.interrogator, config.reflections
    size = 2 * max(1, rules.window_mm // (2 * inter.channel_mm)) + 1
    around = ndimage.median_filter(intensity, size=min(size, len(intensity)))
    strong = intensity > 10 ** (rules.over_cdb / 1_000) * around
    tops = np.flatnonzero(strong & (intensity == ndimage.maximum_filter1d(intensity, 3)))
    places: NDArray[np.float64] = tops * np.float64(inter.channel_mm) + np.float64(inter.pulse_mm / 2)
    found = {one.id: _only(places, one.fibre_mm, config) for one in config.point_places}
    seen = {name: place for name, place in found.items() if place is not None}
    dark = float((ndimage.maximum_filter1d(intensity, 3) <= _DARK * np.median(intensity)).mean())
    missing = tuple(name for name, place in found.items() if place is None)
    return Reflections(
        seen, missing, _end_reflects(tops, places, seen, len(intensity)), 100 * dark, _faded(intensity, around, config)
    )


def _faded(intensity: Singles, around: Singles, config: FibreConfig) -> NDArray[np.bool_]:
    """Return the channels whose backscatter cancels out at one end of the gauge."""
    near = intensity < around * 10 ** (-config.detection.fade_cdb / 1_000)
    channels, gauge = config.interrogator.channels, config.interrogator.gauge_channels
    faded: NDArray[np.bool_] = near[:channels] | near[gauge : gauge + channels]
    return faded


def _only(places: NDArray[np.float64], expected_mm: int, config: FibreConfig) -> float | None:
    """Return the only peak near the expected place; None if there is none or more than one."""
    near = places[np.abs(places - expected_mm) <= config.reflections.search_mm]
    return float(near[0]) if len(near) == 1 else None


def _end_reflects(tops: NDArray[np.intp], places: NDArray[np.float64], seen: dict[str, float], channels: int) -> bool:
    last = tops >= channels - _END_CHANNELS
    return any(place not in seen.values() for place in places[last])


def coincident(found: Reflections, low_mm: float, high_mm: float) -> tuple[str, ...]:
    """Return the reflecting points measured between two places in the same light, in their order."""
    inside = [(place, name) for name, place in found.seen.items() if low_mm <= place <= high_mm]
    return tuple(name for _, name in sorted(inside))
