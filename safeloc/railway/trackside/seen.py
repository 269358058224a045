"""The report of a vehicle as an area reads it: where its train was, and when."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

from safeloc.errors import InputError
from safeloc.railway.trackside.wiring import VehicleWiring
from safeloc.runtime.outside import quoted
from safeloc.runtime.service.clock_lag import LATEST_MS
from safeloc.runtime.service.messages import json_object


class Seen(NamedTuple):
    """A report: end A was in [low_mm, high_mm] at `time_ms`; `whole`: nothing of the train was left behind then.

    low_mm and high_mm are None where the vehicle reports no position.
    """

    time_ms: int
    low_mm: int | None
    high_mm: int | None
    whole: bool = False


def read_report(vehicle: str, payload: bytes, wiring: VehicleWiring) -> Seen:
    """Return what a report says. InputError for anything that is no report of this vehicle along a line."""
    fields = json_object(payload)
    if fields.get("vehicle") != vehicle:
        raise InputError(f"a report of vehicle {quoted(fields.get('vehicle'))} under the topic of {vehicle}")
    time_ms = fields.get("time_ms")
    if type(time_ms) is not int or not 0 <= time_ms <= LATEST_MS:
        raise InputError(f"time_ms is {quoted(time_ms)}")
    if "interval_mm" not in fields:
        raise InputError("no interval_mm: this machine reports no place")
    if "track" in fields:
        raise InputError("an interval along an edge of the map: an area needs one along the line")
    interval = fields["interval_mm"]
    if interval is None:
        return Seen(time_ms, None, None)
    low, high = _ends(interval)
    return Seen(time_ms, low, high, _whole(fields.get("outputs"), wiring.whole))


def _ends(interval: object) -> tuple[int, int]:
    if isinstance(interval, list) and len(interval) == 2 and all(type(one) is int for one in interval):
        low, high = interval
        if low <= high:
            return low, high
    raise InputError(f"interval_mm is {quoted(interval)}; two places in order are expected")


def _whole(outputs: object, name: str | None) -> bool:
    if name is None:
        return False
    found: Mapping[str, Any] = outputs if isinstance(outputs, dict) else {}
    if type(found.get(name)) is not bool:
        raise InputError(f"no output {name} that is true or false, by which the train would be confirmed to be whole")
    return bool(found[name])
