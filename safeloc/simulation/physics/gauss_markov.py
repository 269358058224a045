"""A first-order Gauss-Markov process: an error that changes slowly, in time or along the line.

    x[0] = n[0]        x[k + 1] = keep * x[k] + sqrt(1 - keep ** 2) * n[k + 1]        keep = exp(-step / length)

With standard normal n its deviation is 1 throughout, and two values that lie a distance apart have the correlation exp(-distance / length).
"""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def kept(step: float, lengths: Iterable[float]) -> Floats:
    """Return which share of the process is kept over a step, for each correlation length in the same unit; 0 for a length of 0."""
    return np.array([math.exp(-step / one) if one > 0 else 0.0 for one in lengths], dtype=np.float64)


def gauss_markov(noise: Floats, keep: Floats) -> Floats:
    """Return processes driven by standard normal noise, array [step, ...]; `keep` as from `kept`, which spreads to [...]."""
    found = np.empty_like(noise)
    fresh, now = np.sqrt(1.0 - keep * keep), noise[0]
    for step, one in enumerate(noise):
        now = keep * now + fresh * one if step else one
        found[step] = now
    return found


def smoothed(process: Floats, begin: Floats, keep: Floats, hold: Floats) -> Floats:
    """Return the process as a first-order low pass lets it through, with deviation 1 again: then it changes steadily.

    begin  standard normal values, one for each process, that complete its first value
    keep   of the process, as from `kept`; hold: share of the smoothed value that is held over a step
    """
    share = (1.0 - hold) / (1.0 - hold * keep)
    variance = (1.0 - hold) / (1.0 + hold) * (1.0 + hold * keep) / (1.0 - hold * keep)
    found, now = np.empty_like(process), process[0]
    for step, one in enumerate(process):
        if step:
            now = hold * now + (1.0 - hold) * one
        else:
            now = share * one + np.sqrt(np.maximum(variance - share * share, 0.0)) * begin
        found[step] = now
    return np.asarray(found / np.sqrt(variance), dtype=np.float64)
