"""Where vehicles can go: through switches from the stem and to it, never from branch to branch."""

from __future__ import annotations

import pytest

from safeloc.railway.map.elements import Crossing, Node, TrackEdge
from safeloc.railway.map.model import Line
from safeloc.railway.map.toml_files import find_line
from safeloc.railway.map.topology import Run, Topology
from tests.railway.map.made import fork, straight


def both_ways(line: Line) -> Line:
    """The same line, run in both directions."""
    return line.model_copy(update={"edges": tuple(one.model_copy(update={"travel": "both"}) for one in line.edges)})


def arcs(line: Line) -> set[tuple[str, str]]:
    """Movements in words: `stem+` is along the edge, `stem-` against it."""
    sign = {"increasing": "+", "decreasing": "-"}
    return {(a.edge + sign[a.direction], b.edge + sign[b.direction]) for a, b in Topology(line).graph.edges}


def test_a_switch_joins_the_stem_with_either_branch() -> None:
    """Four movements, and none from left to right."""
    expected = {("stem+", "left+"), ("stem+", "right+"), ("left-", "stem-"), ("right-", "stem-")}
    assert expected == arcs(both_ways(fork(stem_mm=5, left_mm=5, right_mm=5)))


def test_regular_travel_is_kept() -> None:
    """Against the direction of travel no vehicle goes."""
    assert {("stem+", "left+"), ("stem+", "right+")} == arcs(fork(stem_mm=5, left_mm=5, right_mm=5))
    assert {("e1-", "e0-")} == arcs(straight(5, 5, travel="decreasing"))


def test_no_vehicle_turns_round_at_a_node() -> None:
    """At the end of an edge a vehicle does not come back along it."""
    assert {("e0+", "e1+"), ("e1-", "e0-")} == arcs(straight(5, 5, travel="both"))


def crossing(*movements: tuple[str, str]) -> Line:
    """Four edges at one node, named by where they come from."""
    nodes = tuple(Node(id=name) for name in ("m", "w", "e", "n", "s"))
    edges = tuple(TrackEdge(id=name, from_node=name, to_node="m", length_mm=5) for name in "wens")
    crossings = (Crossing(id="x", node="m", movements=movements),)
    return Line(name="x", version="1", nodes=nodes, edges=edges, crossings=crossings)


def test_a_diamond_leads_straight_on() -> None:
    """Only the stated movements, each both ways."""
    assert {("w+", "e-"), ("e+", "w-"), ("n+", "s-"), ("s+", "n-")} == arcs(crossing(("w", "e"), ("n", "s")))


def test_a_slip_leads_over_too() -> None:
    """One movement more is two arcs more."""
    assert {("w+", "s-"), ("s+", "w-")} < arcs(crossing(("w", "e"), ("n", "s"), ("w", "s")))


def test_passages_tell_side_and_direction() -> None:
    """From the stem a switch is faced; from a branch it is trailed."""
    topology = Topology(both_ways(fork(stem_mm=5, left_mm=5, right_mm=5)))
    stem, left, right = (Run(name, "increasing") for name in ("stem", "left", "right"))
    facing, trailing = topology.passage(stem, right), topology.passage(left.back, stem.back)
    assert facing is not None
    assert trailing is not None
    assert (True, "right") == (facing.facing, facing.side)
    assert (False, "left") == (trailing.facing, trailing.side)
    assert Topology(straight(5, 5)).passage(Run("e0", "increasing"), Run("e1", "increasing")) is None


def test_ends_of_figure_3() -> None:
    """Vehicles come on at two places and leave at two."""
    topology = Topology(find_line("fig3"))
    assert {"301", "308"} == {run.edge for run in topology.entries()}
    assert {"309", "310"} == {run.edge for run in topology.exits()}


@pytest.mark.parametrize(("kind", "expected"), [("seam", True), ("border", False), ("track", False)])
def test_seams_are_known(kind: str, expected: bool) -> None:
    """A run begins over a seam where its first node is one."""
    line = straight(5)
    seam = line.model_copy(update={"nodes": (Node(id="n0", kind=kind), line.nodes[1])})  # type: ignore[arg-type]
    assert expected == Topology(seam).comes_over_seam(Run("e0", "increasing"))
