"""Random numbers of many vehicles' radars, each vehicle's from streams of its own, taken for some of its cycles at a time.

Draws are asked for by what they are for, and for cells: a cycle of a vehicle each. In turn (`OfOne`) they come in the order in
which they are asked for, so cells are asked for cycle by cycle; by purpose (`ByPurpose`) each cell has its numbers, whatever is asked first.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from safeloc.simulation.vehicle_seed import VehicleSeed

Which = NDArray[np.int64]
"""Numbers of cells: of the cycles under way, each vehicle's; of one cycle alone, the numbers of vehicles."""


class Draws(Protocol):
    """The next random numbers of vehicles."""

    @property
    def at_once(self) -> bool:
        """Cells of all cycles may be asked for at once; else of one cycle after the other."""
        ...

    def shares(self, purpose: str, which: Which) -> NDArray[np.float64]:
        """Take the next share, 0 to below 1, of each of these cells."""
        ...


def between(draws: Draws, purpose: str, which: Which, low: float, high: float) -> NDArray[np.float64]:
    """Take the next number from `low` to `high` of each of these cells, as `Generator.uniform` makes it of a share."""
    return low + (high - low) * draws.shares(purpose, which)


class OfOne:
    """Numbers of one vehicle, whose generator others use as well."""

    at_once = False

    def __init__(self, rng: np.random.Generator) -> None:
        self._rng = rng

    def shares(self, purpose: str, which: Which) -> NDArray[np.float64]:
        """Take the next one, if the vehicle is meant."""
        del purpose
        return self._rng.random(len(which))


_OF_EVERY_FRAME = ("pause", "latency", "clutter", "clutter range", "clutter strength")


class ByPurpose:
    """Numbers of vehicles, of which each has a number for every purpose and cycle: those of every frame from the stream of its radar,
    those of a reflector from a stream for that reflector.
    """

    at_once = True

    def __init__(self, seeds: Sequence[VehicleSeed], cycles: int) -> None:
        self._seeds, self._cycles = seeds, cycles
        self._drawn: dict[str, NDArray[np.float64]] = {}

    def shares(self, purpose: str, which: Which) -> NDArray[np.float64]:
        """Return the numbers of these cells."""
        if purpose not in self._drawn:
            known = _OF_EVERY_FRAME if purpose in _OF_EVERY_FRAME else (purpose,)
            stream = "radar" if purpose in _OF_EVERY_FRAME else f"radar {purpose}"
            rows = np.stack([seed.rng(stream).random((len(known), self._cycles)) for seed in self._seeds], axis=2)
            self._drawn |= {name: values.ravel() for name, values in zip(known, rows, strict=True)}
        return self._drawn[purpose][which]
