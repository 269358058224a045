"""The clocks of sources: whether the records that arrive tell the time of one clock.

Every world supposes that the inputs of a cycle are of that cycle. Records say so by their time, and nobody compares the clocks
of the devices that write it. In operation that shows in one way: when a record arrives, some other source has told a later
time. By how much is the **lag** of its source: the difference of both clocks and of both delays. A lag of a cycle or more
means that the record's cycle was over when it came, and that what it says is lost to the machine.

    lag_of("front_wheel", 12_340, {"rear_wheel": 12_450})  ->  Lag("front_wheel", "rear_wheel", 110)
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from safeloc.language.nodes import TRUE
from safeloc.language.world import Law
from safeloc.runtime.breaches import Breach, BrokenLaw, Shown

BORDER = "border"
"""What states the law, in place of a machine's world."""

ONE_CLOCK = "all sources tell the time of one clock"
LAW = Law(
    TRUE,
    "When a record arrives, no other source has yet told a time that is a cycle or more later: devices tell the time of one "
    "clock, and their records are delayed by less than a cycle.",
    ("period_ms",),
    "[D] a record belongs to the cycle that its time falls into; after that cycle it is of no use",
    "operator",
    "monitor: `safeloc run`, and `safeloc replay --assumptions` of recorded records",
)
CLOCK_LAW = BrokenLaw(BORDER, ONE_CLOCK, LAW.statement, LAW.owner)


@dataclass(frozen=True)
class Lag:
    """How far the time of a source's record is behind the latest time of another source. Unit ms."""

    source: str
    behind: str
    lag_ms: int

    def distance_ms(self, period_ms: int) -> int:
        """Return how much more it might lag; below 0 where that breaks the law."""
        return period_ms - 1 - self.lag_ms

    def breach(self, period_ms: int) -> Breach:
        """Return it as a breach of the law."""
        values: dict[str, Shown] = {"source": self.source, "behind": self.behind, "lag_ms": self.lag_ms}
        return Breach((CLOCK_LAW,), self.distance_ms(period_ms), "ms", values)


def lag_of(source: str, time_ms: int, told: Mapping[str, int]) -> Lag | None:
    """Return how far a record lags behind what other sources told before it; None where no other has told anything.

    told  source -> the latest time that it has told
    """
    others = [(other_ms, other) for other, other_ms in told.items() if other != source]
    if not others:
        return None
    latest_ms, other = max(others)
    return Lag(source, other, latest_ms - time_ms)


class SourceClocks:
    """The lags of sources over a whole recording.

    greatest   source -> its greatest lag, ms; below 0 where it was always the latest
    least      source -> its least lag, ms: one that is always behind has a clock that is, or a delay
    """

    def __init__(self) -> None:
        self._told: dict[str, int] = {}
        self.least: dict[str, int] = {}
        self.greatest: dict[str, Lag] = {}

    def hear(self, source: str, time_ms: int) -> Lag | None:
        """Take the time of a record, and return its lag.

        What is older than the source's own last record tells nothing of its clock: the border refuses it for its order.
        """
        if time_ms < self._told.get(source, time_ms):
            return None
        lag = lag_of(source, time_ms, self._told)
        self._told[source] = time_ms
        if lag is not None:
            self.least[source] = min(self.least.get(source, lag.lag_ms), lag.lag_ms)
            before = self.greatest.get(source)
            self.greatest[source] = lag if before is None or lag.lag_ms > before.lag_ms else before
        return lag
