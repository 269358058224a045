"""Searches ahead and carries values along on all routes at once; the work grows with the line, not with its routes."""

from __future__ import annotations

import heapq
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import TypeAlias, TypeVar

import networkx as nx

from safeloc.railway.map.elements import BaliseGroup, Reflector
from safeloc.railway.map.model import Line
from safeloc.railway.map.places import Place, along
from safeloc.railway.map.routes import Inventory
from safeloc.railway.map.topology import Run, Topology

Reference: TypeAlias = BaliseGroup | Reflector
T = TypeVar("T")


@dataclass(frozen=True)
class Seen:
    """A reference ahead: its run, its offset into the run, and the distance to it."""

    element: Reference
    run: Run
    offset_mm: int
    distance_mm: int


class Walk:
    """A line with the references along every run in regular direction of travel."""

    def __init__(self, line: Line) -> None:
        self.line = line
        self.topology = Topology(line)
        self._inventory = Inventory(line)

    @cached_property
    def runs(self) -> list[Run]:
        """All runs of the line."""
        return list(self.topology.graph)

    @cached_property
    def references(self) -> dict[Run, list[tuple[int, Reference]]]:
        """For every run, its balise groups and the reflectors for its direction, with the distance from its start."""
        return {run: list(self._along(run)) for run in self.runs}

    def _along(self, run: Run) -> Iterator[tuple[int, Reference]]:
        for offset, element in self._inventory.along(run, self.topology.length_mm(run)):
            if isinstance(element, (BaliseGroup, Reflector)):
                yield offset, element

    def everywhere(self) -> Iterator[Seen]:
        """Yield every reference once for each direction in which vehicles pass it."""
        for run, there in self.references.items():
            for offset, element in there:
                yield Seen(element, run, offset, 0)

    def place(self, run: Run, offset_mm: int) -> Place:
        """Return the place at an offset into a run."""
        return Place(run.edge, along(run.direction, self.topology.length_mm(run), offset_mm))

    def ahead(self, run: Run, offset_mm: int, reach_mm: int) -> Iterator[Seen]:
        """Yield the references at or ahead of a place, each with its shortest distance, nearest run first."""
        for start, here in self.runs_ahead(run, offset_mm, reach_mm):
            for offset, element in self.references[here]:
                if 0 <= start + offset <= reach_mm:
                    yield Seen(element, here, offset, start + offset)

    def runs_ahead(self, run: Run, offset_mm: int, reach_mm: int) -> Iterator[tuple[int, Run]]:
        """Yield the run and those ahead of a place, each with the shortest distance to its start, nearest first."""
        queue = [(-offset_mm, run)]
        done: set[Run] = set()
        while queue:
            start, here = heapq.heappop(queue)
            if start > reach_mm:
                return
            if here in done:
                continue
            done.add(here)
            yield start, here
            for after in self.topology.after(here):
                heapq.heappush(queue, (start + self.topology.length_mm(here), after))

    def behind(self, run: Run, offset_mm: int, reach_mm: int) -> Iterator[Seen]:
        """Yield the references at or behind a place on the ways that lead to it, each with its shortest distance."""
        queue, done = [(offset_mm, run)], set[Run]()
        while queue:
            end, here = heapq.heappop(queue)
            if here in done or end - self.topology.length_mm(here) > reach_mm:
                continue
            done.add(here)
            for offset, element in reversed(self.references[here]):
                if 0 <= end - offset <= reach_mm:
                    yield Seen(element, here, offset, end - offset)
            for before in self.topology.before(here):
                heapq.heappush(queue, (end + self.topology.length_mm(before), before))

    def first_ahead(self, run: Run, offset_mm: int, reach_mm: int, wanted: Callable[[Reference], bool]) -> list[Seen]:
        """Return the first wanted reference at or ahead of a place on every route, within reach; each with its shortest distance."""
        found: list[Seen] = []
        queue, done = [(-offset_mm, run)], set[Run]()
        while queue:
            start, here = heapq.heappop(queue)
            if here in done or start > reach_mm:
                continue
            done.add(here)
            first = next((one for one in self.references[here] if start + one[0] >= 0 and wanted(one[1])), None)
            if first is None:
                ends = start + self.topology.length_mm(here)
                for after in self.topology.after(here):
                    heapq.heappush(queue, (ends, after))
            elif start + first[0] <= reach_mm:
                found.append(Seen(first[1], here, first[0], start + first[0]))
        return found


def carried(
    walk: Walk,
    entering: Callable[[Run], T],
    leaving: Callable[[Run], T | None],
    through: Callable[[Run, T], T],
    worst: Callable[[Iterable[T]], T],
) -> tuple[dict[Run, T], list[list[Run]]]:
    """Return the value at the start of every run, the worst of all routes to it, and the loops that never reset it.

    entering  the value with which a vehicle enters the map
    leaving   the value at the end of a run that resets it; None for a run that does not
    through   the value at the end of a run that does not reset it
    """
    graph = walk.topology.graph
    fresh = {run: leaving(run) for run in walk.runs}
    order: nx.DiGraph[Run] = nx.DiGraph()
    order.add_nodes_from(walk.runs)
    order.add_edges_from((run, after) for run, after in graph.edges if fresh[run] is None)
    loops = [sorted(part) for part in nx.strongly_connected_components(order) if len(part) > 1]
    looping = {run for loop in loops for run in loop}
    order.remove_nodes_from(looping)
    arriving: dict[Run, T] = {}
    for run in nx.topological_sort(order):
        ends = [
            _at_end(before, fresh, arriving, through) for before in graph.predecessors(run) if before not in looping
        ]
        arriving[run] = worst(ends) if ends else entering(run)
    return arriving, loops


def _at_end(run: Run, fresh: dict[Run, T | None], arriving: dict[Run, T], through: Callable[[Run, T], T]) -> T:
    anew = fresh[run]
    return through(run, arriving[run]) if anew is None else anew
