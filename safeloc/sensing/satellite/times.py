"""GPS time: seconds since 1980-01-06 00:00:00, without leap seconds. A float resolves it to 0.3 microseconds."""

from __future__ import annotations

from datetime import datetime

from safeloc.sensing.satellite.figures import WEEK_S

_EPOCH = datetime(1980, 1, 6)


def gps_seconds(year: int, month: int, day: int, hour: int, minute: int, second: float) -> float:
    """Return GPS time of a calendar date in the GPS scale. ValueError for a date that does not exist."""
    return (datetime(year, month, day, hour, minute) - _EPOCH).total_seconds() + second


def of_week(week: int, second: float) -> float:
    """Return GPS time of a second of a (full, not rolled over) week."""
    return week * WEEK_S + second
