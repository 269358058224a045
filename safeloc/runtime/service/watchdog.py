"""The wall clock, where it is asked for: a vehicle that says nothing gets its cycles all the same.

It knows only when a vehicle's cycle ended last, and how long a cycle may take. Time in which this process itself did
not run is nobody's silence.
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
        """A cycle of this vehicle ended by what it said."""
        self._due[vehicle] = now_s + self._limit_s

    def forget(self, vehicle: str) -> None:
        """It is not watched any more."""
        self._due.pop(vehicle, None)

    def pass_over(self, now_s: float) -> None:
        """Nobody could be heard since the last look: that time counts for nobody."""
        own = 0.0 if self._looked is None else now_s - self._looked
        self._looked = now_s
        self._due = {vehicle: due + own for vehicle, due in self._due.items()}

    def overdue(self, now_s: float) -> Iterable[str]:
        """Vehicles whose cycle is over without their having said so; from then on, one each period."""
        if self._looked is not None and now_s - self._looked > self._limit_s:
            self.pass_over(now_s)
            return []
        self._looked = now_s
        found = [vehicle for vehicle, due in self._due.items() if due <= now_s]
        for vehicle in found:
            self._due[vehicle] += self._period_s
        return found

    def next_s(self, now_s: float) -> float | None:
        """How long to wait before the next look, never so long that it would seem as if this process had not run."""
        return max(0.0, min(min(self._due.values()) - now_s, self._limit_s / 2)) if self._due else None
