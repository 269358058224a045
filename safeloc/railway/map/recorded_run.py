"""Turns recorded positions of a train into records of odometers and balise readers along its route.

Each fix gives the nearest place on the route; successive places give the distances of the cycles and the balise groups
passed in between. So a recording without wheel speed can drive a machine: one odometry unit gets the straight distance
over ground from fix to fix, the other the distance along the track.

A recording has no true positions, and the receiver's own quality flags do not bound its error; only map and motion do. A fix
is trusted if it lies near the track and can be reached from the last trusted one at the vehicle's highest speed. Its
projected position then serves as the true one.
"""

from __future__ import annotations

import math
from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from itertools import pairwise
from pathlib import Path

from safeloc.errors import StreamError
from safeloc.language.units import NM_PER_MM
from safeloc.railway.map.elements import BaliseGroup
from safeloc.railway.map.projection import WGS84, Projector
from safeloc.railway.map.routes import Route
from safeloc.runtime.outside import quoted
from safeloc.runtime.streams.files import bounded, csv_rows, streaming
from safeloc.runtime.streams.records import DistanceRecord, End, MarkerRecord, Record, TruthRecord

_ENDS: tuple[End, End] = ("front", "rear")


@dataclass(frozen=True)
class Columns:
    """The columns of a log: time (ISO 8601), coordinates and their system, and the receiver's own quality flag."""

    time: str = "timestamp"
    x: str = "longitude"
    y: str = "latitude"
    status: str = "position_type"
    crs: str = WGS84


@dataclass(frozen=True)
class Fix:
    """One fix of the receiver: time since the first fix, coordinates, and its quality flag."""

    time_ms: int
    x: float
    y: float
    status: str


@dataclass(frozen=True)
class OnRoute:
    """A fix on the route: distance along it, distance from it, and straight distance from the previous fix."""

    time_ms: int
    position_mm: int
    offset_mm: int
    straight_mm: int | None
    status: str


@dataclass(frozen=True)
class Trust:
    """Limits for a trusted fix: distance off the track, and speed since the last trusted fix."""

    offset_limit_mm: int
    max_speed_mm_s: int


@dataclass(frozen=True)
class Reading:
    """Parameters of balise reading: the vehicle's length, and the default accuracy of a group."""

    length_mm: int
    accuracy_mm: int


def read_fixes(path: Path, columns: Columns | None = None) -> tuple[Fix, ...]:
    """Return all fixes of a CSV log. StreamError with file and line for a missing column, a time out of order or a wrong number."""
    with streaming(path):
        return _fixes(path, columns or Columns())


def _fixes(path: Path, at: Columns) -> tuple[Fix, ...]:
    table = bounded(path, csv_rows(path))
    _, names = next(table, (1, []))
    missing = {at.time, at.x, at.y, at.status} - set(names)
    if missing:
        raise StreamError(f"{path}:1: columns {sorted(missing)} are missing; it has {quoted(names)}.")
    rows = [(line, dict(zip(names, cells, strict=False))) for line, cells in table if cells]
    if not rows:
        raise StreamError(f"{path}: has no fixes.")
    start = _time(path, rows[0][0], rows[0][1].get(at.time))
    fixes = tuple(_fix(path, number, row, at, start) for number, row in rows)
    for (number, _), (before, after) in zip(rows[1:], pairwise(fixes), strict=True):
        if after.time_ms <= before.time_ms:
            raise StreamError(f"{path}:{number}: its time is not after that of the previous fix.")
    return fixes


def _fix(path: Path, number: int, row: dict[str, str], at: Columns, start: datetime) -> Fix:
    elapsed = _time(path, number, row.get(at.time)) - start
    x, y = (_coordinate(path, number, column, row.get(column)) for column in (at.x, at.y))
    return Fix(round(elapsed.total_seconds() * 1000), x, y, row.get(at.status, ""))


def _time(path: Path, number: int, text: str | None) -> datetime:
    """Read a time; one without a zone is UTC."""
    try:
        found = datetime.fromisoformat(text or "")
        return found if found.tzinfo is not None else found.replace(tzinfo=UTC)
    except ValueError as error:
        raise StreamError(f"{path}:{number}: {text!r} is no time (ISO 8601).") from error


def _coordinate(path: Path, number: int, column: str, text: str | None) -> float:
    try:
        value = float(text if text and text.isascii() and "_" not in text else "")
    except ValueError as error:
        raise StreamError(f"{path}:{number}: column {column!r}: {text!r} is no number.") from error
    if not math.isfinite(value):
        raise StreamError(f"{path}:{number}: column {column!r}: {text!r} is no finite number.")
    return value


# ------------------------------------------------------------------ on the route


