"""Lays out the routes of a line as a track plan: distance from the common start to the right, one lane for each track.

Through a switch, a track continues along its `track` name if the map gives one. A track that joins two lanes is drawn between
them; one that leaves a lane and returns to it gets a lane of its own. If routes give a node different distances, it stands
at their mean, and the edges beside it are stretched.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

from safeloc.errors import InputError
from safeloc.railway.map.elements import BaliseGroup, Marker, Reflector
from safeloc.railway.map.routes import Inventory, Route
from safeloc.railway.map.topology import Run, Topology
from safeloc.railway.pictures import PlanMark, PlanTrack, TrackPlan

_RAMP_MM = 40_000
Chain = tuple[Run, ...]


def track_plan(routes: Sequence[Route]) -> TrackPlan:
    """Return the plan of routes with a common start, numbered from 1 on. InputError without any route."""
    if not routes:
        raise InputError("a track plan needs at least one route.")
    layout = _Layout(tuple(routes))
    tracks = tuple(layout.track(run) for run in layout.runs)
    names = {number: route.models(layout.inventory) or route.name for number, route in enumerate(routes, 1)}
    marks = (*layout.switches(), *layout.things())
    return TrackPlan(layout.topology.line.name, names, tracks, marks, layout.lanes_used)


@dataclass(frozen=True)
class _Layout:
    """The layout of a track plan."""

    routes: tuple[Route, ...]

    @cached_property
    def topology(self) -> Topology:
        return self.routes[0].topology

    @cached_property
    def inventory(self) -> Inventory:
        return Inventory(self.topology.line)

    @cached_property
    def runs(self) -> list[Run]:
        """All runs of the routes, each once, in the order in which the routes use them."""
        return list(dict.fromkeys(run for route in self.routes for run in route.runs))

    @cached_property
    def nodes_mm(self) -> Mapping[str, int]:
        """Node -> distance from the common start."""
        found: dict[str, list[int]] = {}
        for route in self.routes:
            at = -route.start_mm
            found.setdefault(self.topology.start(route.runs[0]), []).append(at)
            for run in route.runs:
                at += self.topology.length_mm(run)
                found.setdefault(self.topology.end(run), []).append(at)
        return {node: sum(places) // len(places) for node, places in found.items()}

    # -------------------------------------------------------------- lanes

    @cached_property
    def chains(self) -> list[Chain]:
        """The tracks: at each node, the most likely pairs of a run that ends there and one that begins there."""
        moves = dict.fromkeys(pair for route in self.routes for pair in pairwise(route.runs))
        onward, taken = dict[Run, Run](), set[Run]()
        for before, after in sorted(moves, key=self._unlikely):
            if before not in onward and after not in taken:
                onward[before] = after
                taken.add(after)
        heads = sorted(self.runs, key=lambda run: run in taken)
        return list(_chains(heads, onward))

    def _unlikely(self, move: tuple[Run, Run]) -> int:
        """Return how unlikely two runs are one track: 0 same name, 1 two different names, 2 both without a name, 3 otherwise."""
        before, after = (self.topology.edges[run.edge].track for run in move)
        if before and after:
            return 0 if before == after else 1
        return 2 if before == after else 3

    @cached_property
    def lanes(self) -> tuple[Mapping[Chain, int], Mapping[str, int]]:
        """The lanes of chains, without those that only join two lanes, and the lanes of nodes."""
        chains, nodes = dict[Chain, int](), dict[str, int]()
        joining = [chain for chain in self.chains if self._joins(chain)]
        for chain in [one for one in self.chains if one not in joining]:
            self._take(chain, chains, nodes)
        for chain in joining:
            first, last = nodes.get(self.topology.start(chain[0])), nodes.get(self.topology.end(chain[-1]))
            if len(chain) > 1 or first is None or last is None or first == last:
                self._take(chain, chains, nodes)
        return chains, nodes

    def _joins(self, chain: Chain) -> bool:
        """Return whether both ends lie at nodes through which another chain runs."""
        inner = {self.topology.end(run) for other in self.chains if other != chain for run in other[:-1]}
        return self.topology.start(chain[0]) in inner and self.topology.end(chain[-1]) in inner

    def _take(self, chain: Chain, chains: dict[Chain, int], nodes: dict[str, int]) -> None:
        chains[chain] = len(chains)
        for run in chain:
            nodes.setdefault(self.topology.start(run), chains[chain])
            nodes.setdefault(self.topology.end(run), chains[chain])

    @property
    def lanes_used(self) -> int:
        """The number of lanes."""
        return len(self.lanes[0])

    # -------------------------------------------------------------- drawing

    def track(self, run: Run) -> PlanTrack:
        """Return one run as a track; it leaves or reaches its lane over a ramp."""
        (begin, first), (end, last) = self._end(self.topology.start(run)), self._end(self.topology.end(run))
        lane = next((lane for chain, lane in self.lanes[0].items() if run in chain), None)
        ramp = min(_RAMP_MM, abs(end - begin) // 3)
        points = [(begin, float(first))]
        if lane is not None and lane != first:
            points.append((begin + ramp, float(lane)))
        if lane is not None and lane != last:
            points.append((end - ramp, float(lane)))
        return PlanTrack(run.edge, (*points, (end, float(last))), self.numbers(run))

    def _end(self, node: str) -> tuple[int, int]:
        return self.nodes_mm[node], self.lanes[1][node]

    def numbers(self, run: Run) -> tuple[int, ...]:
        """Return the numbers of the routes over a run."""
        return tuple(number for number, route in enumerate(self.routes, 1) if run in route.runs)

    def switches(self) -> Iterator[PlanMark]:
        """Yield each switch once."""
        passed = {met.passage.switch.node: met.passage.switch for route in self.routes for met in route.switches()}
        for node, switch in passed.items():
            at, lane = self._end(node)
            yield PlanMark("switch", switch.id, at, lane)

    def things(self) -> Iterator[PlanMark]:
        """Yield balise groups, markers, and reflectors for the direction of travel."""
        for run in self.runs:
            length = self.topology.length_mm(run)
            for within, element in self.inventory.along(run, length):
                at, lane = self._place(run, within / length)
                if isinstance(element, BaliseGroup):
                    yield PlanMark("balise", element.id, at, lane, routes=self.numbers(run))
                elif isinstance(element, Marker):
                    yield PlanMark("marker", element.id, at, lane, routes=self.numbers(run))
                elif isinstance(element, Reflector):
                    yield PlanMark("reflector", element.id, at, lane, element.model, self.numbers(run))

    def _place(self, run: Run, share: float) -> tuple[int, float]:
        points = self.track(run).points
        at = points[0][0] + share * (points[-1][0] - points[0][0])
        for (x, lane), (next_x, next_lane) in pairwise(points):
            if x <= at <= next_x and x < next_x:
                return round(at), lane + (at - x) / (next_x - x) * (next_lane - lane)
        return round(at), points[-1][1]


def _chains(heads: Sequence[Run], onward: Mapping[Run, Run]) -> Iterator[Chain]:
    """Yield chains such that every run is in one; chains with a head come before circles."""
    done = set[Run]()
    for run in heads:
        if run not in done:
            chain = tuple(_followed(run, onward))
            done.update(chain)
            yield chain


def _followed(run: Run, onward: Mapping[Run, Run]) -> Iterator[Run]:
    """Yield a run and its continuations; a circle ends where it began."""
    first = run
    yield run
    while run in onward and onward[run] != first:
        run = onward[run]
        yield run
