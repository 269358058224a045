"""The optional watchdog: it ends the cycles of a silent vehicle by the wall clock.

It knows only when each vehicle's last cycle ended, and how long a cycle may take. Time in which this process itself did
not run does not count as silence.
"""

from __future__ import annotations

from collections.abc import Iterable


class Watchdog:
    """A watchdog for all vehicles.

    limit_s    longest time from the end of a cycle to the end of the next one; at least a period
    period_s   length of a cycle
    """

    def __init__(self, limit_s: float, period_s: float) -> None:
        self._limit_s, self._period_s = limit_s, period_s
        self._due: dict[str, float] = {}
        self._earliest = float("inf")
        """No vehicle is due before; looked for only when it has passed, since vehicles end cycles all the time."""
        self._looked: float | None = None

    def ended(self, vehicle: str, now_s: float) -> None:
        """Record that a line of the vehicle ended its cycle."""
        self._due[vehicle] = due = now_s + self._limit_s
        if due < self._earliest:
            self._earliest = due

    def forget(self, vehicle: str) -> None:
        """Stop watching a vehicle."""
        self._due.pop(vehicle, None)

    def pass_over(self, now_s: float) -> None:
        """Ignore the time since the last call, in which no line could be read."""
        elapsed_s = 0.0 if self._looked is None else now_s - self._looked
        self._looked = now_s
        self._due = {vehicle: due + elapsed_s for vehicle, due in self._due.items()}
        self._earliest += elapsed_s

    def overdue(self, now_s: float) -> Iterable[str]:
        """Return the vehicles whose cycle is overdue; from then on, each of them once per period until a line ends a cycle."""
        if self._looked is not None and now_s - self._looked > self._limit_s:
            self.pass_over(now_s)
            return []
        self._looked = now_s
        if now_s < self._earliest:
            return []
        found = [vehicle for vehicle, due in self._due.items() if due <= now_s]
        for vehicle in found:
            self._due[vehicle] += self._period_s
        self._earliest = min(self._due.values(), default=float("inf"))
        return found

    def next_s(self, now_s: float) -> float | None:
        """Return the time until the next call, short enough to notice that this process was not running."""
        return max(0.0, min(self._earliest - now_s, self._limit_s / 2)) if self._due else None
