"""Track plans: lanes, distances and marks of a line's routes."""

from __future__ import annotations

import pytest

from safeloc.errors import InputError
from safeloc.railway.map.elements import Node, Switch, TrackEdge
from safeloc.railway.map.model import Line
from safeloc.railway.map.plan import track_plan
from safeloc.railway.map.routes import Route, through_routes
from safeloc.railway.map.toml_files import find_line
from safeloc.railway.map.topology import Topology
from safeloc.railway.pictures import TrackPlan
from tests.railway.map.made import marker, straight


def eastward(line: Line) -> list[Route]:
    """Routes from every way onto the map to every way off it, in direction of increasing positions."""
    return [route for route in through_routes(Topology(line), 100) if route.runs[0].direction == "increasing"]


def lanes(plan: TrackPlan) -> dict[str, tuple[float, ...]]:
    """The lanes of each track's points."""
    return {track.name: tuple(lane for _, lane in track.points) for track in plan.tracks}


def test_figure_3_is_two_tracks_and_three_connections() -> None:
    """The first track above, the second below, and between them what joins their switches."""
    plan = track_plan(eastward(find_line("fig3")))
    assert plan.lanes == 2
    found = lanes(plan)
    assert {found[name] for name in ("301", "302-304", "304-306", "309")} == {(0, 0)}
    assert {found[name] for name in ("308", "303-305", "305-307", "310")} == {(1, 1)}
    assert {found[name] for name in ("302-303", "304-305", "306-307")} == {(0, 1)}
    assert dict(plan.routes) == {1: "ADAB", 2: "ADAD", 3: "ADCD", 4: "ACD", 5: "DCD"}


def test_marks_stand_at_their_distance() -> None:
    """Each reflector once, with its model and the routes that pass it; on a connection between the lanes."""
    plan = track_plan(eastward(find_line("fig3")))
    reflectors = {mark.name: mark for mark in plan.marks if mark.kind == "reflector"}
    assert len(reflectors) == 8
    assert (reflectors["318"].at_mm, reflectors["318"].model, reflectors["318"].routes) == (900_000, "D", (2, 3, 4, 5))
    assert (reflectors["316"].at_mm, reflectors["316"].lane) == (540_000, pytest.approx(0.8))
    assert {mark.name for mark in plan.marks if mark.kind == "switch"} == {"302", "303", "304", "305", "306", "307"}


def test_markers_stand_on_the_plan() -> None:
    """At their distance in direction of travel, whatever the direction."""
    line = straight(600_000, 400_000, travel="both", markers=(marker(1, "e0", 5_000), marker(2, "e1", 100_000)))
    for route, places in zip(through_routes(Topology(line), 10), ([5_000, 700_000], [300_000, 995_000]), strict=True):
        marks = [mark for mark in track_plan([route]).marks if mark.kind == "marker"]
        assert places == sorted(mark.at_mm for mark in marks)
        assert {"m1", "m2"} == {mark.name for mark in marks}


def test_a_route_begun_on_the_way_counts_from_there() -> None:
    """What lies before the start stands before 0."""
    (route,) = eastward(find_line("fig1"))
    plan = track_plan([Route(route.topology, route.runs, 400_000, route.end_mm)])
    (track,) = plan.tracks
    assert [at for at, _ in track.points] == [-400_000, 600_000]
    assert {mark.name: mark.at_mm for mark in plan.marks} == {"106": 0, "109": 80_000, "111": 460_000}


def loop(long_mm: int) -> Line:
    """A passing loop: two ways of unequal length between two switches."""
    edges = [
        ("in", "w", "a", 100_000),
        ("main", "a", "b", 300_000),
        ("side", "a", "b", long_mm),
        ("out", "b", "e", 100_000),
    ]
    return Line(
        name="loop",
        version="1",
        nodes=(Node(id="w", kind="border"), Node(id="a"), Node(id="b"), Node(id="e", kind="border")),
        edges=tuple(
            TrackEdge(id=name, from_node=start, to_node=end, length_mm=length, travel="increasing")
            for name, start, end, length in edges
        ),
        switches=(
            Switch(id="1", node="a", stem="in", left="main", right="side"),
            Switch(id="2", node="b", stem="out", left="side", right="main"),
        ),
    )


def test_a_loop_has_a_lane_of_its_own() -> None:
    """It leaves the main track on a ramp and comes back to it, between the same switches."""
    plan = track_plan(eastward(loop(300_000)))
    assert plan.lanes == 2
    found = lanes(plan)
    assert found["side"] == (0, 1, 1, 0)
    assert found["in"] == found["main"] == found["out"] == (0, 0)
    assert plan.routes == {1: "in > main > out", 2: "in > side > out"}


def test_ways_of_unequal_length_meet_in_the_middle() -> None:
    """The node stands at the mean of its distances, both ways end there."""
    plan = track_plan(eastward(loop(500_000)))
    ends = {track.name: track.points[-1][0] for track in plan.tracks}
    assert ends["main"] == ends["side"] == 500_000


def test_no_route_no_plan() -> None:
    """There is nothing to draw."""
    with pytest.raises(InputError, match=r"^a track plan needs at least one route\.$"):
        track_plan([])
