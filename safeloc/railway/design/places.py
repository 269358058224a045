"""Places where a group may be added: as far from what is before it as the tolerance allows, and at the ends of edges.

A new element can be moved on, in one direction of travel, until it is as far from the one before it as permitted, as near to the next
one as permitted, or at the end of its edge, without any stretch ahead becoming longer: so a line of least cost has one of which all
new groups stand at such places. Where these are too many, places near each other count as one.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from safeloc.railway.audit.stretches import ends_mm
from safeloc.railway.design.figures import Added, Costs
from safeloc.railway.design.options import Option
from safeloc.railway.design.reach import Reach
from safeloc.railway.map.elements import Balise, BaliseGroup
from safeloc.railway.map.model import Line
from safeloc.railway.map.places import along
from safeloc.railway.map.topology import Run
from safeloc.railway.map.walk import Reference, Walk

_MOST_PLACES = 2_500
_APART_MM = (1, 1_000, 5_000, 10_000, 20_000, 50_000, 100_000, 200_000)
"""Places nearer than this on one edge count as one; the first of these figures that leaves few enough is taken."""
_LARGEST_IDENTITY = 16_383


@dataclass(frozen=True)
class Places:
    """The places that are considered; `apart_mm`: places nearer than this count as one (1: all of them are considered)."""

    every: tuple[tuple[Run, int], ...]
    apart_mm: int


@dataclass(frozen=True, eq=False)
class _Search:
    line: Line
    reach: Reach
    added: Added
    apart_mm: int
    found: dict[tuple[str, int], tuple[Run, int]] = field(default_factory=dict)

    def run(self) -> bool:
        """Find the places; False if they are too many."""
        walk = Walk(self.line)
        sample = _new_group(Run(self.line.edges[0].id, "increasing"), 0, "sample", 0, self.added)
        open_ = [*self._ends(walk), *self._anchors(walk, sample), *self._before_groups(walk)]
        step = self.reach.limit(sample, sample).distance_mm
        while open_:
            run, offset = open_.pop(0)
            if not self._take(walk, run, offset):
                continue
            if len(self.found) > _MOST_PLACES:
                return False
            if step >= self._least_mm(sample):
                open_ += self._ahead(walk, run, offset + step)
        return True

    def _take(self, walk: Walk, run: Run, offset: int) -> bool:
        """Take a place, moved back on its edge if the group would not fit; return whether it is a new one."""
        length = walk.topology.length_mm(run)
        position = along(run.direction, length, offset)
        position = min(position, length - self.added.balise_spacing_mm)
        if position < 0:
            return False
        key = run.edge, position // self.apart_mm
        if key in self.found:
            return False
        self.found[key] = run, position
        return True

    def _ends(self, walk: Walk) -> Iterator[tuple[Run, int]]:
        for run in walk.runs:
            yield run, 0
            yield run, walk.topology.length_mm(run)

    def _anchors(self, walk: Walk, sample: BaliseGroup) -> Iterator[tuple[Run, int]]:
        """Places as far from an entry, or from what stands, as either direction of travel permits."""
        antenna = self.reach.layout.antenna_offset_mm
        for run in walk.topology.entries():
            for farthest in self._limits(None, sample):
                yield from self._ahead(walk, run, farthest - antenna)
        for seen in walk.everywhere():
            front = ends_mm(seen.element, seen.offset_mm, self.reach.layout)
            for farthest in self._limits(seen.element, sample):
                yield from self._ahead(walk, seen.run, front + farthest - antenna)

    def _limits(self, one: Reference | None, other: Reference) -> set[int]:
        return {self.reach.limit(one, other).distance_mm, self.reach.limit(other, one).distance_mm}

    def _before_groups(self, walk: Walk) -> Iterator[tuple[Run, int]]:
        """Places as near before a group as its window allows."""
        for seen in walk.everywhere():
            if isinstance(seen.element, BaliseGroup) and seen.element.linked:
                least = self._least_mm(seen.element)
                if seen.offset_mm >= least:
                    yield seen.run, seen.offset_mm - least

    def _least_mm(self, group: BaliseGroup) -> int:
        """The least distance between a group and a new one by the rule on windows."""
        layout = self.reach.layout
        accuracies = self.reach.accuracy_mm(group) + self.added.location_accuracy_mm
        return accuracies + 2 * (layout.tolerance_mm + layout.detection_accuracy_mm) + 1

    def _ahead(self, walk: Walk, run: Run, offset: int) -> Iterator[tuple[Run, int]]:
        """Yield the place at an offset from the start of a run, on every way that leads on from it."""
        open_, done = [(run, offset)], set[tuple[Run, int]]()
        while open_:
            here, left = open_.pop()
            length = walk.topology.length_mm(here)
            if (here, left) in done or left < 0:
                continue
            done.add((here, left))
            if left <= length:
                yield here, left
            else:
                open_ += [(after, left - length) for after in walk.topology.after(here)]


def places(line: Line, reach: Reach, added: Added) -> Places:
    """Return the places where a group may be added."""
    for apart in _APART_MM[:-1]:
        search = _Search(line, reach, added, apart)
        if search.run():
            return Places(tuple(search.found.values()), apart)
    search = _Search(line, reach, added, _APART_MM[-1])
    search.run()
    return Places(tuple(search.found.values()), _APART_MM[-1])


def _new_group(run: Run, position_mm: int, name: str, identity: int, added: Added) -> BaliseGroup:
    """Return a group of two balises in the order of the edge."""
    second = position_mm + added.balise_spacing_mm
    return BaliseGroup(
        id=name,
        edge=run.edge,
        identity=identity,
        balises=(Balise(position_mm=position_mm), Balise(position_mm=second)),
        location_accuracy_mm=added.location_accuracy_mm,
    )


def new_options(line: Line, reach: Reach, added: Added, costs: Costs) -> tuple[list[Option], int]:
    """Return an option for each place, with free names and identities, and how far apart places have to be to count as two."""
    found = places(line, reach, added)
    names = _free([one.id for one in line.balise_groups])
    taken = {one.identity for one in line.balise_groups if one.country == 0}
    identities = (one for one in range(1, _LARGEST_IDENTITY + 1) if one not in taken)
    options = []
    for (run, position), name, identity in zip(found.every, names, identities, strict=False):
        group = _new_group(run, position, name, identity, added)
        options.append(Option(group, costs.of(group, new=True), True))
    return options, found.apart_mm


def _free(taken: Sequence[str]) -> Iterator[str]:
    number = 0
    while True:
        number += 1
        if f"N{number}" not in taken:
            yield f"N{number}"
