"""Random numbers of many vehicles, each from its own generator in its own order, taken for some of the vehicles at a time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Which = NDArray[np.int64]
"""Numbers of vehicles."""
_BLOCK = 1_024


class Draws(Protocol):
    """The next random numbers of vehicles."""

    def shares(self, which: Which) -> NDArray[np.float64]:
        """Take the next share, 0 to below 1, of each of these vehicles."""
        ...


def between(draws: Draws, which: Which, low: float, high: float) -> NDArray[np.float64]:
    """Take the next number from `low` to `high` of each of these vehicles, as `Generator.uniform` makes it of a share."""
    return low + (high - low) * draws.shares(which)


class OfOne:
    """Numbers of one vehicle, whose generator others use as well."""

    def __init__(self, rng: np.random.Generator) -> None:
        self._rng = rng

    def shares(self, which: Which) -> NDArray[np.float64]:
        """Take the next one, if the vehicle is meant."""
        return self._rng.random(len(which))


class OfMany:
    """Numbers of vehicles whose generators nobody else uses; drawn in blocks, in the order of single draws."""

    def __init__(self, rngs: Sequence[np.random.Generator]) -> None:
        self._rngs = rngs
        self._blocks = np.empty((len(rngs), _BLOCK))
        self._taken = np.full(len(rngs), _BLOCK)

    def shares(self, which: Which) -> NDArray[np.float64]:
        """Take the next number of each of these vehicles."""
        taken = self._taken[which]
        if (taken == _BLOCK).any():
            for vehicle in which[taken == _BLOCK].tolist():
                self._blocks[vehicle] = self._rngs[vehicle].random(_BLOCK)
                self._taken[vehicle] = 0
            taken = self._taken[which]
        self._taken[which] = taken + 1
        return np.asarray(self._blocks[which, taken], dtype=np.float64)
