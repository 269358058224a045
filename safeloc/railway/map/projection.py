"""Geographic positions on the track: the nearest edge, the place on it, and how far off it lies.

Needs the extra `geo` (shapely, pyproj). Computed in a plane that touches the Earth at the middle of the line; the place
is then counted along the edge's own length, so that it fits the map to the mm however the plane is distorted.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate, pairwise
from typing import Any

from safeloc.errors import InputError
from safeloc.railway.map.elements import Geometry, TrackEdge
from safeloc.railway.map.imports.building import missing
from safeloc.railway.map.model import Line
from safeloc.railway.map.places import Place

WGS84 = "EPSG:4326"
_HALF_CHORD_M = 5.0
"""The direction of a track is that of 10 m of it, so that a corner of its course on the map is no turn."""
LAMBERT72 = "EPSG:31370"
_PURPOSE = "projecting positions to the track"


@dataclass(frozen=True)
class Projected:
    """A position, projected onto the track.

    place      the nearest place of the track, to the nearest mm
    offset_mm  how far the position lies off it, to the nearest mm: positive to the right of the edge's increasing
               direction, negative to the left; beyond the end of a track it is the distance to that end
    """

    place: Place
    offset_mm: int


@dataclass(frozen=True)
class _Course:
    """An edge in the plane, with the length of the map spread over its segments."""

    edge: str
    line: Any
    points: tuple[tuple[float, float], ...]
    reached: tuple[float, ...]
    length_mm: int
    turns: bool

    def place_mm(self, distance: float) -> int:
        """The position along the edge, for a distance along the plane course."""
        return min(max(round(distance / self.reached[-1] * self.length_mm), 0), self.length_mm)

    def heading(self, distance: float) -> float:
        """The direction of increasing positions around this distance along the course, in radians from east to north."""
        begin = self.line.interpolate(max(distance - _HALF_CHORD_M, 0.0))
        end = self.line.interpolate(min(distance + _HALF_CHORD_M, self.reached[-1]))
        return math.atan2(end.y - begin.y, end.x - begin.x)

    def side(self, distance: float, x: float, y: float) -> int:
        """1 to the right of the course at this distance along it, -1 to the left."""
        index = next((i for i, end in enumerate(self.reached[1:]) if end >= distance), len(self.reached) - 2)
        (ax, ay), (bx, by) = self.points[index], self.points[index + 1]
        return -1 if (bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0 else 1


class Projector:
    """Projects positions to the edges of a line. InputError for a line no edge of which has a geometry."""

    def __init__(self, line: Line, *, edges: Sequence[str] | None = None) -> None:
        """`edges` restricts the projection to some edges, for instance those of a route."""
        self._shapely, self._pyproj = _shapely(), _pyproj()
        chosen = [edge for edge in line.edges if edge.geometry is not None and (edges is None or edge.id in edges)]
        if not chosen:
            raise InputError(f"{line.name}: none of these edges has a geometry; positions cannot be projected to them.")
        degrees = [self._degrees(edge) for edge in chosen]
        self._plane = _plane_at(degrees)
        self._transformers: dict[str, Any] = {}
        self._courses = [self._course(edge, points) for edge, points in zip(chosen, degrees, strict=True)]
        self._tree = self._shapely.STRtree([course.line for course in self._courses])

    def project(self, x: float, y: float, *, crs: str = WGS84) -> Projected:
        """Return the place nearest to a position.

        x, y  longitude and latitude in degrees for EPSG:4326; easting and northing otherwise, in the system's unit
        Raises InputError for coordinates that are not finite, or outside where `crs` is defined.
        """
        east, north = self._to_plane(x, y, crs)
        point = self._shapely.Point(east, north)
        course = self._courses[int(self._tree.nearest(point))]
        along = float(course.line.project(point))
        off = round(float(course.line.distance(point)) * 1000)
        return Projected(Place(course.edge, course.place_mm(along)), off * course.side(along, east, north))

    def near(self, x: float, y: float, limit_mm: int, *, crs: str = WGS84) -> list[Projected]:
        """Return every place of the track that is the nearest of its surroundings and within the limit; the nearest first.

        An edge that comes by more than once has more than one. InputError as in `project`.
        """
        east, north = self._to_plane(x, y, crs)
        point = self._shapely.Point(east, north)
        limit = limit_mm / 1000
        found = []
        for index in self._tree.query(point, predicate="dwithin", distance=limit):
            course = self._courses[int(index)]
            for along in self._passes(course, point, limit):
                off = round(float(course.line.interpolate(along).distance(point)) * 1000)
                found.append(
                    Projected(Place(course.edge, course.place_mm(along)), off * course.side(along, east, north))
                )
        return sorted(found, key=lambda one: (abs(one.offset_mm), one.place))

    def _passes(self, course: _Course, point: Any, limit: float) -> list[float]:
        """Distances along the course at which it comes nearest to the point, once each time it comes within the limit."""
        if not course.turns:
            return [float(course.line.project(point))]
        inside = course.line.intersection(point.buffer(limit * 1.01 + 0.001))
        pieces = [piece for piece in getattr(inside, "geoms", [inside]) if not piece.is_empty]
        nearest = (self._shapely.ops.nearest_points(piece, point)[0] for piece in pieces)
        return [float(course.line.project(one)) for one in nearest if one.distance(point) <= limit]

    def prepare(self, crs: str) -> None:
        """Get ready for positions of a coordinate system; InputError where there is none of that name."""
        self._transformers.setdefault(crs, self._transformer(crs, self._plane))

    def plane(self, x: float, y: float, *, crs: str = WGS84) -> tuple[float, float]:
        """Return a position in the plane of the projection: metres east and north of the line's middle. InputError as above."""
        return self._to_plane(x, y, crs)

    def heading(self, place: tuple[float, float]) -> tuple[str, float]:
        """Return the edge nearest to a place of the plane, and its direction there: radians from east to north, increasing."""
        point = self._shapely.Point(*place)
        course = self._courses[int(self._tree.nearest(point))]
        return course.edge, course.heading(float(course.line.project(point)))

    def courses(self) -> dict[str, tuple[tuple[float, float], ...]]:
        """Return the course of every edge in that plane."""
        return {course.edge: course.points for course in self._courses}

    def distance_mm(self, one: tuple[float, float], other: tuple[float, float], *, crs: str = WGS84) -> int:
        """Return the straight distance over ground between two positions, to the nearest mm."""
        (ax, ay), (bx, by) = self._to_plane(*one, crs), self._to_plane(*other, crs)
        return round(math.hypot(bx - ax, by - ay) * 1000)

    def _to_plane(self, x: float, y: float, crs: str) -> tuple[float, float]:
        if crs not in self._transformers:
            self.prepare(crs)
        east, north = self._transformers[crs].transform(x, y)
        if not (math.isfinite(x) and math.isfinite(y) and math.isfinite(east) and math.isfinite(north)):
            raise InputError(f"({x}, {y}) is no position in {crs}.")
        return east, north

    def _transformer(self, crs: str, to: str) -> Any:
        try:
            return self._pyproj.Transformer.from_crs(crs, to, always_xy=True)
        except self._pyproj.exceptions.CRSError as error:
            raise InputError(f"{crs!r} is no coordinate system: {error}.") from error

    def _degrees(self, edge: TrackEdge) -> tuple[tuple[float, float], ...]:
        assert isinstance(edge.geometry, Geometry)
        if edge.geometry.crs == WGS84:
            return edge.geometry.points
        transformer = self._transformer(edge.geometry.crs, WGS84)
        return tuple(transformer.transform(*point) for point in edge.geometry.points)

    def _course(self, edge: TrackEdge, degrees: tuple[tuple[float, float], ...]) -> _Course:
        points = tuple(self._to_plane(*point, WGS84) for point in degrees)
        steps = (math.dist(one, other) for one, other in pairwise(points))
        reached = tuple(accumulate(steps, initial=0.0))
        if not reached[-1] > 0:
            raise InputError(f"edge {edge.id!r}: its geometry has no length.")
        line = self._shapely.LineString(points)
        return _Course(edge.id, line, points, reached, edge.length_mm, _turns(points))


