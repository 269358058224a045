"""From records to the steps of a machine: one step every `period_ms`, and a reason for every record that is not used.

A record belongs to the cycle that contains its time: cycle n ends at `start_ms + n period_ms`, that instant included (and
cycle 1 includes its start). Distances of one channel within a cycle are added up. The border (safeloc.runtime.border)
checks each record: one of a past cycle is STALE, one older than the last record of its channel is OUT_OF_ORDER, and so on.

A channel gives NO input in a step if one of its records was refused, or if fewer arrived than expected: then part of its
distance, or the right one of two readings, is unknown, and the machine handles an absent input safely. The other inputs of
the same reading are left out too (a marker without its accuracy would get the default one). If two channels give the same
input, both are ignored. Records are not sorted.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from safeloc.errors import InputError
from safeloc.runtime.border import Channel, Deliveries, Fault, Reason, admitted
from safeloc.runtime.streams.records import Record, TruthRecord, Unusable

_LONGEST_GAP_MS = 3_600_000
Places = Callable[[str], Iterable[object]]
"""Name in a record -> the inputs that it means."""


@dataclass(frozen=True)
class Cycle:
    """One step: inputs, remarks (the true position, never an input), and all faults."""

    number: int
    end_ms: int
    inputs: Mapping[str, int | str]
    remarks: Mapping[str, int] = field(default_factory=dict)
    faults: tuple[Fault, ...] = ()

    @property
    def rejected(self) -> tuple[Fault, ...]:
        """Return the faults of single records, each with the record's number in the stream (from 0)."""
        return tuple(fault for fault in self.faults if fault.number is not None)

    @property
    def missing(self) -> tuple[str, ...]:
        """Return the channels with fewer records than expected."""
        return tuple(fault.channel for fault in self.faults if fault.reason is Reason.MISSING)

    def as_step(self) -> Mapping[str, int | str]:
        """Return inputs and remarks in the form of step streams."""
        return {**self.inputs, **self.remarks}


class CycleBuilder:
    """A builder of cycles, one after the other. Its memory is the number of cycles and the last record of each channel.

    begin_ms    the last instant before the open cycle
    end_ms      the last instant of the open cycle

    channels    ranges of machine inputs by name (`channels_of`); a value outside of its range is a fault
    expected    channel -> number of its records per cycle; a channel with fewer gives no input and is MISSING
    places      the inputs that a name means, if that is more than the input of this name
    done        number of cycles closed before, with their `deliveries`: to continue where another builder stopped

    InputError for a period below 1 ms.
    """

    def __init__(
        self,
        period_ms: int,
        *,
        start_ms: int = 0,
        channels: Sequence[Channel] = (),
        expected: Mapping[str, int] | None = None,
        places: Places | None = None,
        done: int = 0,
        deliveries: Deliveries | None = None,
    ) -> None:
        if period_ms < 1:
            raise InputError(f"period_ms is {period_ms}; give at least 1 ms.")
        self.period_ms, self.start_ms, self.done = period_ms, start_ms, done
        self._open()
        self.deliveries = deliveries or Deliveries()
        self._limits = {channel.name: channel for channel in channels}
        self._expected = expected or {}
        self._places = places or (lambda name: (name,))
        self._used: dict[str, list[Record]] = {}
        self._faults: list[Fault] = []

    @property
    def empty(self) -> bool:
        """Return whether the open cycle has no records."""
        return not self._used and not self._faults

    def take(self, number: int, record: Record | Unusable) -> Fault | None:
        """Take a record for the open cycle; return the fault if it is not used. `number` is its place in the stream."""
        channel = record.channel
        fault = self._fault(channel, record)
        if fault is not None:
            self._faults.append(replace(fault, number=number))
        elif not isinstance(record, Unusable):
            self._used.setdefault(channel, []).append(record)
        return fault

    def refuse(self, fault: Fault) -> None:
        """Add a fault that was found elsewhere: its channel gives no input in the open cycle."""
        self._faults.append(fault)

    def close(self) -> Cycle:
        """End the open cycle and return it; begin the next one."""
        inputs, remarks, faults = ({}, {}, ()) if self.empty and not self._expected else self._judged()
        cycle = Cycle(self.done + 1, self.end_ms, inputs, remarks, faults)
        self.done, self._used, self._faults = self.done + 1, {}, []
        self._open()
        return cycle

    def _judged(self) -> tuple[Mapping[str, int | str], Mapping[str, int], tuple[Fault, ...]]:
        """Return the inputs of the open cycle, its remarks, and what was refused."""
        faults = [*self._faults, *self._missing()]
        doubtful = {fault.channel for fault in faults}
        totals: dict[str, Mapping[str, int | str]] = {}
        for name, records in self._used.items():
            if name not in doubtful:
                total = _total(records)
                outside = _outside(self._limits, name, total)
                if outside is None:
                    totals[name] = total
                else:
                    faults.append(outside)
        doubts = self._contradicting(totals)
        if faults or doubts:
            doubts += _torn([*faults, *doubts], totals)
        for fault in doubts:
            if totals.pop(fault.channel, None) is not None:
                faults.append(fault)
        inputs: dict[str, int | str] = {}
        for total in totals.values():
            inputs |= total
        truth = self._used["truth"] if "truth" in totals else ()
        return inputs, _remarks(truth), tuple(faults)

    def _open(self) -> None:
        """Set the times of the next cycle."""
        self.end_ms = self.start_ms + (self.done + 1) * self.period_ms
        self.begin_ms = self.end_ms - self.period_ms if self.done else self.start_ms - 1

    def _contradicting(self, totals: Mapping[str, Mapping[str, int | str]]) -> list[Fault]:
        """Return a fault for each channel that gives the same input as another channel, with equal values or not."""
        places = self._places
        given = [place for total in totals.values() for name in total for place in places(name)]
        if len(set(given)) == len(given):  # the usual case
            return []
        givers: dict[object, str] = {}
        faults: list[Fault] = []
        for channel, total in totals.items():
            for name in total:
                for place in places(name):
                    other = givers.setdefault(place, channel)
                    if other != channel:
                        faults.append(Fault(channel, Reason.SURPLUS, f"{other} gives the same input"))
                        faults.append(Fault(other, Reason.SURPLUS, f"{channel} gives the same input"))
        return faults

    def _missing(self) -> Iterator[Fault]:
        for name, least in self._expected.items():
            count = len(self._used.get(name, ()))
            if count < least:
                yield Fault(name, Reason.MISSING, f"{count} of {least}")

    def _fault(self, channel: str, record: Record | Unusable) -> Fault | None:
        """Return the fault in a record's time, number or value; the sum of increments is checked at the end of the cycle."""
        late = self.deliveries.late(channel, record.time_ms, None, self.end_ms, self.end_ms - self.begin_ms - 1)
        if late is not None:
            return late
        if isinstance(record, Unusable):
            return Fault(channel, record.reason, record.detail)
        if record.is_increment or isinstance(record, TruthRecord):
            return None
        if channel in self._used:
            return Fault(channel, Reason.SURPLUS, f"at {record.time_ms} ms")
        return _outside(self._limits, channel, record.inputs())


