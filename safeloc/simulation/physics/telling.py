"""Devices that count their distance by themselves, and tell what they gained since the last cycle in which they told anything."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from safeloc.simulation.physics.gauss_markov import Floats
from safeloc.simulation.vehicle_seed import VehicleSeed


@dataclass(frozen=True, eq=False)
class Devices:
    """A device of each of several vehicles, with its figures as arrays [vehicle], and the seeds of the vehicles.

    name    stands before the names of its figures
    stream  the device's name in the seeds
    """

    name: str
    stream: str
    figures: Mapping[str, Floats]
    seeds: Sequence[VehicleSeed]

    def _figure(self, which: str) -> Floats:
        return self.figures[f"{self.name}_{which}"]


def gains(counted: NDArray[np.int64], present: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Return what is told in each cycle of what was counted up to the end of each, arrays [cycle, vehicle]; 0 where nothing is."""
    numbers = np.arange(1, len(counted) + 1)[:, None]
    last = np.maximum.accumulate(np.where(present, numbers, 0), axis=0)
    before = np.vstack([np.zeros((1, counted.shape[1]), dtype=np.int64), counted])
    return np.asarray(np.diff(np.take_along_axis(before, last, axis=0), axis=0, prepend=0), dtype=np.int64)
