"""Check that all sources of records use one clock.

Every world assumes that the inputs of a cycle were measured in that cycle. Each record says so by its time stamp, but nothing
compares the clocks of the devices. A difference shows in operation when a record arrives after a record of another source
with a later time. The difference of the two times is the **lag** of its source: the difference of the clocks plus that of
the delays. With a lag of a cycle or more, the record's cycle was over when it arrived, and the machine cannot use it.

    lag_of("front_wheel", 12_340, {"rear_wheel": 12_450})  ->  Lag("front_wheel", "rear_wheel", 110)
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from safeloc.language.nodes import TRUE
from safeloc.language.world import Law
from safeloc.runtime.breaches import Breach, BrokenLaw, Shown

BORDER = "border"
"""Name used in place of a machine: the border states this law, not the world of a machine."""

ONE_CLOCK = "all sources tell the time of one clock"
LAW = Law(
    TRUE,
    "When a record arrives, no other source has yet sent a record whose time is a cycle or more later: all devices use one "
    "clock, and their records are delayed by less than a cycle.",
    ("period_ms",),
    "[D] a record belongs to the cycle that contains its time; after that cycle it is useless",
    "operator",
    "monitor: `safeloc run`, and `safeloc replay --assumptions` of recorded records",
)
CLOCK_LAW = BrokenLaw(BORDER, ONE_CLOCK, LAW.statement, LAW.owner)


@dataclass(frozen=True)
class Lag:
    """The distance in ms from the time of a source's record to the latest time of another source."""

    source: str
    behind: str
    lag_ms: int

    def distance_ms(self, period_ms: int) -> int:
        """Return by how many ms the lag may still grow; a negative number is a breach of the law."""
        return period_ms - 1 - self.lag_ms

    def breach(self, period_ms: int) -> Breach:
        """Return the lag as a breach of the law."""
        values: dict[str, Shown] = {"source": self.source, "behind": self.behind, "lag_ms": self.lag_ms}
        return Breach((CLOCK_LAW,), self.distance_ms(period_ms), "ms", values)


def lag_of(source: str, time_ms: int, latest: Mapping[str, int]) -> Lag | None:
    """Return the lag of a record behind the latest record of any other source; None if no other source has sent one.

    latest  source -> time of its latest record
    """
    others = [(other_ms, other) for other, other_ms in latest.items() if other != source]
    if not others:
        return None
    latest_ms, other = max(others)
    return Lag(source, other, latest_ms - time_ms)


class SourceClocks:
    """The lags of all sources over a recording.

    greatest   source -> its greatest lag, ms; negative if its records always had the latest time
    least      source -> its least lag, ms; if it is positive, the source's clock is slow or its records are delayed
    """

    def __init__(self) -> None:
        self._latest: dict[str, int] = {}
        self.least: dict[str, int] = {}
        self.greatest: dict[str, Lag] = {}

    def take(self, source: str, time_ms: int) -> Lag | None:
        """Take the time of a record; return its lag.

        A record that is older than the last one of its own source is ignored here: the border refuses it.
        """
        if time_ms < self._latest.get(source, time_ms):
            return None
        lag = lag_of(source, time_ms, self._latest)
        self._latest[source] = time_ms
        if lag is not None:
            self.least[source] = min(self.least.get(source, lag.lag_ms), lag.lag_ms)
            before = self.greatest.get(source)
            self.greatest[source] = lag if before is None or lag.lag_ms > before.lag_ms else before
        return lag
