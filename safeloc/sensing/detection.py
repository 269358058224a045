"""Detects the peaks of a radar image that stand out from noise and clutter.

The background of a cell is the median of its neighbours in range (ordered-statistic CFAR), on the nearer or the farther side,
whichever is greater. Up to half of these neighbours may be other echoes, so corners of one reflector do not hide each other;
at an edge of the clutter the louder side counts. Noise power in a cell is exponential: its median is ln 2 of its mean, and it
exceeds t times its mean with probability e^-t.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from safeloc.errors import EngineError
from safeloc.sensing.figures import RadarConfig
from safeloc.sensing.images import Power

try:
    from scipy import ndimage
except ModuleNotFoundError as error:
    raise EngineError("radar images are read with scipy: pip install 'safeloc[signals]'.") from error

Cells = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Peaks:
    """Cells with a peak, and the mean power of noise and clutter around each. Shapes [peaks]."""

    row: Cells
    column: Cells
    background: Power

    def __len__(self) -> int:
        return len(self.row)

    def only(self, kept: NDArray[np.intp]) -> Peaks:
        """Return only these peaks, in this order."""
        return Peaks(self.row[kept], self.column[kept], self.background[kept])


def background(power: Power, window_cells: int) -> Power:
    """Return the mean power of noise and clutter around every cell; never below that of the whole image."""
    columns = [ndimage.median_filter(np.ascontiguousarray(column), size=window_cells) for column in power.T]
    medians: Power = np.stack(columns, axis=1)
    away = window_cells // 2 + 1
    around = np.pad(medians, ((away, away), (0, 0)), mode="edge")
    greater = np.maximum(around[: len(power)], around[2 * away :])
    return np.maximum(greater, np.median(power)) / math.log(2)


def peaks(power: Power, config: RadarConfig) -> Peaks:
    """Return local maxima above the threshold and beyond the blind range, without cells at the edges of the image."""
    around = background(power, config.detection.window_cells)
    stands_out = power > around * 10 ** (config.detection.threshold_cdb / 1_000)
    found = stands_out & (power == ndimage.maximum_filter(power, size=3))
    found[: math.ceil(config.sensor.blind_mm / config.sensor.cell_mm) + 1] = False
    found[-1] = False
    found[:, [0, -1]] = False
    row, column = np.nonzero(found)
    return Peaks(row.astype(np.int64), column.astype(np.int64), around[row, column])
