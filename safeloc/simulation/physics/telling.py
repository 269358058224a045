"""A device that counts its distance by itself, and tells what it gained since the last cycle in which it told anything."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def gains(counted: NDArray[np.int64], present: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Return what is told in each cycle of what was counted up to the end of each, arrays [cycle, vehicle]; 0 where nothing is."""
    numbers = np.arange(1, len(counted) + 1)[:, None]
    last = np.maximum.accumulate(np.where(present, numbers, 0), axis=0)
    before = np.vstack([np.zeros((1, counted.shape[1]), dtype=np.int64), counted])
    return np.asarray(np.diff(np.take_along_axis(before, last, axis=0), axis=0, prepend=0), dtype=np.int64)
