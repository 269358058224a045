"""A controller's watch over the assumptions of its machine, cycle by cycle; it changes nothing in the machine."""

from __future__ import annotations

from collections.abc import Mapping

from safeloc.codegen.compiled import Row
from safeloc.language.nodes import Value
from safeloc.runtime.breaches import Breach
from safeloc.runtime.embedding.laws import Memory
from safeloc.runtime.embedding.program import Program
from safeloc.runtime.source_clocks import lag_of
from safeloc.runtime.streams.records import Record, TruthRecord, Unusable

_Latest = Mapping[str, tuple[int, int | None]]
_TRUTH = "truth"


class Watch:
    """The memory of the laws: values of an observer, and the records of the open cycle that arrived too late."""

    def __init__(self, program: Program, period_ms: int) -> None:
        self._laws, self._period_ms = program.laws, period_ms
        self._memory: Memory = self._laws.begin()
        self._lagging: list[Breach] = []

    def late(self, record: Record | Unusable, latest: _Latest) -> None:
        """Take a record that arrived after its cycle; `latest` is the border's newest time of every channel."""
        if isinstance(record, (Unusable, TruthRecord)):  # no measurement, so its time comes from no device's clock
            return
        times = {channel: time_ms for channel, (time_ms, _) in latest.items() if channel != _TRUTH}
        lag = lag_of(record.channel, record.time_ms, times)
        if lag is not None and lag.distance_ms(self._period_ms) < 0:
            self._lagging.append(lag.breach(self._period_ms))

    def judge(self, before: Row, inputs: Row, after: Row) -> tuple[Breach, ...]:
        """Return the breaches of the cycle."""
        found, self._memory = self._laws.judged(before, inputs, after, self._memory)
        return (*self._late_ones(), *found) if self._lagging else found

    def begin_anew(self) -> tuple[Breach, ...]:
        """Reset the observer, since the machine restarts; return the breaches that late records show."""
        self._memory = self._laws.begin()
        return self._late_ones()

    @property
    def observed(self) -> dict[str, Value] | None:
        """The observer's values by name, for a snapshot; None while they are unknown."""
        return None if self._memory is None else dict(zip(self._laws.names, self._memory, strict=True))

    def restore(self, observed: Mapping[str, Value] | None) -> None:
        """Continue with the observer's values of a snapshot. None: laws that need them are not checked until a restart."""
        known = observed if observed is not None or self._laws.names else {}
        self._memory, self._lagging = (None if known is None else tuple(known.values())), []

    def _late_ones(self) -> tuple[Breach, ...]:
        lagging, self._lagging = self._lagging, []
        return tuple(lagging)
