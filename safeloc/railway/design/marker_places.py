"""Places where a marker, or a group that serves as one, may be added: as far from what is before it as the tolerance allows.

From one marker to the next the way is at most the longest run after a leading reading, or a vehicle's length and the longest run after a
trailing one. Both are tried from each entry of the map, from what stands, and from each new place, in either direction of travel, and
back from each way off the map; and both ends of each edge. Where these are too many, places near each other count as one.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from safeloc.railway.audit.marker_readings import Mark, Readings, accuracy_mm
from safeloc.railway.audit.rules import Rules
from safeloc.railway.design.figures import Added, Costs
from safeloc.railway.design.options import Option
from safeloc.railway.design.places import LARGEST_IDENTITY, free_names, new_group
from safeloc.railway.map.elements import Marker
from safeloc.railway.map.model import Line
from safeloc.railway.map.places import along
from safeloc.railway.map.topology import Run
from safeloc.railway.map.walk import Walk

_MOST_PLACES = 1_200
"""Of markers and groups together: half as many of each where both may be added."""
_APART_MM = (1, 1_000, 5_000, 10_000, 20_000, 50_000, 100_000, 200_000)
"""Places nearer than this on one edge count as one; the first of these figures that leaves few enough is taken."""
_LARGEST_MARKER = 1_000_000


@dataclass(frozen=True, eq=False)
class _Search:
    """The search for places of one kind of marker; `sample` is one of that kind, `room_mm` what it needs of the edge beyond its place."""

    readings: Readings
    sample: Mark
    room_mm: int
    apart_mm: int
    most: int
    found: dict[tuple[str, int], tuple[Run, int]] = field(default_factory=dict)

    def run(self) -> bool:
        """Find the places; False if they are too many."""
        open_ = [*self._ends(), *self._anchors()]
        while open_:
            run, offset = open_.pop(0)
            if not self._take(run, offset):
                continue
            if len(self.found) > self.most:
                return False
            for step in self._steps(self.sample, self.sample):
                open_ += self._ahead(run, offset + step)
        return True

    def _take(self, run: Run, offset: int) -> bool:
        length = self.readings.walk.topology.length_mm(run)
        position = min(along(run.direction, length, offset), length - self.room_mm)
        key = run.edge, position // self.apart_mm
        if position < 0 or key in self.found:
            return False
        self.found[key] = run, position
        return True

    def _steps(self, one: Mark, other: Mark) -> Iterator[int]:
        """Yield how far a marker may be from the one before it, after the leading and after the trailing reading."""
        readers = self.readings.layout.readers
        held = self.readings.held_mm(self.readings.fix_error_nm(one), readers.measured_in_a_cycle_mm)
        apart = one.accuracy_mm + other.accuracy_mm
        if held > apart:
            yield held - apart
            yield readers.vehicle_length_mm + held - apart - readers.vehicle_length_tolerance_mm

    def _ends(self) -> Iterator[tuple[Run, int]]:
        for run in self.readings.walk.runs:
            yield run, 0
            yield run, self.readings.walk.topology.length_mm(run)

    def _anchors(self) -> Iterator[tuple[Run, int]]:
        """Places as far as permitted ahead of an entry and of what stands, and behind what stands and a way off the map."""
        readers, topology = self.readings.layout.readers, self.readings.walk.topology
        for run in topology.entries():
            yield from self._ahead(
                run, self.readings.held_mm(0, readers.measured_in_a_cycle_mm) - self.sample.accuracy_mm
            )
        for mark, run, offset in self.readings.everywhere():
            for step in self._steps(mark, self.sample):
                yield from self._ahead(run, offset + step)
            for step in self._steps(self.sample, mark):
                yield from self._behind(run, offset - step)
        left = self.readings.held_mm(self.readings.fix_error_nm(self.sample), 0) - self.sample.accuracy_mm
        for run in topology.exits():
            for step in (left, readers.vehicle_length_mm + left - readers.vehicle_length_tolerance_mm):
                yield from self._behind(run, topology.length_mm(run) - step)

    def _ahead(self, run: Run, offset: int) -> Iterator[tuple[Run, int]]:
        """Yield the place at an offset from the start of a run, on every way that leads on from it."""
        open_, done, topology = [(run, offset)], set[tuple[Run, int]](), self.readings.walk.topology
        while open_:
            here, left = open_.pop()
            length = topology.length_mm(here)
            if (here, left) in done or left < 0:
                continue
            done.add((here, left))
            if left <= length:
                yield here, left
            else:
                open_ += [(after, left - length) for after in topology.after(here)]

    def _behind(self, run: Run, offset: int) -> Iterator[tuple[Run, int]]:
        """Yield the place at an offset from the start of a run, on every way that leads to it if that is below 0."""
        open_, done, topology = [(run, offset)], set[tuple[Run, int]](), self.readings.walk.topology
        while open_:
            here, left = open_.pop()
            if (here, left) in done:
                continue
            done.add((here, left))
            if left >= 0:
                yield here, left
            else:
                open_ += [(before, left + topology.length_mm(before)) for before in topology.before(here)]


def _places(readings: Readings, sample: Mark, room_mm: int, most: int) -> tuple[list[tuple[Run, int]], int]:
    for apart in _APART_MM:
        search = _Search(readings, sample, room_mm, apart, most)
        if search.run() or apart == _APART_MM[-1]:
            return list(search.found.values()), apart
    raise AssertionError("the last of these figures is always taken")


def marker_options(line: Line, rules: Rules, added: Added, costs: Costs) -> tuple[list[Option], int]:
    """Return an option for each place, with free names and identities, and how far apart places have to be to count as two.

    Markers are options where some may be added, groups where the readers read them.
    """
    readings, options, apart = Readings(Walk(line), rules), list[Option](), 1
    both = added.markers and rules.layout.readers.groups_are_markers
    most = _MOST_PLACES // (2 if both else 1)
    if added.markers:
        sample = _new_marker(Run(line.edges[0].id, "increasing"), 0, "sample", 1, added)
        found, apart = _places(readings, Mark(sample, accuracy_mm(sample, rules.layout)), 0, most)
        names = free_names([one.id for one in line.markers], "M")
        taken = {one.identity for one in line.markers}
        free = (number for number in range(1, _LARGEST_MARKER + 1) if number not in taken)
        marks = (
            _new_marker(*place, name, number, added) for place, name, number in zip(found, names, free, strict=False)
        )
        options += [Option(one, costs.of(one, new=True), True) for one in marks]
    if rules.layout.readers.groups_are_markers:
        first = new_group(Run(line.edges[0].id, "increasing"), 0, "sample", 0, added)
        found, apart_groups = _places(
            readings, Mark(first, accuracy_mm(first, rules.layout)), added.balise_spacing_mm, most
        )
        names = free_names([one.id for one in line.balise_groups], "N")
        known = {one.identity for one in line.balise_groups if one.country == 0}
        free = (number for number in range(1, LARGEST_IDENTITY + 1) if number not in known)
        groups = (
            new_group(*place, name, number, added) for place, name, number in zip(found, names, free, strict=False)
        )
        options += [Option(one, costs.of(one, new=True), True) for one in groups]
        apart = max(apart, apart_groups)
    return options, apart


def _new_marker(run: Run, position_mm: int, name: str, identity: int, added: Added) -> Marker:
    return Marker(
        id=name, edge=run.edge, position_mm=position_mm, identity=identity, accuracy_mm=added.marker_accuracy_mm
    )