def _turns(points: Sequence[tuple[float, float]]) -> bool:
    """Return whether a course turns by a quarter circle or more in total, so that it may pass a place more than once."""
    headings = [math.atan2(by - ay, bx - ax) for (ax, ay), (bx, by) in pairwise(points) if (ax, ay) != (bx, by)]
    return sum(abs(math.remainder(after - before, math.tau)) for before, after in pairwise(headings)) >= math.pi / 2


def _shapely() -> Any:
    try:
        import shapely
        import shapely.ops
    except ImportError as error:
        raise missing("shapely", _PURPOSE) from error
    return shapely


def _pyproj() -> Any:
    try:
        import pyproj
    except ImportError as error:
        raise missing("pyproj", _PURPOSE) from error
    return pyproj


def _plane_at(courses: Sequence[Sequence[tuple[float, float]]]) -> str:
    """A transverse Mercator plane at the middle of all points: within 1e-5 of the true lengths 28 km around."""
    longitudes = [point[0] for course in courses for point in course]
    latitudes = [point[1] for course in courses for point in course]
    middle = (min(longitudes) + max(longitudes)) / 2, (min(latitudes) + max(latitudes)) / 2
    return f"+proj=tmerc +lon_0={middle[0]} +lat_0={middle[1]} +datum=WGS84 +units=m +no_defs"
