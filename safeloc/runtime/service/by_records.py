"""A vehicle whose lines are records: these wait for the end of their cycle."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from safeloc.errors import SnapshotError
from safeloc.runtime.border import Reason
from safeloc.runtime.embedding.controller import MOST_RECORDS
from safeloc.runtime.service.clock_lag import Pace
from safeloc.runtime.service.messages import CycleEnd, RecordLine, Step
from safeloc.runtime.service.saved_fields import SavedRecords, SavedVehicle, checked_fields
from safeloc.runtime.service.vehicle import MakeController, Vehicle
from safeloc.runtime.streams.records import RECORD, Record, Unusable


class RecordsVehicle(Vehicle):
    """A vehicle whose cycle ends with a record of a later cycle, or with a line of kind `cycle`."""

    def __init__(self, name: str, make: MakeController, pace: Pace, *, from_start: bool) -> None:
        super().__init__(name, make, pace, from_start=from_start)
        self._pending: list[tuple[int, Record | Unusable]] = []

    def _take(self, line: int, message: RecordLine | CycleEnd | Step) -> None:
        if isinstance(message, CycleEnd):
            self._end_cycle(line, message.time_ms)
        elif isinstance(message, RecordLine):
            self._take_record(line, message.record)

    def _take_record(self, line: int, record: Record | Unusable) -> None:
        if self.controller is None:
            self.controller = self._make(self._pace.beginning(record.time_ms))
        if not self._in_step(line, record.time_ms):
            return
        while not self.stopped and record.time_ms > self.controller.next_end_ms:
            self._close()
        self._note_line()
        if len(self._pending) < MOST_RECORDS:
            self._pending.append((line, record))
        else:
            self._lost = f"more than {MOST_RECORDS} records in one cycle"
            self._refuse(line, self._lost)

    def _end_cycle(self, line: int, time_ms: int) -> None:
        if self.controller is None:
            self.controller = self._make(time_ms // self._pace.period_ms * self._pace.period_ms)
            self._lost = self._lost_before_next = ""  # all lines of earlier cycles have been sent
        if not self._in_step(line, time_ms):
            return
        while not self.stopped and time_ms >= self.controller.next_end_ms:
            self._close()
            self._lost_before_next = ""

    def _close(self) -> None:
        pending, lost = self._pending, self._lost
        self._pending, self._lost = [], ""
        lines = {place: line for place, (line, _) in enumerate(pending)}
        self._tell(self._guarded(lambda one: one.step([record for _, record in pending], lost=lost)), lines)

    def _anything_open(self) -> bool:
        return bool(self._pending)

    def _own(self) -> Mapping[str, Any]:
        return {"pending": [[line, _row(record)] for line, record in self._pending]}

    def _checked(self, content: Mapping[str, Any]) -> SavedVehicle:
        kept = checked_fields(SavedRecords, content)
        self._pending = [(line, _record(row)) for line, row in kept.pending]
        return kept

    def _forget_open(self) -> None:
        self._pending = []


def _row(record: Record | Unusable) -> dict[str, Any]:
    if isinstance(record, Unusable):
        return {"time_ms": record.time_ms, "channel": record.channel, "why": [record.reason.name, record.detail]}
    return record.model_dump(exclude_none=True)


def _record(row: Mapping[str, Any]) -> Record | Unusable:
    """Return the record in a row of a snapshot; SnapshotError if there is none."""
    try:
        if "why" in row:
            reason, detail = row["why"]
            return Unusable(int(row["time_ms"]), str(row["channel"]), Reason[reason], str(detail))
        return RECORD.validate_python(row)
    except (LookupError, TypeError, ValueError) as error:
        raise SnapshotError(f"the snapshot has an invalid record ({type(error).__name__}).") from error
