"""Routes: sequences of directed edges, with positions along them and the elements that a vehicle passes."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import islice, pairwise
from typing import TypeAlias

import networkx as nx

from safeloc.errors import InputError
from safeloc.railway.map.elements import AxleCounter, BaliseGroup, Direction, Marker, Reflector, Signal, StopPoint
from safeloc.railway.map.model import Line
from safeloc.railway.map.places import Place, along
from safeloc.railway.map.topology import Passage, Run, Topology

Element: TypeAlias = BaliseGroup | Reflector | Marker | StopPoint | Signal | AxleCounter


@dataclass(frozen=True)
class Met:
    """An element that a vehicle passes: its distance along the route, and the run of the route there."""

    position_mm: int
    element: Element
    direction: Direction

    @property
    def nominal(self) -> bool | None:
        """For a balise group: whether it is passed in its nominal direction; None if unknown."""
        if not isinstance(self.element, BaliseGroup) or self.element.orientation is None:
            return None
        return self.element.orientation == self.direction


@dataclass(frozen=True)
class SwitchMet:
    """A switch on a route: its distance along the route, and its passage."""

    position_mm: int
    passage: Passage


class Inventory:
    """The elements on each edge, in order of position."""

    def __init__(self, line: Line) -> None:
        self._on: dict[str, list[Element]] = {}
        every: tuple[tuple[Element, ...], ...] = (
            line.balise_groups,
            line.reflectors,
            line.markers,
            line.stop_points,
            line.signals,
            line.axle_counters,
        )
        for elements in every:
            for element in elements:
                self._on.setdefault(element.edge, []).append(element)
        for there in self._on.values():
            there.sort(key=lambda element: element.position_mm)

    def along(self, run: Run, length_mm: int) -> Iterator[tuple[int, Element]]:
        """Yield the elements for vehicles in the direction of the run, each with its distance from the run's start."""
        there = self._on.get(run.edge, [])
        for element in there if run.direction == "increasing" else reversed(there):
            if getattr(element, "direction", run.direction) == run.direction:
                yield along(run.direction, length_mm, element.position_mm), element


@dataclass(frozen=True)
class Route:
    """A way along the line: legal successive runs, from `start_mm` into the first to `end_mm` into the last."""

    topology: Topology
    runs: tuple[Run, ...]
    start_mm: int
    end_mm: int

    def __post_init__(self) -> None:
        if not self.runs:
            raise InputError("a route needs at least one edge.")
        for run in self.runs:
            if run not in self.topology.graph:
                raise InputError(f"edge {run.edge!r} cannot be travelled in direction {run.direction}.")
        for before, after in pairwise(self.runs):
            if not self.topology.graph.has_edge(before, after):
                raise InputError(
                    f"from edge {before.edge!r} no vehicle can go to edge {after.edge!r}, {after.direction}."
                )
        first, last = self.topology.length_mm(self.runs[0]), self.topology.length_mm(self.runs[-1])
        if not (0 <= self.start_mm <= first and 0 <= self.end_mm <= last and self.length_mm >= 0):
            raise InputError(f"a route from {self.start_mm} mm to {self.end_mm} mm does not lie on its edges.")

    @cached_property
    def _starts(self) -> list[int]:
        """The distance along the route at the start of every run; negative for the first if the route begins within it."""
        starts = [-self.start_mm]
        for run in self.runs:
            starts.append(starts[-1] + self.topology.length_mm(run))
        return starts

    @property
    def length_mm(self) -> int:
        """Length from start to end."""
        return self._starts[-2] + self.end_mm

    def place(self, position_mm: int) -> Place:
        """Return the place at a distance along the route. InputError beyond its ends."""
        if not 0 <= position_mm <= self.length_mm:
            raise InputError(f"{position_mm} mm is not on a route of {self.length_mm} mm.")
        index = min(bisect_right(self._starts, position_mm), len(self.runs)) - 1
        run = self.runs[index]
        within = position_mm - self._starts[index]
        return Place(run.edge, along(run.direction, self.topology.length_mm(run), within))

    def positions_of(self, place: Place) -> list[int]:
        """Return the distances along the route at which it passes a place: none, one, or two (a turning loop)."""
        found = []
        for start, run in zip(self._starts, self.runs, strict=False):
            if run.edge == place.edge:
                found.append(start + along(run.direction, self.topology.length_mm(run), place.position_mm))
        return [position for position in found if 0 <= position <= self.length_mm]

    def objects(self, inventory: Inventory | None = None) -> Iterator[Met]:
        """Yield the elements that a vehicle passes, by distance, without reflectors, stop points and signals of the other
        direction."""
        known = Inventory(self.topology.line) if inventory is None else inventory
        for start, run in zip(self._starts, self.runs, strict=False):
            for within, element in known.along(run, self.topology.length_mm(run)):
                if 0 <= start + within <= self.length_mm:
                    yield Met(start + within, element, run.direction)

    def switches(self) -> Iterator[SwitchMet]:
        """Yield the switches of the route, in order."""
        for end, (before, after) in zip(self._starts[1:], pairwise(self.runs), strict=False):
            passage = self.topology.passage(before, after)
            if passage is not None:
                yield SwitchMet(end, passage)

    def models(self, inventory: Inventory | None = None) -> str:
        """Return the reflector models in order along the route, joined: `ADAB` (RFL-D6)."""
        met = (one.element for one in self.objects(inventory))
        return "".join(element.model for element in met if isinstance(element, Reflector))

    @property
    def name(self) -> str:
        """The names of the edges in order."""
        return " > ".join(run.edge for run in self.runs)


