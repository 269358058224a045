"""The way of each cycle from its first line to its report: for the log, and for metrics. Off unless it is asked for."""

from __future__ import annotations

import time
from collections.abc import Callable

from safeloc.runtime.service.journal import Journal


class Tracer:
    """Notes when lines of a vehicle come, and tells it when their cycle is reported.

    journal   gets a line for each cycle, with its `id` (vehicle, cycle and time, as in the report); None: no lines
    observe   gets the seconds from the first line to the report; None: nobody
    """

    def __init__(self, journal: Journal | None, observe: Callable[[float], None] | None) -> None:
        self._journal, self._observe = journal, observe
        self._open: dict[str, tuple[float, int | None, int | None]] = {}

    def line(self, vehicle: str, number: int | None) -> None:
        """Note a line of a vehicle, with the sender's number."""
        before = self._open.get(vehicle)
        self._open[vehicle] = (time.monotonic(), number, number) if before is None else (*before[:2], number)

    def reported(self, vehicle: str, cycle: int, time_ms: int) -> None:
        """Note the report of a cycle. Cycles that no line brought (of a silence) take no time.

        A machine that begins anew counts its cycles from 1 again, while its time goes on: both together name the cycle.
        """
        found = self._open.pop(vehicle, None)
        if found is None:
            return
        seconds = time.monotonic() - found[0]
        if self._observe is not None:
            self._observe(seconds)
        if self._journal is not None:
            ms = round(seconds * 1_000, 3)
            self._journal.info("cycle", id=f"{vehicle}:{cycle}@{time_ms}", first=found[1], last=found[2], ms=ms)
