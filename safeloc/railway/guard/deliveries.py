"""Deliveries of a receiver: positions in the order of arrival, or the reason why there is none."""

from __future__ import annotations

from dataclasses import dataclass

_KNOT_MM_S = 1852 * 1000 / 3600
SPEED_UNITS = {"m/s": 1000.0, "km/h": 1000 / 3.6, "mm/s": 1.0, "knots": _KNOT_MM_S}
"""Unit -> mm/s in one of it."""


@dataclass(frozen=True)
class Delivery:
    """One line of a stream.

    number       its line, counted from 1
    time_ms      time of the fix in ms of the receiver's own clock, rounded down; None: no fix
    x, y         coordinates as the receiver reports them, unchecked; None: no fix
    speed_mm_s   the receiver's own speed over ground; None if it reports none
    flag         the receiver's own quality flag: reported on, never used
    received_ms  time of arrival on the same clock; None if it was not recorded
    wrong        the reason why the line is not a position; empty if it is one
    """

    number: int
    time_ms: int | None = None
    x: float | None = None
    y: float | None = None
    speed_mm_s: int | None = None
    flag: str = ""
    received_ms: int | None = None
    wrong: str = ""
