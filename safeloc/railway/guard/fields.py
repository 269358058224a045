"""Fields of a position stream as numbers. Every line becomes a delivery; one that is not a position carries the reason."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from decimal import Decimal

from safeloc.errors import InputError
from safeloc.railway.guard.deliveries import SPEED_UNITS, Delivery
from safeloc.runtime.outside import quoted, refusal

_EPOCH = datetime(1970, 1, 1, tzinfo=UTC)
_TIME_UNITS = {"ms": 1, "s": 1_000}
_FASTEST_MM_S = 1_000_000
_LONGEST_TIME_MS = 10**15
_NAMES = ("time", "x", "y", "speed", "flag", "received")


@dataclass(frozen=True)
class Columns:
    """The names of the fields of a line; an empty name: the stream has no such field.

    time, received  ISO 8601 (UTC without a time zone) or a number of `time_unit`
    x, y            longitude and latitude, or easting and northing of the coordinate system
    speed           over ground, in `speed_unit`
    flag            the receiver's own quality flag; lines with one of `no_fix` have no position
    """

    time: str = "timestamp"
    x: str = "longitude"
    y: str = "latitude"
    speed: str = ""
    flag: str = ""
    received: str = ""
    time_unit: str = "ms"
    speed_unit: str = "m/s"
    no_fix: frozenset[str] = frozenset()

    def __post_init__(self) -> None:
        if self.time_unit not in _TIME_UNITS:
            raise InputError(f"time unit {self.time_unit!r}: choose one of {', '.join(_TIME_UNITS)}.")
        if self.speed_unit not in SPEED_UNITS:
            raise InputError(f"speed unit {self.speed_unit!r}: choose one of {', '.join(SPEED_UNITS)}.")

    @property
    def named(self) -> list[str]:
        """The names of all fields that the stream has to have."""
        return [name for name in (self.time, self.x, self.y, self.speed, self.flag, self.received) if name]


def columns_of(number: Collection[str], *, time_unit: str, speed_unit: str, no_fix: Collection[str]) -> Columns:
    """Return columns from `what=name`, such as `x=lambert72_x`; InputError for any other form."""
    chosen: dict[str, str] = {}
    for one in number:
        what, _, name = one.partition("=")
        if what not in _NAMES or not name:
            raise InputError(f"column {one!r}: expected WHAT=NAME, where WHAT is one of {', '.join(_NAMES)}.")
        if what in chosen:
            raise InputError(f"column {what!r} is given twice.")
        chosen[what] = name
    return Columns(**chosen, time_unit=time_unit, speed_unit=speed_unit, no_fix=frozenset(no_fix))


def delivery(number: int, fields: Mapping[str, object], columns: Columns) -> Delivery:
    """Return a line's fields as a delivery; `wrong` describes what cannot be read."""
    try:
        return _delivery(number, fields, columns)
    except Exception as error:  # the rule of every border (safeloc.runtime.outside)
        return Delivery(number, wrong=refusal(error))


def _delivery(number: int, fields: Mapping[str, object], columns: Columns) -> Delivery:
    def of(name: str, read: Callable[[str, object], object]) -> object:
        return read(name, fields.get(name)) if name and not _empty(fields.get(name)) else None

    time_ms = of(columns.time, lambda name, value: milliseconds(name, value, columns.time_unit))
    if time_ms is None:
        raise InputError(f"{columns.time!r} is empty.")
    received = of(columns.received, lambda name, value: milliseconds(name, value, columns.time_unit))
    flag = str(fields.get(columns.flag) or "") if columns.flag else ""
    speed = of(columns.speed, lambda name, value: speed_mm_s(name, value, columns.speed_unit))
    x, y = of(columns.x, _decimal), of(columns.y, _decimal)
    if flag in columns.no_fix or x is None or y is None:
        x = y = None
    assert isinstance(time_ms, int)
    assert isinstance(received, int | None) and isinstance(speed, int | None)
    assert isinstance(x, float | None) and isinstance(y, float | None)
    return Delivery(number, time_ms, x, y, speed, flag, received)


def _empty(value: object) -> bool:
    return value is None or (isinstance(value, str) and not value.strip())


def _decimal(name: str, value: object) -> float:
    """Return a number as it was written, NaN and infinities included; InputError if it is not a number."""
    if isinstance(value, bool) or not isinstance(value, (int, float, str)):
        raise InputError(f"{name!r}: {quoted(value)} is no number.")
    if isinstance(value, str) and not (value.isascii() and "_" not in value):
        raise InputError(f"{name!r}: {quoted(value)} is no number in ASCII digits.")
    try:
        return float(value)
    except (ValueError, OverflowError) as error:
        raise InputError(f"{name!r}: {quoted(value)} is no number.") from error


def speed_mm_s(name: str, value: object, unit: str) -> int:
    """Return a speed over ground in mm/s, to the nearest; InputError for a speed that no vehicle reaches."""
    speed = _decimal(name, value) * SPEED_UNITS[unit]
    if not 0 <= speed <= _FASTEST_MM_S:
        raise InputError(f"{name!r}: {quoted(value)} {unit} is no speed over ground.")
    return round(speed)


def milliseconds(name: str, value: object, unit: str) -> int:
    """Return a time in ms since 1970, or since the start of the receiver's own count; rounded down."""
    if isinstance(value, str) and ("-" in value.strip()[1:] and ":" in value):
        return _since_epoch(name, value)
    number = _decimal(name, value)
    if not math.isfinite(number) or abs(number) * _TIME_UNITS[unit] > _LONGEST_TIME_MS:
        raise InputError(f"{name!r}: {quoted(value)} is no time.")
    exact = Decimal(value.strip() if isinstance(value, str) else number)
    return math.floor(exact * _TIME_UNITS[unit])


def _since_epoch(name: str, text: str) -> int:
    try:
        when = datetime.fromisoformat(text.strip())
    except (ValueError, OverflowError) as error:
        raise InputError(f"{name!r}: {quoted(text)} is no time (ISO 8601).") from error
    return milliseconds_of(when)


def milliseconds_of(when: datetime) -> int:
    """Return ms since 1970; a time without a zone is UTC."""
    aware = when if when.tzinfo is not None else when.replace(tzinfo=UTC)
    return (aware - _EPOCH) // timedelta(milliseconds=1)
