"""Projects geographic positions onto the track: nearest edge, place on it, and distance from it.

Needs the extra `geo` (shapely, pyproj). The projection uses a plane that touches the Earth at the middle of the line. The
place is then scaled to the edge's length on the map, so that distortion of the plane does not matter.
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
"""Half of the 10 m over which the direction of a track is taken, so that a corner of its mapped course is no turn."""
LAMBERT72 = "EPSG:31370"
_PURPOSE = "projecting positions to the track"


@dataclass(frozen=True)
class Projected:
    """A position, projected onto the track.

    place      the nearest place on the track, to the nearest mm
    offset_mm  distance of the position from it, to the nearest mm: positive to the right of the edge's increasing
               direction, negative to the left; beyond the end of a track, the distance to that end
    """

    place: Place
    offset_mm: int


@dataclass(frozen=True)
class _Course:
    """The course of an edge in the plane, with the map's length of the edge spread over its segments."""

    edge: str
    line: Any
    points: tuple[tuple[float, float], ...]
    reached: tuple[float, ...]
    length_mm: int
    turns: bool

    def place_mm(self, distance: float) -> int:
        """Return the position along the edge for a distance along the course in the plane."""
        return min(max(round(distance / self.reached[-1] * self.length_mm), 0), self.length_mm)

    def heading(self, distance: float) -> float:
        """Return the direction of increasing positions at this distance along the course, in radians from east to north."""
        begin = self.line.interpolate(max(distance - _HALF_CHORD_M, 0.0))
        end = self.line.interpolate(min(distance + _HALF_CHORD_M, self.reached[-1]))
        return math.atan2(end.y - begin.y, end.x - begin.x)

    def side(self, distance: float, x: float, y: float) -> int:
        """Return 1 if the point lies to the right of the course at this distance along it, -1 if to the left."""
        index = next((i for i, end in enumerate(self.reached[1:]) if end >= distance), len(self.reached) - 2)
        (ax, ay), (bx, by) = self.points[index], self.points[index + 1]
        return -1 if (bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0 else 1


class Projector:
    """Projects positions onto the edges of a line. InputError if none of the edges has a geometry."""

    def __init__(self, line: Line, *, edges: Sequence[str] | None = None) -> None:
        """`edges` restricts the projection to some edges, for instance those of a route."""
        self._shapely, self._pyproj = _shapely(), _pyproj()
        self._transformers: dict[tuple[str, str], Any] = {}
        chosen = [edge for edge in line.edges if edge.geometry is not None and (edges is None or edge.id in edges)]
        if not chosen:
            raise InputError(f"{line.name}: none of these edges has a geometry; positions cannot be projected to them.")
        degrees = [self._degrees(edge) for edge in chosen]
        self._plane = _plane_at(degrees)
        self._courses = [self._course(edge, points) for edge, points in zip(chosen, degrees, strict=True)]
        self._tree = self._shapely.STRtree([course.line for course in self._courses])

    def project(self, x: float, y: float, *, crs: str = WGS84) -> Projected:
        """Return the place nearest to a position.

        x, y  longitude and latitude in degrees for EPSG:4326; easting and northing otherwise, in the system's unit
        Raises InputError for coordinates that are not finite, or outside the area of `crs`.
        """
        east, north = self._to_plane(x, y, crs)
        point = self._shapely.Point(east, north)
        course = self._courses[int(self._tree.nearest(point))]
        along = float(course.line.project(point))
        off = round(float(course.line.distance(point)) * 1000)
        return Projected(Place(course.edge, course.place_mm(along)), off * course.side(along, east, north))

    def near(self, x: float, y: float, limit_mm: int, *, crs: str = WGS84) -> list[Projected]:
        """Return every place on the track within the limit that is nearest among its surroundings; the nearest first.

        An edge that passes by more than once has more than one such place. InputError as in `project`.
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
        """Return the distances along the course at which it is nearest to the point, one for each pass within the limit."""
        if not course.turns:
            return [float(course.line.project(point))]
        inside = course.line.intersection(point.buffer(limit * 1.01 + 0.001))
        pieces = [piece for piece in getattr(inside, "geoms", [inside]) if not piece.is_empty]
        nearest = (self._shapely.ops.nearest_points(piece, point)[0] for piece in pieces)
        return [float(course.line.project(one)) for one in nearest if one.distance(point) <= limit]

    def prepare(self, crs: str) -> None:
        """Prepare for positions of a coordinate system; InputError if it is unknown."""
        self._transformer(crs, self._plane)

    def plane(self, x: float, y: float, *, crs: str = WGS84) -> tuple[float, float]:
        """Return a position in the plane of the projection: metres east and north of the line's middle. InputError as above."""
        return self._to_plane(x, y, crs)

    def heading(self, place: tuple[float, float]) -> tuple[str, float]:
        """Return the edge nearest to a place of the plane, and its increasing direction there in radians from east to north."""
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
        east, north = self._transformer(crs, self._plane).transform(x, y)
        if not (math.isfinite(x) and math.isfinite(y) and math.isfinite(east) and math.isfinite(north)):
            raise InputError(f"({x}, {y}) is no position in {crs}.")
        return east, north

    def _transformer(self, crs: str, to: str) -> Any:
        made = self._transformers.get((crs, to))
        if made is not None:
            return made
        try:
            made = self._pyproj.Transformer.from_crs(crs, to, always_xy=True)
        except self._pyproj.exceptions.CRSError as error:
            raise InputError(f"{crs!r} is no coordinate system: {error}.") from error
        self._transformers[crs, to] = made
        return made

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
    """Return a transverse Mercator plane at the middle of all points; within 28 km lengths are true to 1e-5."""
    longitudes = [point[0] for course in courses for point in course]
    latitudes = [point[1] for course in courses for point in course]
    middle = (min(longitudes) + max(longitudes)) / 2, (min(latitudes) + max(latitudes)) / 2
    return f"+proj=tmerc +lon_0={middle[0]} +lat_0={middle[1]} +datum=WGS84 +units=m +no_defs"
