"""Converts length of cable to place on the track: a cable is longer than its track, because of slack and loops in shafts.

Between surveyed points the map spreads the slack evenly; its greatest deviation from this is added to the error. Places on the
track are mm along the fibre's path, counted from the start of the path.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

from safeloc.errors import InputError
from safeloc.railway.map.elements import Fibre, FibrePoint, Stretch
from safeloc.sensing.rounding import Exact, ExactBounds


@dataclass(frozen=True)
class FibreMap:
    """Surveyed pairs (mm of fibre, mm along the path), at least two, fibre growing, path not falling.

    error_mm   greatest error of a place: deviation from an even spread of slack, and error of the survey
    """

    points: tuple[tuple[int, int], ...]
    error_mm: int = 5_000

    def __post_init__(self) -> None:
        if len(self.points) < 2 or self.error_mm < 0:
            raise InputError("a fibre map needs at least two surveyed points and an error >= 0 mm.")
        for (fibre, path), (later, further) in pairwise(self.points):
            if later <= fibre or further < path:
                raise InputError(
                    f"surveyed points must advance along fibre and path: ({later}, {further}) follows ({fibre}, {path})."
                )

    def path_mm(self, fibre_mm: Exact) -> Fraction:
        """Return the place along the path of a place on the fibre; beyond the outermost points the nearest piece is extended."""
        number = bisect_right(self.points, fibre_mm, key=lambda point: point[0]) - 1
        (fibre, path), (later, further) = (
            self.points[max(number, 0) :][:2] if number + 1 < len(self.points) else self.points[-2:]
        )
        return path + (fibre_mm - fibre) * Fraction(further - path, later - fibre)

    def on_track(self, fibre: ExactBounds) -> ExactBounds:
        """Return bounds along the path of a place with bounds on the fibre."""
        return ExactBounds(self.path_mm(fibre.low), self.path_mm(fibre.high)).widened(self.error_mm)


def from_line(fibre: Fibre, error_mm: int = 5_000) -> FibreMap:
    """Return the map of a line's fibre (safeloc.railway.map)."""
    return FibreMap(tuple((point.fibre_mm, _along(point, fibre)) for point in fibre.map_points), error_mm)


def _along(point: FibrePoint, fibre: Fibre) -> int:
    """Return the distance of a surveyed point along the path, on the first stretch that contains it."""
    run = 0
    for stretch in fibre.path:
        if point.edge == stretch.edge and _holds(stretch, point.position_mm):
            return run + abs(point.position_mm - stretch.from_mm)
        run += abs(stretch.to_mm - stretch.from_mm)
    raise InputError(f"the surveyed point at {point.fibre_mm} mm of fibre {fibre.id} does not lie on its path.")


def _holds(stretch: Stretch, position_mm: int) -> bool:
    return min(stretch.from_mm, stretch.to_mm) <= position_mm <= max(stretch.from_mm, stretch.to_mm)


def one_to_one(fibre_mm: int, error_mm: int = 0) -> FibreMap:
    """Return the map of a cable without slack."""
    return FibreMap(((0, 0), (fibre_mm, fibre_mm)), error_mm)


def place_of(path: Sequence[Stretch], path_mm: int) -> tuple[str, int]:
    """Return edge and position of a place along the path; InputError beyond the end of the path."""
    run = 0
    for stretch in path:
        length = abs(stretch.to_mm - stretch.from_mm)
        if run <= path_mm <= run + length:
            sign = 1 if stretch.to_mm > stretch.from_mm else -1
            return stretch.edge, stretch.from_mm + sign * (path_mm - run)
        run += length
    raise InputError(f"the path is {run} mm long and has no place {path_mm} mm along it.")