def cycles(
    records: Iterable[Record | Unusable],
    period_ms: int,
    *,
    start_ms: int = 0,
    channels: Sequence[Channel] = (),
    expected: Mapping[str, int] | None = None,
    places: Places | None = None,
    longest_gap_ms: int = _LONGEST_GAP_MS,
) -> Iterator[Cycle]:
    """Yield all steps up to the last record; a silent period gives steps without inputs.

    channels, expected, places  as for the CycleBuilder
    longest_gap_ms              InputError for a longer gap in time, since the clock may be wrong
    """
    builder = CycleBuilder(period_ms, start_ms=start_ms, channels=channels, expected=expected, places=places)
    for number, record in enumerate(records):
        if record.time_ms > builder.end_ms + longest_gap_ms:
            raise InputError(
                f"record {number} ({record.channel}) is {record.time_ms - builder.end_ms} ms ahead, more than "
                f"longest_gap_ms {longest_gap_ms}; correct its time, split the recording there, or allow a longer gap."
            )
        while record.time_ms > builder.end_ms:
            yield builder.close()
        builder.take(number, record)
    if not builder.empty:
        yield builder.close()


def _torn(faults: Sequence[Fault], totals: Mapping[str, object]) -> list[Fault]:
    """Return a fault for each incomplete reading: `front_marker` if `front_marker_accuracy_mm` was refused, and the reverse."""
    refused = {fault.channel for fault in faults if fault.reason is not Reason.UNKNOWN}
    stems = [(one, one.rpartition(".")[2]) for one in refused]
    return [
        Fault(channel, Reason.MISSING, f"{one} was refused")
        for channel in (totals if stems else ())
        for one, stem in stems
        if one != channel and _is_part(channel.rpartition(".")[2], stem)
    ]


def _is_part(one: str, other: str) -> bool:
    """Return whether both names belong to one reading: one of them begins with the other."""
    return one == other or one.startswith(f"{other}_") or other.startswith(f"{one}_")


def _outside(limits: Mapping[str, Channel], channel: str, inputs: Mapping[str, int | str]) -> Fault | None:
    """Return the fault of the first input outside of its range; None if all are in range."""
    for name, value in inputs.items():
        limit = limits.get(name)
        if limit is None or (type(value) is int and limit.low <= value <= limit.high):
            continue
        checked = admitted(limit, value)
        if isinstance(checked, Fault):
            return Fault(channel, checked.reason, f"{name}: {checked.detail}")
    return None


def _remarks(records: Sequence[Record]) -> Mapping[str, int]:
    truth = [record for record in records if isinstance(record, TruthRecord)]
    return truth[-1].remarks() if truth else {}


def _total(records: Sequence[Record]) -> Mapping[str, int | str]:
    """Return the inputs of a channel's records: the sum of increments; of any other kind there is only one record."""
    if len(records) == 1:
        return records[0].inputs()
    total: dict[str, int | str] = {}
    for record in records:
        for name, value in record.inputs().items():
            before = total.get(name, 0)
            total[name] = before + value if isinstance(before, int) and isinstance(value, int) else value
    return total
