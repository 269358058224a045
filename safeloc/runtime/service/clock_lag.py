"""Comparison of the times in a vehicle's lines with its clock: in step, late, or on another clock."""

from __future__ import annotations

from dataclasses import dataclass

OUT_OF_STEP_CYCLES = 10
"""Cycles of their own time for which lines out of step have to agree, before the clock counts as set."""

AT_ONCE_CYCLES = 10
"""Cycles that a single line may be ahead: this is a short silence, bridged by steps without inputs."""

AGREEING_CYCLES = 2
"""Cycles of their own time for which lines have to agree that are further ahead, but within the longest gap."""

LONGEST_GAP_MS = 60_000
LATEST_MS = 2**53
"""Latest time that is accepted; a later one comes from a broken clock."""


@dataclass(frozen=True)
class Pace:
    """The cycle length, and the longest silence that is bridged cycle by cycle, in ms."""

    period_ms: int
    longest_gap_ms: int = LONGEST_GAP_MS

    def beginning(self, time_ms: int) -> int:
        """Return the beginning of the cycle that contains this time, if cycles end at whole periods."""
        return max(0, (time_ms - 1) // self.period_ms * self.period_ms)

    def at_once_ms(self, stride_ms: int) -> int:
        """Return how far ahead a single line is accepted, in ms; `stride_ms` is the pause before the vehicle's last line."""
        return min(self.longest_gap_ms, max(AT_ONCE_CYCLES * self.period_ms, 2 * stride_ms))


class Rhythm:
    """The rhythm of a vehicle's lines: the time of the last one, and the pause before it."""

    def __init__(self, last_ms: int | None = None, stride_ms: int = 0) -> None:
        self.last_ms, self.stride_ms = last_ms, stride_ms

    def note(self, time_ms: int) -> None:
        """Record a line in step."""
        if time_ms != self.last_ms:
            self.stride_ms = 0 if self.last_ms is None else max(0, time_ms - self.last_ms)
            self.last_ms = time_ms


class Streak:
    """A row of lines out of step. A single line is a wrong clock value; after the clock was set, the lines agree."""

    def __init__(self, pace: Pace, first_ms: int | None = None, last_ms: int = 0) -> None:
        self._pace = pace
        self.first_ms, self.last_ms = first_ms, last_ms

    def end(self) -> None:
        """Record a line in step."""
        self.first_ms = None

    def end_before(self, time_ms: int) -> None:
        """Record a late line: it contradicts a line that is ahead."""
        if self.first_ms is not None and self.first_ms < time_ms:
            self.end()

    def goes_on(self, time_ms: int, cycles: int = OUT_OF_STEP_CYCLES) -> bool:
        """Record one more line out of step; return whether they have agreed long enough to be accepted."""
        if self.first_ms is None or not 0 <= time_ms - self.last_ms <= self._pace.longest_gap_ms:
            self.first_ms = time_ms
        self.last_ms = time_ms
        return time_ms - self.first_ms >= cycles * self._pace.period_ms
