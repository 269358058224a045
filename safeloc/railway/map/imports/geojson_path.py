"""Imports recorded paths as GeoJSON: the elements that a vehicle ran over, in order, as a route on the network (RFL-D6).

Each feature names an element and the piece of it that was run over, as shares of its length. The file has no direction; it
follows from the order of the elements. `gnss_start_index` and `gnss_end_index` are the rows of the log on the element.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from decimal import Decimal
from itertools import groupby
from pathlib import Path
from typing import NamedTuple

from safeloc.errors import InputError
from safeloc.railway.map.elements import Direction
from safeloc.railway.map.imports.building import within
from safeloc.railway.map.imports.geojson import Feature, read_features
from safeloc.railway.map.imports.json_text import others, required, text
from safeloc.railway.map.imports.lengths import decimal
from safeloc.railway.map.imports.notes import Note
from safeloc.railway.map.routes import Route
from safeloc.railway.map.topology import Run, Topology

_KNOWN = ("netelement_id", "start_intrinsic", "end_intrinsic", "gnss_start_index", "gnss_end_index", "probability")
_BOTH: tuple[Direction, Direction] = ("increasing", "decreasing")


class ImportedPath(NamedTuple):
    """A route over whole elements, and the notes on its import."""

    route: Route
    notes: tuple[Note, ...]


def read_path(path: Path, topology: Topology, *, first: Direction | None = None) -> ImportedPath:
    """Return the route in a path file, over the whole of its first and last element.

    first  direction along the first element, needed if the order of the elements does not determine it
    Raises InputError for unknown elements, for an order that no vehicle can run, and for an undetermined direction.
    """
    notes: list[Note] = []
    with within(path):
        edges = [_edge(feature, topology, notes) for feature in read_features(path, notes)]
        if not edges:
            raise InputError("names no element.")
        for edge, times in _repeated(edges):
            notes.append(Note("assumed", f"element {edge!r}", f"named {times} times in a row; it is run over once"))
        return ImportedPath(route_over(edges, topology, first=first), tuple(notes))


def route_over(edges: Sequence[str], topology: Topology, *, first: Direction | None = None) -> Route:
    """Return the route that runs over these edges in this order; an edge named several times in a row is run over once.

    Raises InputError if there is no such route, or more than one.
    """
    edges = [edge for edge, _ in groupby(edges)]
    for edge in edges:
        if edge not in topology.edges:
            raise InputError(f"the network has no element {edge!r}.")
    starts: Sequence[Direction] = _BOTH if first is None else (first,)
    layers = list(_layers(edges, starts, topology))
    if not layers[-1]:
        end = len(layers)
        raise InputError(f"no vehicle can run over {', '.join(map(repr, edges[max(0, end - 3) : end]))} in this order.")
    if len(layers[-1]) > 1 or any(way.several for way in layers[-1].values()):
        raise InputError(f"the direction along {edges[0]!r} is unknown; give it as increasing or decreasing.")
    runs = _back(layers)
    return Route(topology, runs, 0, topology.length_mm(runs[-1]))


def _repeated(edges: Sequence[str]) -> Iterator[tuple[str, int]]:
    """Yield each edge that is named several times in a row, with the number: a program may name it for every stretch of a log."""
    for edge, same in groupby(edges):
        times = len(list(same))
        if times > 1:
            yield edge, times


class _Way(NamedTuple):
    """The way to a run: the previous run (None for the first), and whether there are several ways."""

    before: Run | None
    several: bool = False


def _layers(edges: Sequence[str], starts: Sequence[Direction], topology: Topology) -> Iterator[Mapping[Run, _Way]]:
    """Yield the reachable runs for each edge, up to the first edge without any; the work is linear in the edges."""
    reached = {Run(edges[0], start): _Way(None) for start in starts if Run(edges[0], start) in topology.graph}
    yield reached
    for edge in edges[1:]:
        if not reached:
            return
        before, reached = reached, {}
        for run, way in before.items():
            for after in topology.after(run):
                if after.edge == edge:
                    reached[after] = _Way(run, way.several or after in reached)
        yield reached


def _back(layers: Sequence[Mapping[Run, _Way]]) -> tuple[Run, ...]:
    """Return the only way through the layers."""
    run = next(iter(layers[-1]))
    runs = [run]
    for layer in reversed(layers):
        before = layer[run].before
        if before is not None:
            runs.append(run := before)
    return tuple(reversed(runs))


def _edge(feature: Feature, topology: Topology, notes: list[Note]) -> str:
    for name in others(feature.properties, _KNOWN):
        notes.append(Note("not understood", feature.place, f"property {name!r}"))
    if any(share in feature.properties for share in _KNOWN[1:5]):
        notes.append(
            Note(
                "not carried over",
                feature.place,
                "shares run over and rows of the log; the route is over whole elements",
            )
        )
    name = required(feature.properties, "netelement_id", feature.place)
    edge = text(name, f"{feature.place}: netelement_id")
    if edge not in topology.edges:
        raise InputError(f"{feature.place}: the network has no element {edge!r}.")
    probability = feature.properties.get("probability")
    if probability is not None and decimal(probability, f"{feature.place}: probability") < Decimal(1):
        notes.append(
            Note("not carried over", feature.place, f"probability {probability}; the element counts as run over")
        )
    return edge
