"""The border (input validation): each raw measurement is admitted, or becomes a fault with a reason.

Nothing is clipped or replaced.

    reading -> Admitted(value)   the unchanged value: a whole number in the channel's range (3.0 is 3), fresh and new
            -> Fault(reason)     WRONG_TYPE, NOT_FINITE, OUT_OF_RANGE, STALE, FUTURE, DUPLICATE, OUT_OF_ORDER, SURPLUS,
                                 MISSING, LOST, UNKNOWN

A machine gets admitted values by name; a faulty input is absent, so inputs have to be optional. `Deliveries` checks the
time of a measurement, `admitted` its value; `Border` (for a host) and the cycle builder use both.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum

from safeloc.errors import InputError
from safeloc.language.expr import Optional
from safeloc.language.machine import Machine


class Reason(Enum):
    """Reasons for which a measurement is not admitted."""

    WRONG_TYPE = "not a whole number"
    NOT_FINITE = "NaN or infinite"
    OUT_OF_RANGE = "outside the channel's range"
    STALE = "older than the channel allows"
    FUTURE = "time stamp in the future"
    DUPLICATE = "already delivered"
    OUT_OF_ORDER = "older than the last one delivered"
    SURPLUS = "second value in a step that takes one"
    MISSING = "nothing or too little was delivered"
    LOST = "data may have been lost"
    UNKNOWN = "no channel of this machine"


@dataclass(frozen=True)
class Channel:
    """One measured quantity: whole numbers from `low` to `high` in `unit`, usable up to `max_age_ms`."""

    name: str
    unit: str
    low: int
    high: int
    max_age_ms: int


@dataclass(frozen=True)
class Raw:
    """A raw measurement: any value, taken at `time_ms`, numbered by its sender (WRONG_TYPE if not whole).

    If a sender does not number its measurements, `sequence` is None, and only the time shows which one is newer.
    """

    value: object
    time_ms: int
    sequence: int | None = None


@dataclass(frozen=True)
class Admitted:
    """An admitted value, unchanged."""

    value: int


@dataclass(frozen=True)
class Fault:
    """A measurement that is not admitted. `number` is the place of the record in its stream (from 0), if it has one."""

    channel: str
    reason: Reason
    detail: str = ""
    number: int | None = None


class Deliveries:
    """A check of the time and order of measurements, with the newest one of each channel as its memory.

    A measurement that is newer than the last one is remembered, whether it is admitted or not: a fault does not make an older
    measurement new again. One with a time in the future is not remembered: a single wrong clock value would otherwise block
    the channel.

    last   the complete memory: channel -> time and sequence number of its newest measurement
    """

    def __init__(self) -> None:
        self.last: dict[str, tuple[int, int | None]] = {}

    def fault(self, name: str, raw: Raw, now_ms: int, max_age_ms: int) -> Fault | None:
        """Return the fault in the time or number of a measurement; None if it is new and in time."""
        return self.late(name, raw.time_ms, raw.sequence, now_ms, max_age_ms)

    def late(self, name: str, time_ms: int, sequence: int | None, now_ms: int, max_age_ms: int) -> Fault | None:
        """Return the fault in a time and a sequence number; None if they are new and in time."""
        if type(time_ms) is not int or (sequence is not None and type(sequence) is not int):
            return Fault(name, Reason.WRONG_TYPE, "time or sequence")
        if time_ms > now_ms:
            return Fault(name, Reason.FUTURE, f"{time_ms - now_ms} ms ahead")
        last = self.last.get(name)
        order = None if last is None else _order(*last, time_ms, sequence)
        if order is not None:
            return Fault(name, order, f"at {time_ms} ms" + ("" if sequence is None else f", number {sequence}"))
        self.last[name] = (time_ms, sequence)
        if now_ms - time_ms > max_age_ms:
            return Fault(name, Reason.STALE, f"{now_ms - time_ms} ms old, {max_age_ms} ms allowed")
        return None


def _order(last_ms: int, last_number: int | None, time_ms: int, number: int | None) -> Reason | None:
    """Return the reason if a measurement is not newer than the last one, else None."""
    if time_ms > last_ms and (number is None or last_number is None or number > last_number):
        return None
    return Reason.DUPLICATE if (time_ms, number) == (last_ms, last_number) else Reason.OUT_OF_ORDER


class Border:
    """A check of the time and value of each measurement, for a host with channels of its own.

    deliveries   the complete memory of this border
    """

    def __init__(self, channels: Sequence[Channel]) -> None:
        self._channels = {channel.name: channel for channel in channels}
        if len(self._channels) != len(channels):
            raise InputError(f"channels need distinct names; got {[channel.name for channel in channels]}.")
        self.deliveries = Deliveries()

    def judge(self, name: str, raw: Raw | None, now_ms: int) -> Admitted | Fault:
        """Check one measurement (None: nothing was delivered). InputError for an unknown channel."""
        if name not in self._channels:
            raise InputError(f"no channel {name!r}; there are {sorted(self._channels)}.")
        channel = self._channels[name]
        if raw is None:
            return Fault(name, Reason.MISSING)
        fault = self.deliveries.fault(name, raw, now_ms, channel.max_age_ms)
        return admitted(channel, raw.value) if fault is None else fault

    def inputs(self, readings: Mapping[str, Raw], now_ms: int) -> tuple[dict[str, int], list[Fault]]:
        """Return a step's inputs by name, faulty ones absent, and every fault (missing channels among them)."""
        unknown = sorted(set(readings) - set(self._channels))
        if unknown:
            raise InputError(f"no channel {unknown[0]!r}; there are {sorted(self._channels)}.")
        values: dict[str, int] = {}
        faults: list[Fault] = []
        for name in self._channels:
            checked = self.judge(name, readings.get(name), now_ms)
            if isinstance(checked, Admitted):
                values[name] = checked.value
            else:
                faults.append(checked)
        return values, faults


def admitted(channel: Channel, value: object) -> Admitted | Fault:
    """Return the measured value if it is a whole number in the channel's range, else a Fault.

    The check uses the object's real type; methods of a subclass are not called.
    """
    integer: int
    if issubclass(type(value), float):
        assert isinstance(value, float)
        if not math.isfinite(value):
            return Fault(channel.name, Reason.NOT_FINITE, float.__repr__(value))
        if not float.is_integer(value):
            return Fault(channel.name, Reason.WRONG_TYPE, float.__repr__(value))
        integer = float.__int__(value)
    elif issubclass(type(value), int) and type(value) is not bool:
        assert isinstance(value, int)
        integer = int.__add__(value, 0)
    else:
        return Fault(channel.name, Reason.WRONG_TYPE, type(value).__name__)
    if integer < channel.low:
        return Fault(channel.name, Reason.OUT_OF_RANGE, f"below {channel.low} {channel.unit}")
    if integer > channel.high:
        return Fault(channel.name, Reason.OUT_OF_RANGE, f"above {channel.high} {channel.unit}")
    return Admitted(integer)


def channels_of(machine: Machine, max_age_ms: int) -> list[Channel]:
    """Return a channel for every optional input of a machine, with its unit and range."""
    return [
        Channel(item.value.name, item.value.unit.name, item.value.low, item.value.high, max_age_ms)
        for item in machine.inputs
        if isinstance(item, Optional)
    ]
