"""From records to the steps of a machine: one step every `period_ms`, and a reason for every record not used.

A record belongs to the cycle its time falls into: cycle n ends at `start_ms + n period_ms`, that instant included (and
cycle 1 has its beginning too). Distances of one channel within a cycle are added up. The border judges
(safeloc.border): a record of a cycle that is over is STALE, one older than what its channel said before OUT_OF_ORDER,
and so on. A channel of which a record was refused, or of which fewer came than expected, gives NO input in that step:
part of its distance, or the right one of two readings, is unknown, and an absent input is what machines treat with
care. Nothing is sorted.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from safeloc.border import Channel, Deliveries, Fault, Raw, Reason, admitted
from safeloc.errors import InputError
from safeloc.streams.records import Record, TruthRecord, Unusable

LONGEST_GAP_MS = 3_600_000


@dataclass(frozen=True)
class Cycle:
    """One step: inputs, remarks (the truth, never an input), and every fault, by channel, with its reason."""

    number: int
    end_ms: int
    inputs: Mapping[str, int | str]
    remarks: Mapping[str, int] = field(default_factory=dict)
    faults: tuple[Fault, ...] = ()

    @property
    def rejected(self) -> tuple[Fault, ...]:
        """Records that were not used, each with its number in the stream (from 0)."""
        return tuple(fault for fault in self.faults if fault.number is not None)

    @property
    def missing(self) -> tuple[str, ...]:
        """Channels of which fewer records came than expected."""
        return tuple(fault.channel for fault in self.faults if fault.reason is Reason.MISSING)

    def as_step(self) -> Mapping[str, int | str]:
        """Inputs and remarks, as step streams hold them."""
        return {**self.inputs, **self.remarks}


@dataclass
class _Open:
    """The cycle being filled."""

    number: int
    begin_ms: int
    end_ms: int
    used: dict[str, list[Record]] = field(default_factory=dict)
    faults: list[Fault] = field(default_factory=list)


@dataclass(frozen=True)
class _Builder:
    """What all cycles share: ranges by input name, least records by channel, and what each channel said last."""

    limits: Mapping[str, Channel]
    expected: Mapping[str, int]
    deliveries: Deliveries = field(default_factory=Deliveries)


def cycles(
    records: Iterable[Record | Unusable],
    period_ms: int,
    *,
    start_ms: int = 0,
    channels: Sequence[Channel] = (),
    expected: Mapping[str, int] | None = None,
    longest_gap_ms: int = LONGEST_GAP_MS,
) -> Iterator[Cycle]:
    """Steps up to the last record, none left out: a silent period gives steps without inputs.

    channels        ranges of machine inputs by their names (`channels_of`); what lies outside is no input
    expected        channel -> records it makes in every cycle; one with fewer gives no input and is MISSING
    longest_gap_ms  a leap of time beyond it is taken for a wrong clock: InputError
    """
    if period_ms < 1:
        raise InputError(f"period_ms is {period_ms}; a cycle takes at least 1 ms.")
    builder = _Builder({channel.name: channel for channel in channels}, expected or {})
    current = _Open(1, start_ms - 1, start_ms + period_ms)
    for number, record in enumerate(records):
        if record.time_ms > current.end_ms + longest_gap_ms:
            raise InputError(
                f"record {number} ({record.channel}) is {record.time_ms - current.end_ms} ms ahead, more than "
                f"longest_gap_ms {longest_gap_ms}; mend its time, split the recording there, or allow a longer gap."
            )
        while record.time_ms > current.end_ms:
            yield _closed(builder, current)
            current = _Open(current.number + 1, current.end_ms, current.end_ms + period_ms)
        _take(builder, current, number, record)
    if current.used or current.faults:
        yield _closed(builder, current)


def _take(builder: _Builder, current: _Open, number: int, record: Record | Unusable) -> None:
    fault = _fault(builder, current, record)
    if fault is not None:
        current.faults.append(replace(fault, number=number))
    elif not isinstance(record, Unusable):
        current.used.setdefault(record.channel, []).append(record)


def _fault(builder: _Builder, current: _Open, record: Record | Unusable) -> Fault | None:
    """When it came, whether there is room for it, and what it says; the sum of increments is judged at the end."""
    oldest_ms = current.end_ms - current.begin_ms - 1
    late = builder.deliveries.fault(record.channel, Raw(None, record.time_ms), current.end_ms, oldest_ms)
    if late is not None:
        return late
    if isinstance(record, Unusable):
        return Fault(record.channel, record.reason, record.detail)
    if record.is_increment or isinstance(record, TruthRecord):
        return None
    if record.channel in current.used:
        return Fault(record.channel, Reason.SURPLUS, f"at {record.time_ms} ms")
    return _outside(builder, record.channel, record.inputs())


def _outside(builder: _Builder, channel: str, inputs: Mapping[str, int | str]) -> Fault | None:
    """The first of these inputs that is not in its range."""
    for name, value in inputs.items():
        judged = admitted(builder.limits[name], value) if name in builder.limits else None
        if isinstance(judged, Fault):
            return Fault(channel, judged.reason, f"{name}: {judged.detail}")
    return None


def _closed(builder: _Builder, current: _Open) -> Cycle:
    faults = list(current.faults)
    faults += [
        Fault(name, Reason.MISSING, f"{len(current.used.get(name, ()))} of {least}")
        for name, least in builder.expected.items()
        if len(current.used.get(name, ())) < least
    ]
    doubtful = {fault.channel for fault in faults}
    sound = {name: said for name, said in current.used.items() if name not in doubtful}
    inputs: dict[str, int | str] = {}
    for name, said in sound.items():
        total = _total(said)
        outside = _outside(builder, name, total)
        if outside is None:
            inputs |= total
        else:
            faults.append(outside)
    return Cycle(current.number, current.end_ms, inputs, _remarks(sound.get("truth", ())), tuple(faults))


def _remarks(said: Sequence[Record]) -> Mapping[str, int]:
    truth = [record for record in said if isinstance(record, TruthRecord)]
    return truth[-1].remarks() if truth else {}


def _total(said: Sequence[Record]) -> Mapping[str, int | str]:
    """Increments added up; otherwise there is just one record."""
    if len(said) == 1:
        return said[0].inputs()
    total: dict[str, int | str] = {}
    for record in said:
        for name, value in record.inputs().items():
            before = total.get(name, 0)
            total[name] = before + value if isinstance(before, int) and isinstance(value, int) else value
    return total
