"""Puts faults of transmission and reading into a stream of records.

duplicate    the record arrives twice
late         the record arrives after the next `reach` records
swap         the record changes places with the next one of its channel
freeze       the record repeats the last content of its channel, with its own time
drop         the record does not arrive
cross-talk   a marker is read as one of the neighbouring track, `identity` at `position_mm`, with a valid check sum
"""

from __future__ import annotations

from collections.abc import Sequence

from safeloc.errors import InputError
from safeloc.runtime.streams.records import MarkerRecord, Record
from safeloc.simulation.faults import Fault, Kinds, plain

KINDS = Kinds(
    "a stream of records",
    {
        **plain("duplicate", "swap", "freeze", "drop"),
        "late": {"reach": 1},
        "cross-talk": {"identity": 0, "position_mm": None},
    },
)
"""Faults by channel, in ms of the records' clock."""


def disturb(records: Sequence[Record], faults: Sequence[Fault]) -> list[Record]:
    """Return the stream with the faults, applied one after the other. InputError for a fault that no stream has, and for one
    that hits no record."""
    stream = list(records)
    KINDS.require(faults, places=sorted({record.channel for record in stream}))
    for fault in faults:
        hit = [number for number, record in enumerate(stream) if _meant(fault, record)]
        if not hit:
            raise InputError(f"{fault}: hits no record.")
        stream = _disturbed(stream, fault, hit)
    return stream


def _meant(fault: Fault, record: Record) -> bool:
    return fault.strikes(record.channel) and fault.active(record.time_ms)


def _disturbed(stream: list[Record], fault: Fault, hit: Sequence[int]) -> list[Record]:
    struck = set(hit)
    match fault.kind:
        case "duplicate":
            return [copy for number, record in enumerate(stream) for copy in [record] * (1 + (number in struck))]
        case "drop":
            return [record for number, record in enumerate(stream) if number not in struck]
        case "late":
            return _late(stream, KINDS.figure(fault, "reach"), struck)
        case "swap":
            return _swapped(stream, hit)
        case "freeze":
            return _frozen(stream, fault, hit)
        case _:
            return [_cross_talk(record, fault) if number in struck else record for number, record in enumerate(stream)]


def _late(stream: list[Record], reach: int, struck: set[int]) -> list[Record]:
    """Return the stream in order of delayed arrival."""
    due = [number + (reach + 0.5 if number in struck else 0) for number in range(len(stream))]
    return [stream[number] for number in sorted(range(len(stream)), key=due.__getitem__)]


def _swapped(stream: list[Record], hit: Sequence[int]) -> list[Record]:
    stream = list(stream)
    of_channel = [number for number, record in enumerate(stream) if record.channel == stream[hit[0]].channel]
    first, struck = of_channel.index(hit[0]), set(hit)
    for one, other in zip(of_channel[first::2], of_channel[first + 1 :: 2], strict=False):
        if one in struck:
            stream[one], stream[other] = stream[other], stream[one]
    return stream


def _frozen(stream: list[Record], fault: Fault, hit: Sequence[int]) -> list[Record]:
    before = [record for record in stream[: hit[0]] if fault.strikes(record.channel)]
    source = before[-1] if before else stream[hit[0]]
    frozen = {number: source.model_copy(update={"time_ms": stream[number].time_ms}) for number in hit}
    return [frozen.get(number, record) for number, record in enumerate(stream)]


def _cross_talk(record: Record, fault: Fault) -> Record:
    if not isinstance(record, MarkerRecord):
        raise InputError(f"cross-talk is a fault of marker readings, not of {record.channel}.")
    return record.model_copy(
        update={"marker": KINDS.figure(fault, "identity"), "position_mm": KINDS.figure(fault, "position_mm")}
    )
