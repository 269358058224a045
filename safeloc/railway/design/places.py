"""Places where a group or a reflector may be added: as far from what is before it as the tolerance allows, and at the ends of edges.

A new element can be moved on, in one direction of travel, until it is as far from the one before it as permitted, as near to the next
one as permitted, or at the end of its edge, without any stretch ahead becoming longer: so a line of least cost has one of which all
new groups stand at such places. Where these are too many, places near each other count as one. A reflector has to be in view over a group
before it: the nearest and the farthest place for that are considered too.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import chain

from safeloc.railway.audit.stretches import begins_mm, ends_mm
from safeloc.railway.design.figures import Added, Costs
from safeloc.railway.design.options import Option
from safeloc.railway.design.reach import Reach
from safeloc.railway.map.elements import Balise, BaliseGroup, Reflector
from safeloc.railway.map.model import Line
from safeloc.railway.map.places import along
from safeloc.railway.map.topology import Run
from safeloc.railway.map.walk import Reference, Walk

_MOST_PLACES = 2_500
_MOST_WITH_REFLECTORS = 240
"""Fewer with reflectors: their rules speak of every two of them, and each place has an option for each model."""
_APART_MM = (1, 1_000, 5_000, 10_000, 20_000, 50_000, 100_000, 200_000)
"""Places nearer than this on one edge count as one; the first of these figures that leaves few enough is taken."""
LARGEST_IDENTITY = 16_383


@dataclass(frozen=True)
class Places:
    """The places that are considered; `apart_mm`: places nearer than this count as one (1: all of them are considered).

    groups, reflectors  the run and the position on its edge; reflectors are seen in the direction of the run
    """

    groups: tuple[tuple[Run, int], ...]
    reflectors: tuple[tuple[Run, int], ...]
    apart_mm: int


@dataclass(frozen=True)
class _Try:
    """A place that is to be considered: the offset from the start of a run."""

    kind: type[Reference]
    run: Run
    offset: int


@dataclass(frozen=True, eq=False)
class _Search:
    line: Line
    reach: Reach
    added: Added
    apart_mm: int
    groups: dict[tuple[str, int], tuple[Run, int]] = field(default_factory=dict)
    reflectors: dict[tuple[Run, int], tuple[Run, int]] = field(default_factory=dict)

    def run(self) -> bool:
        """Find the places; False if they are too many."""
        walk = Walk(self.line)
        samples = self._samples()
        most = _MOST_WITH_REFLECTORS if self.added.reflector_models else _MOST_PLACES
        open_ = [*self._ends(walk), *self._anchors(walk), *self._before_groups(walk), *self._in_view(walk)]
        while open_:
            one = open_.pop(0)
            if not self._take(walk, one):
                continue
            if len(self.groups) + len(self.reflectors) > most:
                return False
            open_ += self._onwards(walk, one, samples)
            open_ += self._beside(walk, one)
        return True

    def _samples(self) -> dict[type[Reference], Reference]:
        run = Run(self.line.edges[0].id, "increasing")
        group: Reference = new_group(run, 0, "sample", 0, self.added)
        return {BaliseGroup: group} | (
            {Reflector: _new_reflector(run, 0, "sample", "A", self.added)} if self.added.reflector_models else {}
        )

    def _take(self, walk: Walk, one: _Try) -> bool:
        """Take a place, moved back on its edge if a group would not fit; return whether it is a new one."""
        length = walk.topology.length_mm(one.run)
        position = along(one.run.direction, length, one.offset)
        if one.kind is BaliseGroup:
            position = min(position, length - self.added.balise_spacing_mm)
        if position < 0:
            return False
        place = position // self.apart_mm
        if one.kind is BaliseGroup:
            if (one.run.edge, place) in self.groups:
                return False
            self.groups[one.run.edge, place] = one.run, position
        else:
            if (one.run, place) in self.reflectors:
                return False
            self.reflectors[one.run, place] = one.run, position
        return True

    def _onwards(self, walk: Walk, one: _Try, samples: dict[type[Reference], Reference]) -> Iterator[_Try]:
        """Yield the places as far from a new element as the tolerance permits."""
        here = samples[one.kind]
        front = ends_mm(here, one.offset, self.reach.layout)
        for kind, other in samples.items():
            step = (
                front + self.reach.limit(here, other).distance_mm - begins_mm(other, 0, self.reach.layout) - one.offset
            )
            least = self._least_mm(here) if isinstance(here, BaliseGroup) and kind is BaliseGroup else 1
            if step >= least:
                yield from self._ahead(walk, kind, one.run, one.offset + step)

    def _ends(self, walk: Walk) -> Iterator[_Try]:
        for run in walk.runs:
            for kind in self._samples():
                yield _Try(kind, run, 0)
                yield _Try(kind, run, walk.topology.length_mm(run))
            if self.reach.layout.tells_track and walk.topology.after(run):  # as near before the joint as a group may be
                behind = self.added.balise_spacing_mm if run.direction == "increasing" else 0
                yield _Try(BaliseGroup, run, walk.topology.length_mm(run) - self.reach.to_joint_mm - behind)

    def _anchors(self, walk: Walk) -> Iterator[_Try]:
        """Places as far from an entry, or from what stands, as either direction of travel permits."""
        for kind, sample in self._samples().items():
            begins = begins_mm(sample, 0, self.reach.layout)
            for run in walk.topology.entries():
                for farthest in self._limits(None, sample):
                    yield from self._ahead(walk, kind, run, farthest - begins)
            for seen in walk.everywhere():
                front = ends_mm(seen.element, seen.offset_mm, self.reach.layout)
                for farthest in self._limits(seen.element, sample):
                    yield from self._ahead(walk, kind, seen.run, front + farthest - begins)

    def _limits(self, one: Reference | None, other: Reference) -> set[int]:
        return {self.reach.limit(one, other).distance_mm, self.reach.limit(other, one).distance_mm}

    def _before_groups(self, walk: Walk) -> Iterator[_Try]:
        """Places as near before a group as its window allows."""
        for seen in walk.everywhere():
            if isinstance(seen.element, BaliseGroup) and seen.element.linked:
                least = self._least_mm(seen.element)
                if seen.offset_mm >= least:
                    yield _Try(BaliseGroup, seen.run, seen.offset_mm - least)

    def _in_view(self, walk: Walk) -> Iterator[_Try]:
        """Places of new reflectors that are in view over what stands, and of groups over which those that stand are in view."""
        for seen in walk.everywhere():
            yield from self._beside(walk, _Try(type(seen.element), seen.run, seen.offset_mm), seen.element)

    def _beside(self, walk: Walk, one: _Try, stands: Reference | None = None) -> Iterator[_Try]:
        """Yield the nearest and the farthest place at which a reflector is in view over a group (RFL-6), for one of both."""
        if not self.added.reflector_models:
            return
        layout = self.reach.layout
        view = stands if isinstance(stands, Reflector) else self.added
        allowance = layout.detection_accuracy_mm + layout.map_accuracy_mm
        apart = layout.antenna_offset_mm - layout.sensor_offset_mm
        for distance in (view.view_from_mm - allowance + apart, view.view_to_mm + allowance + apart):
            if one.kind is BaliseGroup:
                yield from self._ahead(walk, Reflector, one.run, one.offset + distance)
            elif one.offset >= distance:
                yield _Try(BaliseGroup, one.run, one.offset - distance)

    def _least_mm(self, group: BaliseGroup) -> int:
        """The least distance between a group and a new one by the rule on windows."""
        layout = self.reach.layout
        accuracies = self.reach.accuracy_mm(group) + self.added.location_accuracy_mm
        return accuracies + 2 * (layout.tolerance_mm + layout.detection_accuracy_mm) + 1

    def _ahead(self, walk: Walk, kind: type[Reference], run: Run, offset: int) -> Iterator[_Try]:
        """Yield the place at an offset from the start of a run, on every way that leads on from it."""
        open_, done = [(run, offset)], set[tuple[Run, int]]()
        while open_:
            here, left = open_.pop()
            length = walk.topology.length_mm(here)
            if (here, left) in done or left < 0:
                continue
            done.add((here, left))
            if left <= length:
                yield _Try(kind, here, left)
            else:
                open_ += [(after, left - length) for after in walk.topology.after(here)]


def places(line: Line, reach: Reach, added: Added) -> Places:
    """Return the places where a group or a reflector may be added."""
    for apart in _APART_MM[:-1]:
        search = _Search(line, reach, added, apart)
        if search.run():
            return Places(tuple(search.groups.values()), tuple(search.reflectors.values()), apart)
    search = _Search(line, reach, added, _APART_MM[-1])
    search.run()
    return Places(tuple(search.groups.values()), tuple(search.reflectors.values()), _APART_MM[-1])


def new_group(run: Run, position_mm: int, name: str, identity: int, added: Added) -> BaliseGroup:
    """Return a group of two balises in the order of the edge."""
    second = position_mm + added.balise_spacing_mm
    return BaliseGroup(
        id=name,
        edge=run.edge,
        identity=identity,
        balises=(Balise(position_mm=position_mm), Balise(position_mm=second)),
        location_accuracy_mm=added.location_accuracy_mm,
    )


def _new_reflector(run: Run, position_mm: int, name: str, model: str, added: Added) -> Reflector:
    """Return a reflector that vehicles see which pass its edge in the direction of the run."""
    return Reflector(
        id=name,
        edge=run.edge,
        position_mm=position_mm,
        model=model,
        direction=run.direction,
        lateral_offset_mm=added.lateral_offset_mm,
        view_from_mm=added.view_from_mm,
        view_to_mm=added.view_to_mm,
    )


def new_options(line: Line, reach: Reach, added: Added, costs: Costs) -> tuple[list[Option], int]:
    """Return an option for each place, with free names and identities, and how far apart places have to be to count as two.

    A reflector is an option for each model.
    """
    found = places(line, reach, added)
    names = free_names([one.id for one in line.balise_groups], "N")
    taken = {one.identity for one in line.balise_groups if one.country == 0}
    identities = (one for one in range(1, LARGEST_IDENTITY + 1) if one not in taken)
    options = []
    for (run, position), name, identity in zip(found.groups, names, identities, strict=False):
        group = new_group(run, position, name, identity, added)
        options.append(Option(group, costs.of(group, new=True), True))
    free, models = free_names([one.id for one in line.reflectors], "R"), _models(line, added.reflector_models)
    for run, position in found.reflectors:
        for model in models:
            one = _new_reflector(run, position, next(free), model, added)
            options.append(Option(one, costs.of(one, new=True), True))
    return options, found.apart_mm


def _models(line: Line, count: int) -> list[str]:
    """Return the models of new reflectors: those on the line first, then new ones."""
    standing = sorted({one.model for one in line.reflectors})
    letters = (f"{letter}{round_ or ''}" for round_ in range(count + 1) for letter in "ABCDEFGHIJKLMNOPQRSTUVWXYZ")
    return [*dict.fromkeys(chain(standing, letters))][:count]


def free_names(taken: Sequence[str], letter: str) -> Iterator[str]:
    """Yield names that are not taken: the letter with a number."""
    number = 0
    while True:
        number += 1
        if f"{letter}{number}" not in taken:
            yield f"{letter}{number}"
