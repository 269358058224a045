"""The optional watchdog: by the wall clock, a silent vehicle gets its cycles too.

It knows only when a vehicle's cycle ended last, and how long a cycle may take. Time in which this process itself did not
run does not count as silence.
"""

from __future__ import annotations

from collections.abc import Iterable


class Watchdog:
    """limit_s: how long after a cycle's end the next one may end; at least a period. period_s: of each cycle."""

    def __init__(self, limit_s: float, period_s: float) -> None:
        self._limit_s, self._period_s = limit_s, period_s
        self._due: dict[str, float] = {}
        self._looked: float | None = None

    def ended(self, vehicle: str, now_s: float) -> None:
        """Record that a line of the vehicle ended its cycle."""
        self._due[vehicle] = now_s + self._limit_s

    def forget(self, vehicle: str) -> None:
        """It is not watched any more."""
        self._due.pop(vehicle, None)

    def pass_over(self, now_s: float) -> None:
        """Skip the time since the last look, in which no line could be read."""
        own = 0.0 if self._looked is None else now_s - self._looked
        self._looked = now_s
        self._due = {vehicle: due + own for vehicle, due in self._due.items()}

    def overdue(self, now_s: float) -> Iterable[str]:
        """List the vehicles whose cycle is overdue without a line that ended it; from then on, one per period."""
        if self._looked is not None and now_s - self._looked > self._limit_s:
            self.pass_over(now_s)
            return []
        self._looked = now_s
        found = [vehicle for vehicle, due in self._due.items() if due <= now_s]
        for vehicle in found:
            self._due[vehicle] += self._period_s
        return found

    def next_s(self, now_s: float) -> float | None:
        """Return the time until the next look, short enough to notice when this process itself was not running."""
        return max(0.0, min(min(self._due.values()) - now_s, self._limit_s / 2)) if self._due else None
