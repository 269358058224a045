"""Readers of the guard's inputs: the line, the vehicle's route on it, and the stream of positions."""

from __future__ import annotations

import io
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Literal

from safeloc.errors import InputError
from safeloc.railway.guard.deliveries import Delivery
from safeloc.railway.guard.fields import Columns
from safeloc.railway.guard.nmea import nmea_deliveries
from safeloc.railway.guard.streams import csv_deliveries, jsonl_deliveries
from safeloc.railway.map.imports.formats import SUFFIXES, importer
from safeloc.railway.map.imports.geojson_path import read_path, route_over
from safeloc.railway.map.model import Line
from safeloc.railway.map.routes import Route
from safeloc.railway.map.toml_files import find_line
from safeloc.railway.map.topology import Topology

_FORMATS = {".csv": "csv", ".jsonl": "jsonl", ".ndjson": "jsonl", ".nmea": "nmea", ".txt": "nmea"}
Direction = Literal["increasing", "decreasing"]


@dataclass(frozen=True)
class Way:
    """The vehicle's route, if known: a file with its edges, or the edges themselves; `first`: direction along the first edge."""

    path: Path | None = None
    edges: str | None = None
    first: Direction | None = None


def line_of(name: str) -> Line:
    """Load a line from TOML, JSON, GeoJSON or railML, by its suffix, or a shipped one by its name.

    Raises InputError for a map of which elements are refused: whether it serves without them is for its owner to say.
    """
    path = Path(name)
    if path.suffix.lower() not in SUFFIXES:
        return find_line(name)
    imported = importer(path)(path)
    if imported.refused:
        raise InputError(
            f"{path}: {len(imported.refused)} elements are wrong and left out; the first: {imported.refused[0]}. "
            f"Convert it with safeloc import, read the notes, and give the line that it writes."
        )
    return imported.line


def route_of(line: Line, way: Way) -> Route | None:
    """Return the route on the line; None if none is given."""
    if way.path is not None and way.edges is not None:
        raise InputError("the route is given twice; give either --path or --edges.")
    topology = Topology(line)
    if way.path is not None:
        return read_path(way.path, topology, first=way.first).route
    if way.edges is None:
        return None
    return route_over([edge.strip() for edge in way.edges.split(",")], topology, first=way.first)


def form_of(stream: str, form: str | None) -> str:
    """Return csv, jsonl or nmea: `form` if it is given, else from the suffix. InputError if neither decides."""
    chosen = _FORMATS.get(Path(stream).suffix.lower()) if form is None else form
    if chosen is None or chosen not in _FORMATS.values():
        raise InputError(
            f"{stream}: {'its suffix is no known format' if form is None else form!r}; name csv, jsonl or nmea."
        )
    return chosen


def deliveries(lines: IO[str], form: str, columns: Columns, sentence: str, name: str) -> Iterator[Delivery]:
    """Return the deliveries of a stream, each as soon as its line is read."""
    match form:
        case "csv":
            return csv_deliveries(lines, columns, name)
        case "jsonl":
            return jsonl_deliveries(lines, columns)
        case _:
            return nmea_deliveries(lines, sentence)


@contextmanager
def opened(stream: str) -> Iterator[IO[str]]:
    """Open a stream as text; `-` is standard input. Bytes that are not UTF-8 become a character that no number contains."""
    if stream == "-":
        yield io.TextIOWrapper(sys.stdin.buffer, encoding="utf-8-sig", errors="replace", newline="")
        return
    try:
        file = Path(stream).open(encoding="utf-8-sig", errors="replace", newline="")  # noqa: SIM115
    except OSError as error:
        raise InputError(f"{stream}: cannot be read: {error.strerror}.") from error
    with file:
        yield file
