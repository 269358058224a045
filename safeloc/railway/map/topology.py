"""Graph of the possible movements: directed edges, joined by legal passages at nodes, switches and crossings."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import networkx as nx

from safeloc.railway.map.elements import Direction, Switch, TrackEdge, opposite
from safeloc.railway.map.model import Line


@dataclass(frozen=True, order=True)
class Run:
    """An edge with a direction of travel."""

    edge: str
    direction: Direction

    @property
    def back(self) -> Run:
        """The same edge in the other direction."""
        return Run(self.edge, opposite(self.direction))


@dataclass(frozen=True)
class Passage:
    """The passage of a switch: from the stem to a branch (`facing`), or the reverse."""

    switch: Switch
    facing: bool
    branch: str

    @property
    def side(self) -> str:
        """The side of the branch: left or right."""
        return "left" if self.branch == self.switch.left else "right"


class Topology:
    """The graph of a line, without movements that switches and crossings forbid and without runs against `travel`."""

    def __init__(self, line: Line) -> None:
        self.line = line
        self.edges: dict[str, TrackEdge] = {edge.id: edge for edge in line.edges}
        self.switches: dict[str, Switch] = {switch.node: switch for switch in line.switches}
        self._movements = {one.node: {frozenset(pair) for pair in one.movements} for one in line.crossings}
        self._kinds = {node.id: node.kind for node in line.nodes}

    @cached_property
    def graph(self) -> nx.DiGraph[Run]:
        """Runs as nodes, legal movements as arcs."""
        graph: nx.DiGraph[Run] = nx.DiGraph()
        runs = [run for edge in self.edges.values() for run in _runs(edge)]
        graph.add_nodes_from(runs)
        leaving: dict[str, list[Run]] = {}
        for run in runs:
            leaving.setdefault(self.start(run), []).append(run)
        for run in runs:
            node = self.end(run)
            graph.add_edges_from((run, to) for to in leaving.get(node, ()) if self._may_go(node, run.edge, to.edge))
        return graph

    def _may_go(self, node: str, before: str, after: str) -> bool:
        if before == after:
            return False
        if node in self.switches:
            return self.switches[node].stem in (before, after)
        if node in self._movements:
            return frozenset((before, after)) in self._movements[node]
        return True

    def start(self, run: Run) -> str:
        """Return the node where a run begins."""
        edge = self.edges[run.edge]
        return edge.from_node if run.direction == "increasing" else edge.to_node

    def end(self, run: Run) -> str:
        """Return the node where a run ends."""
        return self.start(run.back)

    def after(self, run: Run) -> list[Run]:
        """List the next runs of a vehicle, in the order of the map."""
        return list(self.graph.successors(run))

    def before(self, run: Run) -> list[Run]:
        """List the runs from which a vehicle may come."""
        return list(self.graph.predecessors(run))

    def passage(self, before: Run, after: Run) -> Passage | None:
        """Return the passage of the switch between two successive runs; None without one."""
        switch = self.switches.get(self.end(before))
        if switch is None:
            return None
        facing = before.edge == switch.stem
        return Passage(switch, facing, after.edge if facing else before.edge)

    def course(self, passage: Passage) -> str:
        """Return the course of a passage as seen from the stem: STRAIGHT, LEFT or RIGHT.

        Straight on is the branch with the stem's track name, or the only branch with a track name.
        """
        switch = passage.switch
        tracks = {name: self.edges[branch].track for name, branch in (("left", switch.left), ("right", switch.right))}
        stem = self.edges[switch.stem].track
        straight = [name for name, track in tracks.items() if track and track == stem]
        straight = straight or [name for name, track in tracks.items() if track]
        return "STRAIGHT" if straight == [passage.side] else passage.side.upper()

    def entries(self) -> Iterator[Run]:
        """Yield the runs on which vehicles enter the map: no run leads into them."""
        return (run for run in self.graph if self.graph.in_degree(run) == 0)

    def exits(self) -> Iterator[Run]:
        """Yield the runs on which vehicles leave the map or the track ends: they lead into no run."""
        return (run for run in self.graph if self.graph.out_degree(run) == 0)

    def comes_over_seam(self, run: Run) -> bool:
        """Return whether the run begins at the end of another part of the map."""
        return self._kinds[self.start(run)] == "seam"

    def length_mm(self, run: Run) -> int:
        """Return the length of the run's edge."""
        return self.edges[run.edge].length_mm


def _runs(edge: TrackEdge) -> list[Run]:
    ways: tuple[Direction, ...] = ("increasing", "decreasing")
    return [Run(edge.id, way) for way in ways if edge.travel in ("both", way)]
