"""Odometry stretches on graphs that are no straight line: the worst of all routes, and loops (RFL-D1)."""

from __future__ import annotations

from safeloc.models.layout_rules import LayoutConfig
from safeloc.railway.audit import audit
from safeloc.railway.audit.findings import Finding
from safeloc.railway.map.elements import Node, Switch, TrackEdge
from safeloc.railway.map.model import Line
from tests.railway.map.made import fork, group, reflector, straight


def stretches(line: Line, layout: LayoutConfig | None = None) -> list[str]:
    """Stretches that are too long, in words."""
    return [_told(finding) for finding in audit(line, layout).violated if finding.rule == "odometry stretch"]


def _told(finding: Finding) -> str:
    assert finding.figures is not None
    return f"{finding.subject}: {finding.figures.actual} > {finding.figures.required}"


def test_the_longer_of_two_ways_counts() -> None:
    """To a reference behind two tracks of unlike length leads the longer one."""
    nodes = tuple(Node(id=name) for name in ("west", "s", "t", "east"))
    shape = (
        ("before", "west", "s", 10_000),
        ("main", "s", "t", 300_000),
        ("side", "s", "t", 500_000),
        ("after", "t", "east", 20_000),
    )
    edges = tuple(
        TrackEdge(id=name, from_node=start, to_node=end, length_mm=length, travel="increasing")
        for name, start, end, length in shape
    )
    switches = (
        Switch(id="s", node="s", stem="before", left="main", right="side"),
        Switch(id="t", node="t", stem="after", left="side", right="main"),
    )
    groups = (group(1, "before", 9_000, 9_500), group(2, "after", 10_000, 13_000))
    line = Line(name="l", version="1", nodes=nodes, edges=edges, switches=switches, balise_groups=groups)
    assert ["from balise group g1 to balise group g2, increasing: 511000 > 442681"] == stretches(line)


def test_the_coarser_fix_counts_where_it_reaches_less_far() -> None:
    """Of two ways to one reference the shorter may be the worse: its balise is coarser."""
    fine, coarse = group(1, "left", 50_000), group(2, "right", 90_000, location_accuracy_mm=12_000)
    line = fork(stem_mm=400_000, left_mm=100_000, right_mm=100_000, balise_groups=(fine, coarse))
    turned = tuple(edge.model_copy(update={"travel": "decreasing"}) for edge in line.edges)
    line = line.model_copy(update={"edges": turned})
    assert ["from balise group g2 to the end of the map, decreasing: 490000 > 209981"] == stretches(line)


def test_both_directions_are_checked() -> None:
    """A reflector serves one direction, a balise both."""
    line = straight(800_000, travel="both", balise_groups=(group(1, "e0", 400_000, 403_000),))
    assert [] == stretches(line)
    seen = (reflector("r", "e0", 400_000),)
    assert ["from the edge of the map at n1 to the end of the map, decreasing: 800000 > 469981"] == stretches(
        straight(800_000, travel="both", reflectors=seen)
    )


def test_overlapping_view_zones_leave_no_stretch() -> None:
    """Between view zones that overlap no odometry is needed."""
    line = straight(
        300_000, reflectors=tuple(reflector(f"r{place}", "e0", place) for place in (100_000, 150_000, 200_000))
    )
    assert [] == stretches(line)
    assert 4 == audit(line).cases["odometry stretch"]


def test_view_zones_reach_over_joints_and_switches() -> None:
    """A view zone that begins on the edge before shortens the stretch there."""
    line = straight(
        560_000, 100_000, balise_groups=(group(1, "e0", 100_000),), reflectors=(reflector("r", "e1", 80_000),)
    )
    assert [] == stretches(line)
    nearer = straight(
        566_000, 100_000, balise_groups=(group(1, "e0", 100_000),), reflectors=(reflector("r", "e1", 80_000),)
    )
    assert ["from balise group g1 to reflector r (A), increasing: 446000 > 443731"] == stretches(nearer)


def test_offsets_of_antenna_and_radar_count() -> None:
    """From the antenna over the balise to the radar at the view zone is a longer way for a radar farther back."""
    line = straight(
        560_000, 100_000, balise_groups=(group(1, "e0", 100_000),), reflectors=(reflector("r", "e1", 80_000),)
    )
    behind = LayoutConfig(sensor_offset_mm=6_000, antenna_offset_mm=0)
    assert ["from balise group g1 to reflector r (A), increasing: 446000 > 443731"] == stretches(line, behind)
    assert [] == stretches(line, LayoutConfig(sensor_offset_mm=6_000, antenna_offset_mm=3_000))


def test_a_loop_without_references_has_no_bound() -> None:
    """On a ring without any reference the error grows without end."""
    nodes = tuple(Node(id=name) for name in "abc")
    edges = tuple(
        TrackEdge(id=f"{one}{two}", from_node=one, to_node=two, length_mm=10_000, travel="increasing")
        for one, two in (("a", "b"), ("b", "c"), ("c", "a"))
    )
    ring = Line(name="ring", version="1", nodes=nodes, edges=edges)
    (found,) = audit(ring).violated
    assert "a loop over 3 edges without any reference, on ab at 0 mm: distance without bound" in found.as_text()
    equipped = ring.model_copy(update={"balise_groups": (group(1, "ab", 1_000, 4_000),)})
    assert () == audit(equipped).violated


def test_a_ring_with_reflectors_but_no_balise() -> None:
    """On a ring every reflector comes after itself, never after a balise."""
    nodes = tuple(Node(id=name) for name in "ab")
    edges = tuple(
        TrackEdge(id=f"{one}{two}", from_node=one, to_node=two, length_mm=200_000, travel="increasing")
        for one, two in (("a", "b"), ("b", "a"))
    )
    ring = Line(name="ring", version="1", nodes=nodes, edges=edges, reflectors=(reflector("r", "ab", 100_000),))
    assert ["reflector after its balise"] == [finding.rule for finding in audit(ring).violated]


def test_odometry_that_does_not_grow_reaches_any_distance() -> None:
    """With a constant error only, the coarsest fix decides."""
    line = straight(10**9, balise_groups=(group(1, "e0", 500_000_000),))
    assert [] == stretches(line, LayoutConfig(odometry_rate_ppm=0))
    coarse = straight(10**9, balise_groups=(group(1, "e0", 500_000_000, location_accuracy_mm=63_000),))
    assert ["from balise group g1 to the end of the map, increasing: 64000 > 24999"] == stretches(
        coarse, LayoutConfig(odometry_rate_ppm=0)
    )
