"""Readings of markers along all routes: where the leading and the trailing reader pass a marker, and what keeps the position until then.

Places are those of the end of the vehicle that leads. The leading reader passes a marker where the marker stands, the trailing one when
the leading end is a vehicle's length beyond. A reading is reached with a position if some earlier one is near enough: each of them, since
the machine keeps the better position. Of the ways that lead to a reading the worst counts.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property

import networkx as nx

from safeloc.language.expr import as_num
from safeloc.language.interpret import evaluate
from safeloc.language.units import MM, NM, NM_PER_MM
from safeloc.models.layout_rules import LayoutConfig
from safeloc.models.layout_rules.markers import longest_run_mm
from safeloc.railway.audit.rules import UNBOUNDED, Rules
from safeloc.railway.map.elements import BaliseGroup, Marker
from safeloc.railway.map.routes import Inventory
from safeloc.railway.map.topology import Run
from safeloc.railway.map.walk import Walk


@dataclass(frozen=True)
class Mark:
    """A marker, or a balise group that serves as one: it is read within `accuracy_mm` of its place on the map."""

    element: Marker | BaliseGroup
    accuracy_mm: int

    @property
    def name(self) -> str:
        """Its name for messages."""
        return f"{'marker' if isinstance(self.element, Marker) else 'balise group'} {self.element.id}"


@dataclass(frozen=True)
class Goal:
    """A place that has to be reached with a position: a reading of `mark`, or without one the end of the map or a joint.

    path  the runs from the marker to the place, where the trailing reader reads it; empty for the leading reader
    """

    run: Run
    offset_mm: int
    name: str
    mark: Mark | None = None
    path: tuple[Run, ...] = ()

    @property
    def accuracy_mm(self) -> int:
        """The distance from its place on the map within which it is."""
        return 0 if self.mark is None else self.mark.accuracy_mm


@dataclass(frozen=True)
class Origin:
    """A reading, or the edge of the map, from which a goal is reached: its name, the figures of the rule, and what is to spare, mm."""

    origin: str
    mark: Mark | None
    figures: dict[str, int] = field(compare=False)
    spare_mm: int


@dataclass(frozen=True)
class Pair:
    """Two markers on one route, the second at that place and so far ahead of the first."""

    first: Mark
    second: Mark
    run: Run
    offset_mm: int
    distance_mm: int


@dataclass(frozen=True)
class _Back:
    """The next piece of a way back: a run, how far its end is from the goal, and the runs that have to come before it.

    found   what was found nearer to the goal; beyond: the runs that were passed where nothing keeps the position any more
    """

    run: Run
    end: int
    forced: tuple[Run, ...]
    found: tuple[Origin, ...] = ()
    beyond: frozenset[Run] = frozenset()


@dataclass(frozen=True)
class Way:
    """A way that leads to a goal: what may keep the position, from the nearest on, as far as it was followed."""

    origins: tuple[Origin, ...]


def accuracy_mm(element: Marker | BaliseGroup, layout: LayoutConfig) -> int:
    """Return the distance from its place on the map within which a marker is read."""
    if isinstance(element, BaliseGroup):
        return layout.balise_fix_mm(element.location_accuracy_mm)
    return layout.readers.marker_accuracy_mm if element.accuracy_mm is None else element.accuracy_mm


class Readings:
    """The readings on one line for one vehicle's figures."""

    def __init__(self, walk: Walk, rules: Rules) -> None:
        self.walk, self.layout = walk, rules.layout
        self._held: dict[tuple[int, int], int] = {}
        self._errors: dict[int, int] = {}

    @cached_property
    def marks(self) -> dict[Run, list[tuple[int, Mark]]]:
        """For every run its markers, each with the distance from the run's start."""
        inventory = Inventory(self.walk.line)
        kinds = (Marker, BaliseGroup) if self.layout.readers.groups_are_markers else (Marker,)
        return {
            run: [
                (offset, Mark(element, accuracy_mm(element, self.layout)))
                for offset, element in inventory.along(run, self.walk.topology.length_mm(run))
                if isinstance(element, kinds)
            ]
            for run in self.walk.runs
        }

    def everywhere(self) -> Iterator[tuple[Mark, Run, int]]:
        """Yield every marker with run and offset, once for each direction in which vehicles pass it."""
        for run, there in self.marks.items():
            for offset, mark in there:
                yield mark, run, offset

    @cached_property
    def widest_mm(self) -> int:
        """Twice the greatest distance of a marker from its place on the map."""
        return 2 * max((mark.accuracy_mm for mark, _, _ in self.everywhere()), default=0)

    # ------------------------------------------------------------------ goals

    def goals(self) -> Iterator[Goal]:
        """Yield every reading by either reader, every way off the map, and the joints in loops."""
        for mark, run, offset in self.everywhere():
            yield Goal(run, offset, mark.name, mark)
            yield from self._trailing(mark, run, offset)
        for run in self.walk.topology.exits():
            yield Goal(run, self.walk.topology.length_mm(run), "the end of the map")
        yield from self._in_loops()

    def _in_loops(self) -> Iterator[Goal]:
        """Yield the end of each run that a vehicle may come back to, since a loop may have no marker and no way off the map."""
        topology = self.walk.topology
        for part in nx.strongly_connected_components(topology.graph):
            for run in sorted(part) if len(part) > 1 else ():
                yield Goal(run, topology.length_mm(run), f"the joint at {topology.end(run)}")

    def _trailing(self, mark: Mark, run: Run, offset: int) -> Iterator[Goal]:
        open_: list[tuple[tuple[Run, ...], int]] = [((run,), offset + self.layout.readers.vehicle_length_mm)]
        while open_:
            path, left = open_.pop()
            length = self.walk.topology.length_mm(path[-1])
            if left <= length:
                yield Goal(path[-1], left, f"the trailing reading of {mark.name}", mark, path)
            else:
                open_ += [((*path, after), left - length) for after in self.walk.topology.after(path[-1])]

    # ------------------------------------------------------------------ what keeps the position until a goal

    def worst(self, goal: Goal) -> Origin:
        """Return what keeps the position best on the worst of all ways to a goal."""
        best = (max(way.origins, key=lambda one: one.spare_mm) for way in self.ways(goal, 0))
        return min(best, key=lambda one: (one.spare_mm, one.origin))

    def ways(self, goal: Goal, enough_mm: int | None) -> Iterator[Way]:
        """Yield the ways that lead to a goal, each as far back as something may keep the position.

        enough_mm  a way is followed no farther once something has so much to spare; None: always as far as that, and of what cannot
                   keep the position only the nearest is told
        """
        topology, done = self.walk.topology, set[tuple[Run, int, int]]()
        open_ = [_Back(goal.run, goal.offset_mm - topology.length_mm(goal.run), goal.path[:-1])]
        while open_:
            one = open_.pop()
            found, start = (
                (*one.found, *self._on(goal, one.run, one.end, with_far=enough_mm is not None)),
                one.end + topology.length_mm(one.run),
            )
            before = one.forced[-1:] or tuple(topology.before(one.run))
            if not before:
                found = (*found, self._entry(goal, one.run, start))
            spare, beyond = max((each.spare_mm for each in found), default=-UNBOUNDED), start > self.window_mm
            if not before or (found and beyond) or (enough_mm is not None and spare >= enough_mm):
                yield Way(found)
            elif beyond and one.run in one.beyond:
                yield Way((self._never(goal),))
            elif (known := (one.run, -1, 0) if beyond else (one.run, start, hash(found))) not in done:
                done.add(known)
                passed = one.beyond | {one.run} if beyond else one.beyond
                open_ += [_Back(each, start, one.forced[:-1], found, passed) for each in before]

    @cached_property
    def window_mm(self) -> int:
        """Farther behind, no reading keeps the position."""
        return max(self.held_mm(0, 0), 0) + self.layout.readers.vehicle_length_mm

    def _on(self, goal: Goal, run: Run, end: int, *, with_far: bool) -> Iterator[Origin]:
        """Yield the readings by both readers of the markers on one run that come before the goal, the nearest first.

        with_far  those too far behind to keep the position as well; without it the nearest of them at most
        """
        length, long = self.walk.topology.length_mm(run), self.layout.readers.vehicle_length_mm
        passed = bisect_left(self.marks[run], end + length, key=lambda one: one[0])
        for number, (offset, mark) in enumerate(reversed(self.marks[run][:passed])):
            behind = end + length - offset
            if number and behind > self.window_mm and not with_far:
                return
            own = mark is goal.mark and bool(goal.path) and behind == long
            apart = (0 if own else mark.accuracy_mm + goal.accuracy_mm) + self._length_off(bool(goal.path))
            yield self._origin(mark.name, mark, goal, behind, apart)
            if behind >= long and not own:
                apart = mark.accuracy_mm + goal.accuracy_mm + self._length_off(not goal.path)
                yield self._origin(f"the trailing reading of {mark.name}", mark, goal, behind - long, apart)

    def _length_off(self, counts: bool) -> int:
        """The true length may differ from the vehicle's data where only one of two readings is the trailing one."""
        return self.layout.readers.vehicle_length_tolerance_mm if counts else 0

    def _entry(self, goal: Goal, run: Run, distance: int) -> Origin:
        name = f"the edge of the map at {self.walk.topology.start(run)}"
        apart = goal.accuracy_mm + self._length_off(bool(goal.path))
        return self._origin(name, None, goal, distance, apart)

    def _never(self, goal: Goal) -> Origin:
        return self._origin("a loop without any marker", None, goal, UNBOUNDED, 0)

    def _origin(self, name: str, mark: Mark | None, goal: Goal, distance: int, apart: int) -> Origin:
        fix = 0 if mark is None else self.fix_error_nm(mark)
        held_back = 0 if goal.mark is None else self.layout.readers.measured_in_a_cycle_mm
        figures = {"distance_mm": distance, "fix_error_nm": fix, "apart_mm": apart, "held_back_mm": held_back}
        return Origin(name, mark, figures, self.held_mm(fix, held_back) - apart - distance)

    def fix_error_nm(self, mark: Mark) -> int:
        """Return the error of a position just read from a marker, nm."""
        if mark.accuracy_mm not in self._errors:
            rate_ppm = self.layout.odometry_rate_ppm
            self._errors[mark.accuracy_mm] = self.layout.readers.fix_error_nm(mark.accuracy_mm, rate_ppm)
        return self._errors[mark.accuracy_mm]

    def held_mm(self, fix_error_nm: int, held_back_mm: int) -> int:
        """Return the run over which the position is kept after a reading with that error."""
        key = fix_error_nm, held_back_mm
        if key not in self._held:
            self._held[key] = self._longest(*key)
        return self._held[key]

    def _longest(self, fix_error_nm: int, held_back_mm: int) -> int:
        layout = self.layout
        if layout.odometry_rate_ppm == 0:
            fits = fix_error_nm <= (layout.tolerance_mm - layout.odometry_constant_mm) * NM_PER_MM
            return UNBOUNDED // 4 if fits else -UNBOUNDED
        return int(evaluate([longest_run_mm(as_num(fix_error_nm, NM), as_num(held_back_mm, MM), layout)], {})[0])

    # ------------------------------------------------------------------ markers near each other

    def pairs(self, reach_mm: int) -> Iterator[Pair]:
        """Yield every two markers that are no farther apart than that on some route, the second ahead of the first."""
        for first, run, offset in self.everywhere():
            for start, here in self.walk.runs_ahead(run, offset, reach_mm):
                for place, second in self.marks[here]:
                    if 0 <= start + place <= reach_mm and second is not first and second.element != first.element:
                        yield Pair(first, second, here, place, start + place)

    def under_the_vehicle(self, mark: Mark, run: Run, offset: int) -> tuple[Mark, ...]:
        """Return the most markers that may be under the vehicle on one route when its leading reader passes this one, which counts too."""
        readers = self.layout.readers
        long = readers.vehicle_length_mm + readers.vehicle_length_tolerance_mm + mark.accuracy_mm
        most: tuple[Mark, ...] = ()
        open_: list[tuple[Run, int, tuple[Mark, ...]]] = [(run, offset - self.walk.topology.length_mm(run), ())]
        done = set[tuple[Run, int, tuple[Mark, ...]]]()
        while open_:
            here, end, under = open_.pop()
            length = self.walk.topology.length_mm(here)
            under += tuple(one for at, one in self.marks[here] if 0 < end + length - at < long + one.accuracy_mm)
            most = max(most, under, key=len)
            if end + length < long + self.widest_mm // 2 and (here, end, under) not in done:
                done.add((here, end, under))
                open_ += [(before, end + length, under) for before in self.walk.topology.before(here)]
        return (*most, mark)
