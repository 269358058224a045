"""A line's plan and gradients as a course in space."""

from __future__ import annotations

import json
import math
from itertools import pairwise

import pytest

from safeloc.errors import InputError
from safeloc.railway.map.model import Line
from safeloc.railway.map.routes import Route, through_routes
from safeloc.railway.map.topology import Run, Topology
from safeloc.sensing.satellite.line_track import LineTrack
from safeloc.sensing.satellite.places import Place
from safeloc.sensing.satellite.track_prediction import Portion

pytest.importorskip("pyproj")

NODES = [{"id": name, "kind": "border"} for name in ("west", "east", "yard")] + [{"id": "switch"}]
COURSES = {
    "stem": ("west", "switch", [(8.0, 50.0), (8.007, 50.0), (8.014, 50.0)]),
    "main": ("switch", "east", [(8.014, 50.0), (8.021, 50.0), (8.028, 50.0)]),
    "turn": ("switch", "yard", [(8.014, 50.0), (8.021, 50.0005), (8.028, 50.002)]),
}


def fork(length_mm: int = 1_003_000) -> Line:
    """A switch west to east on the 50th parallel; the stem rises by 10 per mille on its second half."""
    edges = [
        {"id": name, "from_node": start, "to_node": end, "length_mm": length_mm, "geometry": {"points": points}}
        for name, (start, end, points) in COURSES.items()
    ]
    return Line.model_validate_json(
        json.dumps(
            {
                "name": "fork",
                "version": "1",
                "nodes": NODES,
                "edges": edges,
                "switches": [{"id": "1", "node": "switch", "stem": "stem", "left": "turn", "right": "main"}],
                "gradients": [{"edge": "stem", "from_mm": 500_000, "to_mm": length_mm, "rise_ppm": 10_000}],
            }
        )
    )


def eastward(line: Line) -> list[Route]:
    """The two ways from the west."""
    return [route for route in through_routes(Topology(line), 10) if route.runs[0] == Run("stem", "increasing")]


def height(portion: Portion, distance_m: float) -> float:
    """Height of the course above the ellipsoid."""
    return Place.of_earth_fixed(portion.at(distance_m)[0]).height_m


def test_lengths_are_the_maps() -> None:
    """The map's 1003 m an edge count, whatever the plan makes of them; the course is as long in space, to 1 %."""
    (portion, _) = LineTrack(eastward(fork()), 100.0).portions(0.0, 2_000.0)
    assert 2_006.0 == pytest.approx(portion.end_m)
    assert 2_006.0 == pytest.approx(sum(math.dist(a, b) for a, b in pairwise(portion.points)), rel=0.01)


def test_gradients_say_the_height() -> None:
    """Level at 100 m, then 10 per mille over 503 m; level again beyond the edge that has the gradient."""
    (portion, _) = LineTrack(eastward(fork()), 100.0).portions(0.0, 2_000.0)
    assert [100.0, 105.03, 105.03] == [pytest.approx(height(portion, at), abs=0.15) for at in (0.0, 1_003.0, 2_006.0)]


def test_the_way_back_falls() -> None:
    """The same track the other way: begun at the height of its end, it comes down to that of its beginning."""
    line = fork()
    back = next(one for one in through_routes(Topology(line), 10) if one.runs[0] == Run("main", "decreasing"))
    (portion,) = LineTrack([back], 105.03).portions(0.0, 2_000.0)
    there = LineTrack(eastward(line), 100.0).portions(0.0, 500.0)[0]
    assert 100.0 == pytest.approx(height(portion, 2_006.0), abs=0.01)
    assert math.dist(portion.at(2_006.0)[0], there.at(0.0)[0]) < 0.02


def test_one_portion_before_the_switch_two_behind_it() -> None:
    """Both routes are one where they agree; from the switch on there are two."""
    track = LineTrack(eastward(fork()), 100.0)
    assert [1, 2, 2] == [
        len(track.portions(*stretch)) for stretch in ((0.0, 900.0), (990.0, 1_010.0), (1_500.0, 1_600.0))
    ]


def test_a_route_may_begin_within_an_edge() -> None:
    """Distances count from its beginning; the track before it is there too."""
    topology = Topology(fork())
    route = Route(topology, (Run("stem", "increasing"), Run("main", "increasing")), 400_000, 500_000)
    (portion,) = LineTrack([route], 100.0).portions(0.0, 10.0)
    whole = LineTrack(eastward(topology.line), 100.0).portions(0.0, 10.0)[0]
    assert -400.0 == portion.start_m
    assert math.dist(portion.at(0.0)[0], whole.at(400.0)[0]) < 0.05


def test_what_has_no_course_is_refused() -> None:
    """No geometry; routes that begin apart; a height that is no number."""
    line = fork()
    bare = line.model_copy(update={"edges": tuple(edge.model_copy(update={"geometry": None}) for edge in line.edges)})
    with pytest.raises(InputError, match="'stem' has no geometry"):
        LineTrack(eastward(bare), 100.0).portions(0.0, 1.0)
    with pytest.raises(InputError, match="common beginning"):
        LineTrack(through_routes(Topology(line), 10), 100.0)
    with pytest.raises(InputError, match="not finite"):
        LineTrack(eastward(line), math.nan)