def through_routes(topology: Topology, most: int) -> list[Route]:
    """Return at most `most` routes from every entry of the map to every exit, no edge twice in the same direction."""
    exits = set(topology.exits())
    paths = (path for entry in topology.entries() for path in _paths(topology, entry, exits))
    return [Route(topology, path, 0, topology.length_mm(path[-1])) for path in islice(paths, most)]


def routes_between(topology: Topology, start: Place, end: Place, most: int = 1_000) -> list[Route]:
    """Return every route between two places, no edge twice in the same direction. InputError if there are more than `most`."""
    for place in (start, end):
        _on_map(topology, place)
    found = list(islice(_between(topology, start, end), most + 1))
    if len(found) > most:
        raise InputError(f"more than {most} routes lead from {start.edge!r} to {end.edge!r}; ask for a shorter way.")
    return found


def _on_map(topology: Topology, place: Place) -> None:
    if place.edge not in topology.edges:
        raise InputError(f"{topology.line.name} has no edge {place.edge!r}.")
    length = topology.edges[place.edge].length_mm
    if not 0 <= place.position_mm <= length:
        raise InputError(f"{place.position_mm} mm is not on edge {place.edge!r} of {length} mm.")


def _between(topology: Topology, start: Place, end: Place) -> Iterator[Route]:
    ends = {run for run in _on(topology, end)}
    for first in _on(topology, start):
        begun = along(first.direction, topology.length_mm(first), start.position_mm)
        for path in _paths(topology, first, ends):
            left = along(path[-1].direction, topology.length_mm(path[-1]), end.position_mm)
            if len(path) > 1 or left >= begun:
                yield Route(topology, path, begun, left)


def _on(topology: Topology, place: Place) -> list[Run]:
    both = (Run(place.edge, "increasing"), Run(place.edge, "decreasing"))
    return [run for run in both if run in topology.graph]


def _paths(topology: Topology, first: Run, ends: set[Run]) -> Iterator[tuple[Run, ...]]:
    if first in ends:
        yield (first,)
    others = ends - {first}
    if others:
        yield from (tuple(path) for path in nx.all_simple_paths(topology.graph, first, others))
