"""Computes the covariance figure of the criterion (SAT-3, SAT-4) from a satellite's differences over its last epochs.

The prediction has no noise, so the figure is the variance of measured minus predicted. There is none before the window is
full, and a satellite without it is not used.
"""

from __future__ import annotations

from collections import deque

from safeloc.errors import InputError


class Window:
    """The last differences of one satellite, in whole mm or mm/s. InputError for fewer than two epochs."""

    def __init__(self, epochs: int) -> None:
        if epochs < 2:
            raise InputError(f"a window of {epochs} epochs has no variance; take two or more.")
        self._values: deque[int] = deque(maxlen=epochs)

    def add(self, difference: int | None) -> int | None:
        """Add a value; return the variance with it, rounded up, or None until the window is full. None (not measured)
        empties the window."""
        if difference is None:
            self._values.clear()
            return None
        self._values.append(difference)
        return self._variance() if len(self._values) == self._values.maxlen else None

    def _variance(self) -> int:
        count, total = len(self._values), sum(self._values)
        squares = count * sum(value * value for value in self._values) - total * total
        return -(-squares // (count * (count - 1)))
