"""Computes the course of a line in space, along which satellites are predicted (SAT-1; [0040], [0042]).

The courses of the edges and their gradients give Earth-fixed points, with the lengths of the map. Needs the extra `geo`
(pyproj).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import cached_property
from itertools import pairwise
from typing import Any

from safeloc.errors import InputError
from safeloc.language.units import MM_PER_M
from safeloc.railway.map.elements import Geometry, Gradient, TrackEdge
from safeloc.railway.map.imports.building import missing
from safeloc.railway.map.routes import Route
from safeloc.railway.map.topology import Run
from safeloc.sensing.satellite.places import Vector
from safeloc.sensing.satellite.track_prediction import Portion

_DEGREES, _DEGREES_AND_HEIGHT, _EARTH_FIXED = "EPSG:4326", "EPSG:4979", "EPSG:4978"


class LineTrack:
    """The possible ways of a vehicle: one route, or several with a common beginning while the way over a switch is unknown.

    Distances are metres along the routes. `start_height_m` is the height above the ellipsoid at their beginning; from there on
    it follows the gradients, and the track is level where the map has none. InputError for routes without a common beginning,
    and for an edge without geometry.
    """

    def __init__(self, routes: Sequence[Route], start_height_m: float) -> None:
        begins = {(route.runs[0], route.start_mm) for route in routes}
        if len(begins) != 1:
            raise InputError("the routes of a track need one common beginning; distances along them differ otherwise.")
        if not math.isfinite(start_height_m):
            raise InputError("the height where the route begins is not finite; give metres above the ellipsoid.")
        self.routes = tuple(routes)
        self._start_height_m = start_height_m

    def portions(self, low_m: float, high_m: float) -> list[Portion]:
        """Return the courses on which a vehicle between the two distances may be, one for each different way there."""
        found: dict[tuple[Run, ...], Portion] = {}
        for route, portion in zip(self.routes, self._portions, strict=True):
            found.setdefault(tuple(_runs_between(route, low_m * MM_PER_M, high_m * MM_PER_M)), portion)
        return list(found.values())

    @cached_property
    def _portions(self) -> list[Portion]:
        course = _Course(_pyproj(), self.routes[0].topology.line.gradients)
        return [course.portion(route, self._start_height_m) for route in self.routes]


def _runs_between(route: Route, low_mm: float, high_mm: float) -> Iterator[Run]:
    start = -route.start_mm
    for run in route.runs:
        end = start + route.topology.length_mm(run)
        if start <= high_mm and low_mm <= end:
            yield run
        start = end


class _Course:
    """Converts edges to points in space."""

    def __init__(self, pyproj: Any, gradients: Sequence[Gradient]) -> None:
        self._pyproj = pyproj
        self._gradients: dict[str, list[Gradient]] = {}
        for one in gradients:
            self._gradients.setdefault(one.edge, []).append(one)
        self._geod = pyproj.Geod(ellps="WGS84")
        self._space = pyproj.Transformer.from_crs(_DEGREES_AND_HEIGHT, _EARTH_FIXED, always_xy=True)

    def portion(self, route: Route, height_m: float) -> Portion:
        """Return the portion of a whole route, including the part of its first edge before its beginning."""
        points: list[Vector] = []
        lengths: list[float] = []
        first = route.topology.edges[route.runs[0].edge]
        height = height_m - self._climb_m(route, route.runs[0], route.start_mm)
        for run in route.runs:
            steps = self._steps(route.topology.edges[run.edge], run)
            for number, (place_mm, degrees) in enumerate(steps):
                point = self._space.transform(*degrees, height + self._climb_m(route, run, place_mm))
                if number == 0 and points:
                    continue
                points.append(point)
            lengths += [(b - a) / MM_PER_M for (a, _), (b, _) in pairwise(steps)]
            height += self._climb_m(route, run, route.topology.length_mm(run))
        if not all(map(math.isfinite, (value for point in points for value in point))):
            raise InputError(
                f"route {route.name}: a point of edge {first.id!r} or beyond is no place; mend the geometry."
            )
        return Portion(-route.start_mm / MM_PER_M, tuple(points), tuple(lengths))

    def _steps(self, edge: TrackEdge, run: Run) -> list[tuple[float, tuple[float, float]]]:
        """Return for every point the distance (mm) run on the edge, and its degrees, in the order of the run."""
        degrees = self._degrees(edge)
        if run.direction == "decreasing":
            degrees = degrees[::-1]
        pieces = self._geod.line_lengths([x for x, _ in degrees], [y for _, y in degrees])
        total, reached = sum(pieces), [0.0]
        if not total > 0:
            raise InputError(f"edge {edge.id!r}: its geometry has no length.")
        for piece in pieces:
            reached.append(reached[-1] + piece)
        kept = [n for n in range(len(degrees)) if n == 0 or reached[n] > reached[n - 1]]
        return [(reached[n] / total * edge.length_mm, degrees[n]) for n in kept]

    def _climb_m(self, route: Route, run: Run, to_mm: float) -> float:
        """Return the rise of the track from the start of a run to this distance."""
        length = route.topology.length_mm(run)
        low, high = sorted((_position(run, length, 0), _position(run, length, to_mm)))
        rises = (_rise_mm(one, low, high) for one in self._gradients.get(run.edge, ()))
        return (1 if run.direction == "increasing" else -1) * sum(rises) / MM_PER_M

    def _degrees(self, edge: TrackEdge) -> tuple[tuple[float, float], ...]:
        if not isinstance(edge.geometry, Geometry):
            raise InputError(f"edge {edge.id!r} has no geometry; satellites cannot be predicted along it.")
        if edge.geometry.crs == _DEGREES:
            return edge.geometry.points
        try:
            transformer = self._pyproj.Transformer.from_crs(edge.geometry.crs, _DEGREES, always_xy=True)
        except self._pyproj.exceptions.CRSError as error:
            raise InputError(f"edge {edge.id!r}: {edge.geometry.crs!r} is no coordinate system: {error}.") from error
        return tuple(transformer.transform(*point) for point in edge.geometry.points)


def _position(run: Run, length_mm: int, place_mm: float) -> float:
    return place_mm if run.direction == "increasing" else length_mm - place_mm


def _rise_mm(gradient: Gradient, low_mm: float, high_mm: float) -> float:
    within = min(gradient.to_mm, high_mm) - max(gradient.from_mm, low_mm)
    return max(within, 0.0) * gradient.rise_ppm / 1e6


def _pyproj() -> Any:
    try:
        import pyproj
    except ImportError as error:
        raise missing("pyproj", "laying a prediction along the track") from error
    return pyproj
