"""Random lines: tracks side by side with crossovers both ways, balises and reflectors anywhere, run in one or both directions."""

from __future__ import annotations

from dataclasses import dataclass, field

from hypothesis import strategies as st

from safeloc.railway.map.elements import BaliseGroup, Direction, KilometrePoint, Node, Reflector, Switch, TrackEdge
from safeloc.railway.map.model import Line
from tests.railway.map.made import group, reflector


@dataclass
class Draft:
    """A line in the making: the open end of every track, and what was made."""

    travel: str
    ends: list[tuple[str, int]]
    nodes: list[Node] = field(default_factory=list)
    edges: list[TrackEdge] = field(default_factory=list)
    switches: list[Switch] = field(default_factory=list)

    def node(self) -> str:
        """A new node."""
        self.nodes.append(Node(id=f"n{len(self.nodes)}"))
        return self.nodes[-1].id

    def edge(self, start: str, end: str, length_mm: int, kilometre_mm: int) -> str:
        """A new edge."""
        counted = (KilometrePoint(kilometre_mm=kilometre_mm),)
        name = f"e{len(self.edges)}"
        made = TrackEdge(
            id=name,
            from_node=start,
            to_node=end,
            length_mm=length_mm,
            travel=self.travel,
            kilometres=counted,  # type: ignore[arg-type]
        )
        self.edges.append(made)
        return name

    def grow(self, track: int, length_mm: int) -> tuple[str, str]:
        """One more edge at the end of a track, and its far node."""
        start, reached = self.ends[track]
        end = self.node()
        self.ends[track] = (end, reached + length_mm)
        return self.edge(start, end, length_mm, reached), end

    def cross(self, come: int, go: int, before: tuple[int, int], after: tuple[int, int]) -> None:
        """A crossover from one track to the other."""
        stem, switch = self.grow(come, before[0])
        leg, join = self.grow(go, before[1])
        link = self.edge(switch, join, 40_000, self.ends[come][1])
        straight, _ = self.grow(come, after[0])
        behind, _ = self.grow(go, after[1])
        self.switches.append(Switch(id=switch, node=switch, stem=stem, left=straight, right=link))
        self.switches.append(Switch(id=join, node=join, stem=behind, left=leg, right=link))


LENGTHS = st.sampled_from([30_000, 120_000, 300_000])


@st.composite
def lines(draw: st.DrawFn) -> Line:
    """A line of one to three tracks with at most four crossovers."""
    tracks = draw(st.integers(1, 3))
    draft = Draft(draw(st.sampled_from(["increasing", "both"])), [])
    draft.ends = [(draft.node(), 0) for _ in range(tracks)]
    for _ in range(draw(st.integers(0, 4)) if tracks > 1 else 0):
        come, go = draw(st.permutations(range(tracks)))[:2]
        pair = st.tuples(LENGTHS, LENGTHS)
        draft.cross(come, go, draw(pair), draw(pair))
    for track in range(tracks):
        draft.grow(track, draw(LENGTHS))
    groups = [_group(draw, number, draft.edges) for number in range(draw(st.integers(0, 4)))]
    reflectors = [_reflector(draw, number, draft) for number in range(draw(st.integers(0, 8)))]
    return Line(
        name="random",
        version="1",
        nodes=tuple(draft.nodes),
        edges=tuple(draft.edges),
        switches=tuple(draft.switches),
        balise_groups=tuple(groups),
        reflectors=tuple(reflectors),
    )


def _group(draw: st.DrawFn, number: int, edges: list[TrackEdge]) -> BaliseGroup:
    edge = draw(st.sampled_from(edges))
    accuracy = draw(st.sampled_from([300, 12_000, None]))
    place = draw(st.integers(0, edge.length_mm))
    return group(number, edge.id, place, location_accuracy_mm=accuracy)


def _reflector(draw: st.DrawFn, number: int, draft: Draft) -> Reflector:
    edge = draw(st.sampled_from(draft.edges))
    ways: list[Direction] = ["increasing"] if draft.travel == "increasing" else ["increasing", "decreasing"]
    return reflector(
        f"r{number}",
        edge.id,
        draw(st.integers(0, edge.length_mm)),
        draw(st.sampled_from("AB")),
        direction=draw(st.sampled_from(ways)),
        view_from_mm=draw(st.sampled_from([50_000, 100_000])),
    )
