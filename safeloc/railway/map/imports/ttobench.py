"""Imports track data of TTOBench (JSON) as a line of one edge: length, speed limits, gradients, curves, tunnels.

Positions are decimal metres and become whole mm exactly. Stops are only noted, since a stop point needs a reflector, which
this format does not have. So are altitude, cross sections of tunnels, and braking data.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from itertools import pairwise
from pathlib import Path
from typing import Any

from safeloc.errors import InputError
from safeloc.railway.map.elements import Curve, Gradient, Node, SpeedLimit, Stretch, TrackEdge, Tunnel
from safeloc.railway.map.imports.building import made, within
from safeloc.railway.map.imports.json_text import mapping, others, read_object, required, sequence, text
from safeloc.railway.map.imports.lengths import decimal, millimetres
from safeloc.railway.map.imports.notes import Imported, Note
from safeloc.railway.map.model import Line

_KNOWN = ("metadata", "altitude", "stops", "speed limits", "gradients", "curvatures", "tunnels", "ETCS braking data")
EDGE = "track"


@dataclass(frozen=True)
class _Profile:
    """The content of the file, the length of its track, and the notes so far."""

    data: Mapping[str, Any]
    length_mm: int
    notes: list[Note]

    def rows(self, name: str, units: Mapping[str, str]) -> list[tuple[str, list[Any]]]:
        """Return the rows of a table with their places in the file; empty without the table. InputError for other units."""
        if name not in self.data:
            return []
        place = repr(name)
        table = mapping(self.data[name], place)
        stated = mapping(required(table, "units", place), f"{place}: units")
        if stated != units:
            raise InputError(f"{place}: units are {stated}; known are {dict(units)}.")
        rows = [sequence(row, f"{place} row {number}") for number, row in enumerate(_values(table, place), 1)]
        for number, row in enumerate(rows, 1):
            if len(row) != len(units):
                raise InputError(f"{place} row {number}: expected {', '.join(units)}, got {len(row)} values.")
        return [(f"{place} row {number}", row) for number, row in enumerate(rows, 1)]

    def position_mm(self, value: object, place: str) -> int:
        """Return a position or length in whole mm."""
        rounded, exact = millimetres(decimal(value, f"{place}: position"))
        if not exact:
            self.notes.append(Note("rounded", place, f"{value} m to {rounded} mm"))
        if not 0 <= rounded <= self.length_mm:
            raise InputError(f"{place}: {value} m lies outside the track of {self.length_mm} mm.")
        return rounded

    def pieces(self, name: str, units: Mapping[str, str]) -> Iterator[tuple[str, Stretch, list[Any]]]:
        """Yield the rows of a table of starting points, each with the stretch up to the next one."""
        rows = self.rows(name, units)
        starts = [self.position_mm(row[0], place) for place, row in rows]
        if rows and starts[0] != 0:
            raise InputError(f"{rows[0][0]}: the first position must be 0, not {rows[0][1][0]}.")
        for (place, row), (start, end) in zip(rows, pairwise([*starts, self.length_mm]), strict=True):
            if end <= start:
                raise InputError(f"{place}: positions must grow and stay below the length of the track.")
            yield place, made(Stretch, place, edge=EDGE, from_mm=start, to_mm=end), row[1:]


def read_ttobench(path: Path, *, name: str | None = None, version: str | None = None) -> Imported:
    """Return the line in a TTOBench track file.

    name, version  of the line; by default the identity in the metadata, and "1"
    Raises InputError with table and row for anything wrong in it.
    """
    with within(path):
        return _imported(read_object(path), name, version or "1", path.name)


def _imported(data: Mapping[str, Any], name: str | None, version: str, source: str) -> Imported:
    metadata = mapping(required(data, "metadata", "file"), "'metadata'")
    profile = _Profile(data, _length_mm(data), [])
    line = made(
        Line,
        "file",
        name=name or text(required(metadata, "id", "'metadata'"), "'metadata': id"),
        version=version,
        source="; ".join([source, *(f"{key}: {value}" for key, value in metadata.items() if key != "id")]),
        nodes=(Node(id="begin", kind="border"), Node(id="end", kind="border")),
        edges=(made(TrackEdge, "'stops'", id=EDGE, from_node="begin", to_node="end", length_mm=profile.length_mm),),
        tunnels=tuple(_tunnels(profile)),
        speed_limits=tuple(_speed_limits(profile)),
        gradients=tuple(_gradients(profile)),
        curves=tuple(_curves(profile)),
    )
    return Imported(line, (*profile.notes, *_left(data)))


def _values(table: Mapping[str, Any], place: str) -> list[Any]:
    return sequence(required(table, "values", place), f"{place}: values")


def _length_mm(data: Mapping[str, Any]) -> int:
    """Return the position of the last stop, which is the end of the track."""
    place = "'stops'"
    table = mapping(required(data, "stops", "file"), place)
    if table.get("unit") != "m":
        raise InputError(f"{place}: unit is {table.get('unit')!r}; known is 'm'.")
    stops = [decimal(value, f"{place} row {number}") for number, value in enumerate(_values(table, place), 1)]
    if len(stops) < 2 or stops[0] != 0 or any(after <= before for before, after in pairwise(stops)):
        raise InputError(f"{place}: stops begin at 0 and grow; the last one ends the track.")
    rounded, exact = millimetres(stops[-1])
    if not exact:
        raise InputError(f"{place}: the length {stops[-1]} m is no whole number of mm.")
    return rounded


def _speed_limits(profile: _Profile) -> Iterator[SpeedLimit]:
    """Yield speed limits, rounded down to whole mm/s."""
    for place, stretch, (speed,) in profile.pieces("speed limits", {"position": "m", "velocity": "km/h"}):
        limit = int(decimal(speed, f"{place}: velocity") * 1_000_000 / 3_600)
        yield made(SpeedLimit, place, **stretch.model_dump(), max_speed_mm_s=limit)


def _gradients(profile: _Profile) -> Iterator[Gradient]:
    for place, stretch, (slope,) in profile.pieces("gradients", {"position": "m", "slope": "permil"}):
        ppm = decimal(slope, f"{place}: slope") * 1_000
        rounded = ppm.to_integral_value()
        if rounded != ppm:
            profile.notes.append(Note("rounded", place, f"slope {slope} per mille to {rounded} ppm"))
        yield made(Gradient, place, **stretch.model_dump(), rise_ppm=int(rounded))


def _curves(profile: _Profile) -> Iterator[Curve]:
    units = {"position": "m", "radius at start": "m", "radius at end": "m"}
    for place, stretch, radii in profile.pieces("curvatures", units):
        one, other = (_radius_mm(profile, radius, place) for radius in radii)
        yield made(Curve, place, **stretch.model_dump(), from_radius_mm=one, to_radius_mm=other)


def _radius_mm(profile: _Profile, value: object, place: str) -> int | None:
    if value == "infinity":
        return None
    radius: Decimal = decimal(value, f"{place}: radius")
    rounded, exact = millimetres(radius)
    if rounded == 0:
        raise InputError(f"{place}: a radius cannot be {value} m.")
    if not exact:
        profile.notes.append(Note("rounded", place, f"radius {value} m to {rounded} mm"))
    return rounded


def _tunnels(profile: _Profile) -> Iterator[Tunnel]:
    rows = profile.rows("tunnels", {"position": "m", "length": "m", "cross section": "m^2"})
    for number, (place, (position, length, section)) in enumerate(rows, 1):
        start = profile.position_mm(position, place)
        end = profile.position_mm(decimal(position, place) + decimal(length, place), place)
        if end <= start:
            raise InputError(f"{place}: a tunnel of {length} m has no length.")
        stretch = made(Stretch, place, edge=EDGE, from_mm=start, to_mm=end)
        profile.notes.append(Note("not carried over", place, f"cross section {section} m2"))
        yield made(Tunnel, place, id=f"tunnel {number}", stretches=(stretch,))


def _left(data: Mapping[str, Any]) -> Iterator[Note]:
    stops: Sequence[Any] = data["stops"]["values"]
    for number, stop in enumerate(stops, 1):
        remark = "a stop point needs a reflector; the file knows none"
        yield Note("not carried over", f"'stops' row {number} at {stop} m", remark)
    for name in ("altitude", "ETCS braking data"):
        if name in data:
            yield Note("not carried over", repr(name), "the map has no place for it")
    for name in others(data, _KNOWN):
        yield Note("not understood", repr(name), "unknown member")
