"""How near reflectors stand: along a route, on the other branch, beside a parallel track."""

from __future__ import annotations

from safeloc.railway.map.clearance import Pair, clear_mm, pairs
from safeloc.railway.map.elements import KilometrePoint, Node, TrackEdge
from safeloc.railway.map.model import Line
from safeloc.railway.map.toml_files import find_line
from safeloc.railway.map.walk import Walk
from tests.railway.map.made import fork, reflector, straight

REACH = 200_000


def told(line: Line) -> set[tuple[str, str, int, bool]]:
    """Pairs within reach."""
    return {(one.first.id, one.second.id, one.spacing_mm, one.one_route) for one in pairs(Walk(line), REACH)}


def test_neighbours_on_a_route() -> None:
    """In order of travel, over the joint of two edges; beyond reach they are no neighbours."""
    line = straight(
        500_000,
        500_000,
        reflectors=(reflector("a", "e0", 400_000), reflector("b", "e1", 50_000), reflector("c", "e1", 400_000)),
    )
    assert {("a", "b", 150_000, True)} == told(line)


def test_reflectors_for_the_other_direction_are_not_seen() -> None:
    """Back to back they are no neighbours."""
    facing = (reflector("a", "e0", 100_000), reflector("b", "e0", 150_000, direction="decreasing"))
    assert set() == told(straight(500_000, travel="both", reflectors=facing))


def test_neighbours_on_branches() -> None:
    """Behind a switch both branches are seen: what counts is how much farther the one is."""
    both = (reflector("l", "left", 80_000), reflector("r", "right", 50_000))
    assert {("l", "r", 30_000, False)} == told(fork(stem_mm=9, left_mm=200_000, right_mm=200_000, reflectors=both))


def test_branches_lie_beside_each_other_for_a_kilometre() -> None:
    """However small the greatest spacing asked for: 800 m behind the switch two places may be 30 m apart."""
    both = (reflector("l", "left", 830_000), reflector("r", "right", 800_000))
    line = fork(stem_mm=9, left_mm=900_000, right_mm=900_000, reflectors=both)
    assert [30_000] == [pair.spacing_mm for pair in pairs(Walk(line), 40_000)]
    assert [] == pairs(Walk(line), 29_000)


def test_neighbours_before_a_trailing_switch() -> None:
    """Where two tracks join, the vehicle on one sees what stands beside the other."""
    line = fork(
        stem_mm=9,
        left_mm=200_000,
        right_mm=200_000,
        reflectors=(
            reflector("l", "left", 80_000, direction="decreasing"),
            reflector("r", "right", 50_000, direction="decreasing"),
        ),
    )
    turned = tuple(edge.model_copy(update={"travel": "decreasing"}) for edge in line.edges)
    assert {("l", "r", 30_000, False)} == told(line.model_copy(update={"edges": turned}))


def parallel(second: KilometrePoint, way: str = "increasing") -> Line:
    """Two tracks without a connection, one reflector beside each, the kilometre telling that they lie side by side."""
    first = KilometrePoint(kilometre_mm=1_000_000)
    nodes = tuple(Node(id=name) for name in "abcd")
    edges = (
        TrackEdge(id="e0", from_node="a", to_node="b", length_mm=500_000, kilometres=(first,)),
        TrackEdge(id="e1", from_node="c", to_node="d", length_mm=500_000, kilometres=(second,)),
    )
    both = (reflector("p", "e0", 100_000), reflector("q", "e1", 100_000, direction=way))
    return Line(name="parallel", version="1", nodes=nodes, edges=edges, reflectors=both)


def test_neighbours_beside_a_parallel_track() -> None:
    """One kilometre line, the same way along it."""
    assert {("p", "q", 20_000, False)} == told(parallel(KilometrePoint(kilometre_mm=1_020_000)))
    assert set() == told(parallel(KilometrePoint(kilometre_mm=1_020_000, line="other")))
    assert set() == told(parallel(KilometrePoint(kilometre_mm=1_020_000), "decreasing"))


def test_a_track_counted_downwards_faces_the_other_way() -> None:
    """On an edge against the kilometre, vehicles going against the edge count upwards."""
    downwards = KilometrePoint(kilometre_mm=1_190_000, direction="decreasing")
    assert {("q", "p", 10_000, False)} == told(parallel(downwards, "decreasing"))
    assert set() == told(parallel(downwards))


def test_clearance_counts_equal_models_only() -> None:
    """The nearest one of the same model; the reach where there is none."""
    line = straight(
        500_000,
        reflectors=(
            reflector("a", "e0", 100_000),
            reflector("b", "e0", 150_000, "B"),
            reflector("c", "e0", 220_000),
            reflector("d", "e0", 230_000),
        ),
    )
    assert {"a": 120_000, "b": REACH, "c": 10_000, "d": 10_000} == clear_mm(Walk(line), REACH)


def test_clearances_of_figure_3() -> None:
    """312 and 315, both of model D, stand beside parallel tracks: 150 m apart by the kilometre."""
    clear = clear_mm(Walk(find_line("fig3")), 1_000_000)
    assert (150_000, 150_000, 160_000) == (clear["312"], clear["315"], clear["316"])


def test_a_pair_on_one_route_is_told_once() -> None:
    """What is found along the route is not told again by the kilometre."""
    line = straight(500_000, reflectors=(reflector("a", "e0", 100_000), reflector("b", "e0", 150_000)))
    counted = line.edges[0].model_copy(update={"kilometres": (KilometrePoint(kilometre_mm=0),)})
    found = pairs(Walk(line.model_copy(update={"edges": (counted,)})), REACH)
    assert [Pair(line.reflectors[0], line.reflectors[1], 50_000, True)] == found
