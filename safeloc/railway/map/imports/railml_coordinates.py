"""Geometric coordinates of net elements: the course of an edge, and its length where the document states none.

x is the longitude or easting, y the latitude or northing, whatever the order of axes in the system's own definition.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from itertools import pairwise
from typing import Any

from safeloc.errors import InputError
from safeloc.railway.map.elements import Geometry
from safeloc.railway.map.imports.building import made, missing
from safeloc.railway.map.imports.lengths import decimal
from safeloc.railway.map.imports.notes import Note
from safeloc.railway.map.imports.railml_xml import Element

_LONGER = 1.01
"""A course by coordinates cuts corners; one that is longer than the stated length by more than this contradicts it."""
_MILLIMETRE = Decimal("0.001")


@dataclass(frozen=True)
class Course:
    """The course of a net element: coordinates from its beginning to its end, in one coordinate system."""

    geometry: Geometry
    length_m: Decimal

    def contradicts(self, stated_m: Decimal) -> bool:
        """Return whether the course is longer than a stated length, although straight pieces are the shortest way."""
        return float(self.length_m) > float(stated_m) * _LONGER


def coordinate_systems(root: Element) -> dict[str, str]:
    """Return the coordinate system of each geometric positioning system, for instance `EPSG:25832`."""
    found = {}
    for system in root.all("common", "positioning", "geometricPositioningSystems", "geometricPositioningSystem"):
        definition = system.get("crsDefinition")
        if definition is not None:
            found[system.need("id")] = definition.upper()
    return found


def course(element: Element, systems: Mapping[str, str], notes: list[Note]) -> Course | None:
    """Return the course of a net element; None, with a note where coordinates are given but tell no course.

    Raises InputError for coordinates that are no numbers or in no known coordinate system.
    """
    points = _points(element)
    if not points:
        return None
    system = next(iter(points))
    for other in list(points)[1:]:
        notes.append(Note("not carried over", element.place, f"second set of coordinates {other!r}"))
    ordered = sorted(points[system], key=lambda point: point[0])
    if len(ordered) < 2 or ordered[0][0] != 0 or ordered[-1][0] != 1:
        notes.append(
            Note("not carried over", element.place, "coordinates that are not given from its beginning to its end")
        )
        return None
    if system not in systems:
        remark = f"coordinates in {system!r}, which is no geometricPositioningSystem with a crsDefinition"
        notes.append(Note("not carried over", element.place, remark))
        return None
    places = tuple((x, y) for _, x, y, _ in ordered)
    heights = [z for *_, z in ordered]
    length_m = _length_m(places, heights, systems[system], element.place)
    return Course(made(Geometry, element.place, crs=systems[system], points=places), length_m)


def _points(element: Element) -> dict[str, list[tuple[Decimal, float, float, float | None]]]:
    """Return share of the length, x, y and height of every coordinate, by positioning system."""
    found: dict[str, list[tuple[Decimal, float, float, float | None]]] = {}
    for system in element.all("associatedPositioningSystem"):
        for point in system.all("intrinsicCoordinate"):
            for coordinate in point.all("geometricCoordinate"):
                share = decimal(point.need("intrinsicCoord"), f"{point.place}: intrinsicCoord")
                x, y = (float(decimal(coordinate.need(name), f"{coordinate.place}: {name}")) for name in ("x", "y"))
                stated = coordinate.get("z")
                height = None if stated is None else float(decimal(stated, f"{coordinate.place}: z"))
                found.setdefault(coordinate.need("positioningSystemRef"), []).append((share, x, y, height))
    return found


def _length_m(points: Sequence[tuple[float, float]], heights: Sequence[float | None], crs: str, place: str) -> Decimal:
    """Return the length over the ellipsoid or in the plane, to the nearest mm; pieces with a height at both ends rise by it."""
    system = _system(crs, place)
    geod = system.get_geod()
    unit = 1.0 if system.is_geographic else float(system.axis_info[0].unit_conversion_factor)
    total = 0.0
    for (one, other), (low, high) in zip(pairwise(points), pairwise(heights), strict=True):
        flat = geod.line_length(*zip(one, other, strict=True)) if system.is_geographic else math.dist(one, other) * unit
        total += math.hypot(flat, 0.0 if low is None or high is None else high - low)
    if not math.isfinite(total):
        raise InputError(f"{place}: its coordinates are outside {crs}.")
    return Decimal(total).quantize(_MILLIMETRE)


def _system(crs: str, place: str) -> Any:
    try:
        from pyproj import CRS
        from pyproj.exceptions import CRSError
    except ImportError as error:
        raise missing("pyproj", "measuring coordinates of railML") from error
    try:
        system = CRS(crs)
    except CRSError as error:
        raise InputError(f"{place}: {crs!r} is no coordinate system; use one like EPSG:25832.") from error
    if not (system.is_geographic or system.is_projected):
        raise InputError(f"{place}: {crs!r} is neither geographic nor projected; use one like EPSG:25832.")
    return system