def on_route(fixes: Sequence[Fix], route: Route, *, crs: str = WGS84) -> tuple[OnRoute, ...]:
    """Return each fix at the nearest place of the route; EngineError without the extra `geo`."""
    projector = Projector(route.topology.line, edges=[run.edge for run in route.runs])
    found: list[OnRoute] = []
    for number, fix in enumerate(fixes):
        projected = projector.project(fix.x, fix.y, crs=crs)
        before = fixes[number - 1] if number else None
        straight = projector.distance_mm((before.x, before.y), (fix.x, fix.y), crs=crs) if before else None
        position = _position(route, route.positions_of(projected.place), found)
        found.append(OnRoute(fix.time_ms, position, projected.offset_mm, straight, fix.status))
    return tuple(found)


def _position(route: Route, positions: Sequence[int], before: Sequence[OnRoute]) -> int:
    """Return the position on the route: of two (a loop) the one nearer to the previous, of none the nearer end of the route."""
    last = before[-1].position_mm if before else 0
    return min(positions or (0, route.length_mm), key=lambda position: abs(position - last))


def trusted_times(fixes: Iterable[OnRoute], trust: Trust) -> frozenset[int]:
    """Return the times of trusted fixes, which map and motion allow. The reach grows with the time since the last of them."""
    last: OnRoute | None = None
    times = set()
    for fix in fixes:
        if abs(fix.offset_mm) <= trust.offset_limit_mm and (last is None or _in_reach(last, fix, trust)):
            times.add(fix.time_ms)
            last = fix
    return frozenset(times)


def _in_reach(last: OnRoute, fix: OnRoute, trust: Trust) -> bool:
    run_mm, elapsed_ms = abs(fix.position_mm - last.position_mm), fix.time_ms - last.time_ms
    return run_mm * 1000 <= trust.max_speed_mm_s * elapsed_ms


# ------------------------------------------------------------------ as records


def odometer_records(fixes: Sequence[OnRoute], along: str, straight: str) -> Iterator[Record]:
    """Return distances of two units at both ends: `along` measures on the track, `straight` from fix to fix."""
    for before, after in pairwise(fixes):
        assert after.straight_mm is not None
        step = after.position_mm - before.position_mm
        forward = after.straight_mm if step >= 0 else -after.straight_mm
        for end in _ENDS:
            yield DistanceRecord(time_ms=after.time_ms, end=end, unit=straight, distance_mm=forward)
            yield DistanceRecord(time_ms=after.time_ms, end=end, unit=along, distance_mm=step)


def balise_records(
    fixes: Sequence[OnRoute], route: Route, how: Reading, trusted: Container[int]
) -> Iterator[MarkerRecord]:
    """Return the readings of the route's groups by the readers at both ends, between fixes at trusted times.

    The front reader is at the fix, the rear one a vehicle length behind. A group's identity is its NID_BG.
    """
    groups = [(met.position_mm, met.element) for met in route.objects() if isinstance(met.element, BaliseGroup)]
    for before, after in pairwise(fixes):
        if before.time_ms not in trusted or after.time_ms not in trusted:
            continue
        for end, behind in zip(_ENDS, (0, how.length_mm), strict=True):
            for place, group in groups:
                if before.position_mm < place + behind <= after.position_mm:
                    stated_mm = group.location_accuracy_mm
                    yield MarkerRecord(
                        time_ms=after.time_ms,
                        end=end,
                        marker=group.identity,
                        position_mm=place,
                        accuracy_mm=how.accuracy_mm if stated_mm is None else stated_mm,
                        since_mm=after.position_mm - place - behind,
                    )


def satellite_records(
    fixes: Sequence[OnRoute], accuracy_mm: Mapping[str, int], first_identity: int, trusted: Container[int] | None
) -> Iterator[MarkerRecord]:
    """Return the fixes as virtual markers at the front (MRK-D6), numbered from `first_identity`.

    accuracy_mm  accuracy by quality flag; a fix with another flag is not used
    trusted      times of the fixes to use; None: all, so that a false fix becomes a false marker, and the next false
                 one may confirm it
    """
    for number, fix in enumerate(fixes):
        if fix.status in accuracy_mm and (trusted is None or fix.time_ms in trusted):
            yield MarkerRecord(
                time_ms=fix.time_ms,
                end="front",
                marker=first_identity + number,
                position_mm=fix.position_mm,
                accuracy_mm=accuracy_mm[fix.status],
                since_mm=0,
            )


def truth_records(fixes: Iterable[OnRoute], trusted: Container[int]) -> Iterator[TruthRecord]:
    """Return the projected positions at trusted times."""
    for fix in fixes:
        if fix.time_ms in trusted:
            yield TruthRecord(time_ms=fix.time_ms, position_nm=fix.position_mm * NM_PER_MM)


def in_order(*streams: Iterable[Record]) -> list[Record]:
    """Return all records by time, at one time in the order of the streams, with at most one marker for each end and time."""
    records = sorted((record for stream in streams for record in stream), key=lambda record: record.time_ms)
    seen: set[tuple[int, str]] = set()
    kept: list[Record] = []
    for record in records:
        key = (record.time_ms, record.channel)
        if isinstance(record, MarkerRecord) and key in seen:
            continue
        seen.add(key)
        kept.append(record)
    return kept
