"""A junction in the plane, and deliveries on it: for tests of tracks and of the guard at work."""

from __future__ import annotations

import math
from itertools import pairwise

from safeloc.models.guard.variables import GuardConfig
from safeloc.railway.guard.deliveries import Delivery
from safeloc.railway.guard.guard import Guard
from safeloc.railway.guard.tracks import Tracks
from safeloc.railway.map.elements import Geometry, Node, Switch, TrackEdge
from safeloc.railway.map.model import Line
from safeloc.railway.map.routes import Route

CRS = "+proj=tmerc +lat_0=48 +lon_0=9 +datum=WGS84 +units=m +no_defs"
EAST_M, NORTH_M = 0, 0
CONFIG = GuardConfig(confirmations=3, max_speed_mm_s=30_000, track_clearance_mm=10_000)


def edge(name: str, begin: str, end: str, *points: tuple[float, float]) -> TrackEdge:
    """A piece of track whose course is given in metres from a corner of the plane."""
    length = sum(math.dist(one, other) for one, other in pairwise(points))
    course = Geometry(crs=CRS, points=tuple((EAST_M + x, NORTH_M + y) for x, y in points))
    return TrackEdge(id=name, from_node=begin, to_node=end, length_mm=round(length * 1000), geometry=course)


def fork(*more: TrackEdge) -> Line:
    """A stem of 500 m, straight on for 500 m, and a branch that is 50 m to the left after 300 m; and other edges."""
    edges = (
        edge("stem", "W", "S", (0, 0), (500, 0)),
        edge("main", "S", "E", (500, 0), (1_000, 0)),
        edge("side", "S", "Y", (500, 0), (800, 50), (1_000, 50)),
        *more,
    )
    nodes = sorted({node for one in edges for node in (one.from_node, one.to_node)})
    return Line(
        name="fork",
        version="1",
        nodes=tuple(Node(id=node, kind="track" if node == "S" else "border") for node in nodes),
        edges=edges,
        switches=(Switch(id="S", node="S", stem="stem", left="side", right="main"),),
    )


def tracks(line: Line | None = None, route: Route | None = None, config: GuardConfig = CONFIG) -> Tracks:
    """The tracks of a line, for positions in its own plane."""
    return Tracks(
        line or fork(), clear_mm=config.track_clearance_mm, reach_mm=config.tolerance_mm, route=route, crs=CRS
    )  # fmt: skip


def place(x: float, y: float = 0.0) -> tuple[float, float]:
    """Coordinates of a place in metres from the corner."""
    return EAST_M + x, NORTH_M + y


def fix(second: float, x: float, y: float = 0.0, *, speed_mm_s: int | None = None) -> Delivery:
    """A position that is told at a second."""
    east, north = place(x, y)
    return Delivery(1, round(second * 1000), east, north, speed_mm_s)


def guard(route: Route | None = None, line: Line | None = None, config: GuardConfig = CONFIG) -> Guard:
    """A guard on the fork."""
    return Guard(config, tracks(line, route, config))
