"""Finds the track of a fix, and its position along the way that the vehicle can have taken.

Positions along a way are in mm, in its own direction. A way is certain only as far as fixes that were passed on lie on it.
Beyond, the search follows every legal movement as far as the vehicle can be by now; a fix near two tracks that it can have
reached is ambiguous. A true fix is assumed to lie on one legal way with the vehicle, and off it by less than the clearance.
Needs the extra `geo`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import chain, combinations

from safeloc.errors import InputError
from safeloc.railway.map.model import Line
from safeloc.railway.map.places import Place, along
from safeloc.railway.map.projection import WGS84, Projected, Projector
from safeloc.railway.map.routes import Route
from safeloc.railway.map.topology import Run, Topology

_ONE_WAY_MM = 1_000
"""Ways to one run that differ in length by no more count as one; otherwise running there and back on both would give ever
more positions. The error added for a fix includes this difference."""


@dataclass(frozen=True, order=True)
class Laid:
    """A run, and the position along the way at which it begins."""

    start_mm: int
    run: Run

    def is_like(self, other: Laid) -> bool:
        """Return whether it is the same run at the same position, except for ways that differ in length by less than a metre."""
        return self.run == other.run and abs(self.start_mm - other.start_mm) <= _ONE_WAY_MM


@dataclass(frozen=True)
class Window:
    """The possible positions of the vehicle along the way, and its possible directions since the last fix."""

    from_mm: int
    to_mm: int
    forwards: bool = True
    backwards: bool = True

    def wider(self, by_mm: int) -> Window:
        """Return the window, longer on either side."""
        return replace(self, from_mm=self.from_mm - by_mm, to_mm=self.to_mm + by_mm)


@dataclass(frozen=True)
class Match:
    """The place of a fix on the map.

    place, offset_mm  nearest place on the track, and the distance off it, rounded up
    laid              the run of that place, as a piece of the way
    position_mm       position along the way
    ambiguous         another track that the vehicle can have reached lies too near
    elsewhere         no way leads there from the vehicle's possible positions
    possible          every piece of track that the vehicle can have reached
    """

    place: Place
    offset_mm: int
    laid: Laid
    position_mm: int
    ambiguous: bool = False
    elsewhere: bool = False
    possible: tuple[Laid, ...] = ()


class _Known:
    """The pieces of track that a search has met."""

    def __init__(self) -> None:
        self._pieces: dict[Run, list[Laid]] = {}

    def is_new(self, laid: Laid) -> bool:
        """Remember the piece; return whether it is like none before."""
        seen = self._pieces.setdefault(laid.run, [])
        if any(laid.is_like(other) for other in seen):
            return False
        seen.append(laid)
        return True


@dataclass(frozen=True)
class _Found:
    """A nearby place on a piece of the way."""

    projected: Projected
    laid: Laid
    position_mm: int


class Tracks:
    """The tracks of a line, or of one route on it, that a vehicle can be on.

    clear_mm   clearance: a fix determines the track only if no other track is nearer to it than this
    reach_mm   greatest distance of a fix from the vehicle's possible positions, along the track
    route      the pieces of the route, if one is given
    one_way    the vehicle runs on the route in its own direction only
    projector  projects positions onto the tracks
    roots      the pieces of track on which the vehicle can have been at the last accepted fix
    """

    def __init__(
        self,
        line: Line,
        *,
        clear_mm: int,
        reach_mm: int,
        route: Route | None = None,
        crs: str = WGS84,
        both_directions: bool = False,
    ) -> None:
        """With `both_directions` the vehicle may also run back on the route, for instance to set back or after a change of cabs.

        InputError for edges without a course.
        """
        self.topology = Topology(line)
        self.crs, self.clear_mm, self.reach_mm = crs, clear_mm, reach_mm
        self.route = None if route is None else tuple(_laid_along(route))
        self.one_way = route is not None and not both_directions
        edges = [edge.id for edge in line.edges] if route is None else sorted({run.edge for run in route.runs})
        _with_course(line, edges)
        self.projector = Projector(line, edges=edges)
        self.projector.prepare(crs)
        self.roots: tuple[Laid, ...] = self.route or ()

    def plane(self, x: float, y: float) -> tuple[float, float]:
        """Return a position in the plane of the map, in metres. InputError for coordinates outside the coordinate system."""
        return self.projector.plane(x, y, crs=self.crs)

    def heading(self, place: tuple[float, float]) -> float | None:
        """Return the direction of the route at a place of the plane, in radians from east to north. Without a route it is that of
        increasing positions of the nearest track; None if the route runs over that track in both directions."""
        edge, increasing = self.projector.heading(place)
        runs = {laid.run.direction for laid in self.route or () if laid.run.edge == edge} or {"increasing"}
        return None if len(runs) > 1 else increasing + (0.0 if runs == {"increasing"} else math.pi)

    def match(self, x: float, y: float, window: Window | None, *, alone: bool = False) -> Match:
        """Find the place of a fix. InputError for coordinates outside the coordinate system.

        window  possible positions of the vehicle; None while no position is held
        alone   the known way comes from fixes that may be false: any other track nearby makes the fix ambiguous
        """
        near = self.projector.near(x, y, self.clear_mm, crs=self.crs)
        if not near:
            beside = self._beginning([self.projector.project(x, y, crs=self.crs)])
            return replace(beside, elsewhere=self.route is None)
        if window is None and self.route is None:
            return self._beginning(near)
        wide = None if window is None else window.wider(self.reach_mm)
        possible = self.route or tuple(self._reached(self.roots, wide))
        found = [one for projected in near for one in self._laid(projected, possible, wide)]
        if not found:
            return replace(self._beginning(near), elsewhere=True)
        best = min(found, key=lambda one: abs(one.projected.offset_mm))
        ambiguous = not (self._one_place(found) and self._one_way(found))
        ambiguous = ambiguous or (alone and self._beginning(near).ambiguous)
        place, offset = best.projected.place, _up(best.projected)
        return Match(place, offset, best.laid, best.position_mm, ambiguous, possible=possible)

    def took(self, match: Match, window: Window) -> None:
        """Record a fix that was passed on or continues a row: the vehicle is in the window, on one way with the fix."""
        if self.route is None:
            joined = (laid for laid in match.possible if self._meets(laid, window) and self._joined(laid, match.laid))
            self.roots = tuple(sorted({match.laid, *joined}))

    def began(self, match: Match) -> None:
        """Record that only this fix determines the way."""
        if self.route is None:
            self.roots = (match.laid,)

    def place(self, position_mm: int) -> Place | None:
        """Return the place at a position along the way; None if no track, or more than one, is known there."""
        there = [laid for laid in self.roots if laid.start_mm <= position_mm <= self._end(laid)]
        if not there or not all(self._joined(one, there[0]) for one in there):
            return None
        laid = there[0]
        return Place(laid.run.edge, along(laid.run.direction, self._length(laid.run), position_mm - laid.start_mm))

    # -------------------------------------------------------------- places that the vehicle can have reached

    def _laid(self, projected: Projected, possible: Iterable[Laid], window: Window | None) -> Iterator[_Found]:
        """Yield a nearby place once for each possible piece of its edge on which it lies in the window."""
        for laid in possible:
            if laid.run.edge == projected.place.edge:
                position = laid.start_mm + self._within(laid.run, projected.place)
                if window is None or window.from_mm <= position <= window.to_mm:
                    yield _Found(projected, laid, position)

    def _reached(self, roots: Iterable[Laid], window: Window | None) -> Iterator[Laid]:
        """Yield every piece that the vehicle can have reached by legal movements over joints within the window."""
        known = _Known()
        waiting = [laid for laid in roots if known.is_new(laid)]
        while waiting:
            laid = waiting.pop()
            yield laid
            waiting += [other for other in self._next(laid, window) if known.is_new(other)]

    def _next(self, laid: Laid, window: Window | None) -> Iterator[Laid]:
        if window is None or (window.forwards and window.from_mm <= self._end(laid) <= window.to_mm):
            yield from (Laid(self._end(laid), run) for run in self.topology.after(laid.run))
        if window is None or (window.backwards and window.from_mm <= laid.start_mm <= window.to_mm):
            yield from (Laid(laid.start_mm - self._length(run), run) for run in self.topology.before(laid.run))

    def _meets(self, laid: Laid, window: Window) -> bool:
        return laid.start_mm <= window.to_mm and self._end(laid) >= window.from_mm

    # -------------------------------------------------------------- one place, one way

    def _one_place(self, found: Iterable[_Found]) -> bool:
        """Return whether the places are near each other along the way too; otherwise the way passes here twice."""
        positions = [one.position_mm for one in found]
        return max(positions) - min(positions) <= self._one_place_mm

    @property
    def _one_place_mm(self) -> int:
        return 4 * self.clear_mm + 1_000

    def _one_way(self, found: Iterable[_Found]) -> bool:
        """Return whether every two of the places lie on one legal way."""
        return all(self._joined(one, other) for one, other in combinations({one.laid for one in found}, 2))

    def _joined(self, one: Laid, other: Laid) -> bool:
        """Return whether one legal way leads over both."""
        first, last = sorted((one, other))
        ahead = Window(first.start_mm, last.start_mm + _ONE_WAY_MM, backwards=False)
        return any(here.is_like(last) for here in self._reached((first,), ahead))

    # -------------------------------------------------------------- no way is known

    def _beginning(self, near: Sequence[Projected]) -> Match:
        """Return the nearest place as the beginning of a way; ambiguous if another track is near."""
        first = self._first(near[0])
        position = first.start_mm + self._within(first.run, near[0].place)
        here = Window(position, position).wider(self._one_place_mm)
        ahead, behind = replace(here, backwards=False), replace(here, forwards=False)
        around = {*self._reached((first,), ahead), *self._reached((first,), behind)}
        beside = [list(self._laid(one, around, here)) for one in near[1:]]
        found = [_Found(near[0], first, position), *chain(*beside)]
        clear = all(beside) and self._one_place(found) and self._one_way(found)
        return Match(near[0].place, _up(near[0]), first, position, not clear)

    def _first(self, projected: Projected) -> Laid:
        """Return the piece of the route on this edge; without a route the edge itself, as a way that begins at 0."""
        if self.route is not None:
            return next(laid for laid in self.route if laid.run.edge == projected.place.edge)
        ways = (Run(projected.place.edge, "increasing"), Run(projected.place.edge, "decreasing"))
        return Laid(0, next(run for run in ways if run in self.topology.graph))

    def _within(self, run: Run, place: Place) -> int:
        return along(run.direction, self._length(run), place.position_mm)

    def _end(self, laid: Laid) -> int:
        return laid.start_mm + self._length(laid.run)

    def _length(self, run: Run) -> int:
        return self.topology.length_mm(run)


def _with_course(line: Line, edges: Iterable[str]) -> None:
    """Refuse edges without a course: no fix would lie on them, and none would be ambiguous because of them."""
    bare = {edge.id for edge in line.edges if edge.geometry is None} & set(edges)
    if bare:
        raise InputError(
            f"{line.name}: {len(bare)} edges have no course (geometry), such as {min(bare)!r}; positions cannot "
            "be matched to them. Add their courses, or name a way over other edges."
        )


def _laid_along(route: Route) -> Iterator[Laid]:
    """Return the runs of a route with the positions along it at which they begin."""
    start = -route.start_mm
    for run in route.runs:
        yield Laid(start, run)
        start += route.topology.length_mm(run)


def _up(projected: Projected) -> int:
    """Return the distance off the track, plus 1 mm for the rounding of place and distance."""
    return abs(projected.offset_mm) + 1
