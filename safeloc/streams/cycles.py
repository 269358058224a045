"""From records to the steps of a machine: one step every `period_ms`, and a reason for every record not used.

A record belongs to the cycle its time falls into: cycle n ends at `start_ms + n period_ms`, that instant included (and
cycle 1 has its beginning too). Distances of one channel within a cycle are added up. A channel of which a record was
rejected, or of which fewer came than expected, gives NO input in that step: part of its distance, or the right one of
two readings, is unknown, and an absent input is what machines treat with care. Nothing is sorted.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum

from safeloc.errors import InputError
from safeloc.streams.records import Record, TruthRecord

LONGEST_GAP_MS = 3_600_000


class Rejection(StrEnum):
    """Why a record was not used."""

    STALE = "stale"
    """Its cycle is already over."""
    DUPLICATE = "duplicate"
    """The channel has said something for this very time before."""
    OUT_OF_ORDER = "out of order"
    """Older than what the channel has said before."""
    SURPLUS = "surplus"
    """A second reading where a step takes one."""


@dataclass(frozen=True)
class Rejected:
    """A record that was not used: its number in the stream (from 0) and why."""

    number: int
    record: Record
    reason: Rejection


@dataclass(frozen=True)
class Cycle:
    """One step: inputs, remarks (the truth, never an input), what was rejected, and what too little came of."""

    number: int
    end_ms: int
    inputs: Mapping[str, int | str]
    remarks: Mapping[str, int] = field(default_factory=dict)
    rejected: tuple[Rejected, ...] = ()
    missing: tuple[str, ...] = ()

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
    rejected: list[Rejected] = field(default_factory=list)


def cycles(
    records: Iterable[Record],
    period_ms: int,
    *,
    start_ms: int = 0,
    expected: Mapping[str, int] | None = None,
    longest_gap_ms: int = LONGEST_GAP_MS,
) -> Iterator[Cycle]:
    """Steps up to the last record, none left out: a silent period gives steps without inputs.

    expected        channel -> records it makes in every cycle; one with fewer gives no input and is named in `missing`
    longest_gap_ms  a leap of time beyond it is taken for a wrong clock: InputError
    """
    if period_ms < 1:
        raise InputError(f"period_ms is {period_ms}; a cycle takes at least 1 ms.")
    current, last = _Open(1, start_ms - 1, start_ms + period_ms), dict[str, int]()
    for number, record in enumerate(records):
        if record.time_ms > current.end_ms + longest_gap_ms:
            raise InputError(
                f"record {number} ({record.channel}) is {record.time_ms - current.end_ms} ms ahead, more than "
                f"longest_gap_ms {longest_gap_ms}; mend its time, split the recording there, or allow a longer gap."
            )
        while record.time_ms > current.end_ms:
            yield _closed(current, expected or {})
            current = _Open(current.number + 1, current.end_ms, current.end_ms + period_ms)
        _take(current, last, number, record)
    if current.used or current.rejected:
        yield _closed(current, expected or {})


def _take(current: _Open, last: dict[str, int], number: int, record: Record) -> None:
    reason = _rejection(current, last.get(record.channel), record)
    if reason is None:
        current.used.setdefault(record.channel, []).append(record)
        last[record.channel] = record.time_ms
    else:
        current.rejected.append(Rejected(number, record, reason))


def _rejection(current: _Open, last_ms: int | None, record: Record) -> Rejection | None:
    if last_ms is not None and record.time_ms == last_ms:
        return Rejection.DUPLICATE
    if record.time_ms <= current.begin_ms:
        return Rejection.STALE
    if last_ms is not None and record.time_ms < last_ms:
        return Rejection.OUT_OF_ORDER
    if record.channel in current.used and not record.is_increment and not isinstance(record, TruthRecord):
        return Rejection.SURPLUS
    return None


def _closed(current: _Open, expected: Mapping[str, int]) -> Cycle:
    doubtful = {one.record.channel for one in current.rejected}
    missing = tuple(name for name, least in expected.items() if len(current.used.get(name, ())) < least)
    sound = {name: said for name, said in current.used.items() if name not in doubtful and name not in missing}
    inputs = {name: value for said in sound.values() for name, value in _total(said).items()}
    truth = [record for record in sound.get("truth", []) if isinstance(record, TruthRecord)]
    remarks = truth[-1].remarks() if truth else {}
    return Cycle(current.number, current.end_ms, inputs, remarks, tuple(current.rejected), missing)


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
