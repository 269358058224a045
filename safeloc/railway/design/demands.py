"""Demands of the rules on a selection, as clauses over all options at once: stretches, pairs that are too near, single elements.

Every clause is implied by a rule of the audit, or by the bound of the balise machine: a selection that breaks one has a finding, or
loses its position. What these clauses do not cover is found by the audit itself (`safeloc.railway.design.repairs`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from heapq import heappop, heappush

from safeloc.railway.audit.edges import groups_before_joints
from safeloc.railway.audit.rules import Rules
from safeloc.railway.audit.stretches import begins_mm, ends_mm
from safeloc.railway.design.least_cost import Demand
from safeloc.railway.design.options import Options
from safeloc.railway.design.reach import Reach, kind_of_reach
from safeloc.railway.map.clearance import pairs
from safeloc.railway.map.elements import BaliseGroup, Marker
from safeloc.railway.map.topology import Run
from safeloc.railway.map.walk import Reference


@dataclass(frozen=True)
class Ahead:
    """A reference on one way ahead of an origin, or the end of the map (None): how far it is on the map, and whether that is near enough."""

    element: Reference | None
    distance_mm: int
    near: bool


@dataclass(frozen=True, eq=False)
class Stretching:
    """The stretches between options."""

    options: Options
    reach: Reach

    def demands(self) -> Iterator[Demand]:
        """Yield the demands on all stretches: from each entry of the map and each option to the next reference, on every way."""
        most, entered = self._most_mm, self._since_entry()
        for origin, run, passed, front in self._origins():
            window = max(most + self._slack_mm, self.reach.limit(None, None).distance_mm - entered[run] - front)
            for way in self._ways(origin, run, passed, front, window):
                yield from self._of_way(origin, way)
                yield from self._of_window(way, window)

    def ways_of_all(self) -> Iterator[tuple[Reference | None, Run, list[Ahead]]]:
        """Yield every origin with its run and the references on each way ahead, in order."""
        for origin, run, passed, front in self._origins():
            for way in self._ways(origin, run, passed, front, 0):
                yield origin, run, way

    @cached_property
    def _most_mm(self) -> int:
        """The longest stretch between any two options."""
        read = [one.element for one in self.options.every if not isinstance(one.element, Marker)]
        elements = list({kind_of_reach(one): one for one in read}.values())
        return max(
            (self.reach.limit(one, other).distance_mm for one in elements for other in [*elements, None]), default=0
        )

    @cached_property
    def _slack_mm(self) -> int:
        """The distance by which a vehicle's front may leave a reference later than one that lies behind it: antenna and radar are apart."""
        layout = self.reach.layout
        apart = layout.antenna_offset_mm - layout.sensor_offset_mm
        return max((abs(apart + one.view_to_mm) for one in self.options.walk.line.reflectors), default=0)

    def _since_entry(self) -> dict[Run, int]:
        """Return the shortest distance from an entry of the map to the start of each run."""
        walk = self.options.walk
        open_ = [(0, run) for run in walk.topology.entries()]
        found: dict[Run, int] = {}
        while open_:
            distance, run = heappop(open_)
            if run not in found:
                found[run] = distance
                for after in walk.topology.after(run):
                    heappush(open_, (distance + walk.topology.length_mm(run), after))
        return {run: found.get(run, 0) for run in walk.runs}

    def _of_window(self, way: list[Ahead], window_mm: int) -> Iterator[Demand]:
        """Whatever was passed last, the next reference lies within the longest stretch from here: these demands make the bound tight."""
        if way and way[-1].element is None and way[-1].distance_mm <= window_mm:
            return
        within = (one.element for one in way if one.distance_mm <= window_mm and one.element is not None)
        yield Demand(frozenset(self.options.number_of(one) for one in within))

    def _origins(self) -> Iterator[tuple[Reference | None, Run, int, int]]:
        """Yield every origin with its run, how many references of it are passed there, and the place of the vehicle's front."""
        walk = self.options.walk
        for run in walk.topology.entries():
            yield None, run, 0, 0
        for run, there in walk.references.items():
            for number, (offset, element) in enumerate(there, 1):
                yield element, run, number, ends_mm(element, offset, self.reach.layout)

    def _ways(self, origin: Reference | None, run: Run, passed: int, front: int, least: int) -> Iterator[list[Ahead]]:
        """Yield the references on each way ahead, in order, up to where nothing is near enough any more."""
        walk = self.options.walk
        farthest = max(self.reach.limit(origin, None).distance_mm, least, 0) + self._longest_view_mm
        open_ways: list[tuple[Run, int, int, list[Ahead]]] = [(run, passed, -front, [])]
        while open_ways:
            here, passed, start, met = open_ways.pop()
            for place, element in walk.references[here][passed:]:
                met = [*met, self._ahead(origin, element, start + begins_mm(element, place, self.reach.layout))]
            ends = start + walk.topology.length_mm(here)
            after = walk.topology.after(here)
            if ends > farthest:
                yield met
            elif not after:
                yield [*met, self._ahead(origin, None, ends)]
            else:
                open_ways += [(one, 0, ends, met) for one in after]

    @cached_property
    def _longest_view_mm(self) -> int:
        return max((one.view_from_mm for one in self.options.walk.line.reflectors), default=0)

    def _ahead(self, origin: Reference | None, element: Reference | None, distance: int) -> Ahead:
        distance = max(distance, 0)
        return Ahead(element, distance, distance <= self.reach.limit(origin, element).distance_mm)

    def _of_way(self, origin: Reference | None, way: list[Ahead]) -> Iterator[Demand]:
        """The first reference that is chosen has to be near: one that is not needs another one before it."""
        unless = frozenset[int]() if origin is None else frozenset([self.options.number_of(origin)])
        ends_near = bool(way) and way[-1].element is None and way[-1].near
        numbered = [(self.options.number_of(one.element), one.near) for one in way if one.element is not None]
        last = max((place for place, (_, near) in enumerate(numbered) if near), default=-1)
        before = list[int]()
        for number, near in numbered if ends_near else numbered[: last + 1]:
            if not near:
                yield Demand(frozenset(before), unless | {number})
            before.append(number)
        if not ends_near:
            yield Demand(frozenset(before), unless)


def apart(options: Options, rules: Rules) -> Iterator[Demand]:
    """Yield the demands that two elements are not both chosen, or one is not: too near, alike, or out of the radar's range."""
    yield from _groups_apart(options, rules)
    yield from _reflectors_apart(options, rules)


def _groups_apart(options: Options, rules: Rules) -> Iterator[Demand]:
    walk, layout = options.walk, rules.layout
    accuracy = {
        group.id: layout.balise_fix_mm(group.location_accuracy_mm) - layout.detection_accuracy_mm
        for group in walk.line.balise_groups
    }
    reach = 2 * (max(accuracy.values(), default=0) + layout.tolerance_mm + layout.detection_accuracy_mm) + 1
    for here in walk.everywhere():
        for seen in walk.ahead(here.run, here.offset_mm, reach) if _is_linked(here.element) else ():
            if seen.element is not here.element and _is_linked(seen.element):
                figures = {
                    "spacing_mm": seen.distance_mm,
                    "first_accuracy_mm": accuracy[here.element.id],
                    "second_accuracy_mm": accuracy[seen.element.id],
                }
                if rules.balise_windows.broken(figures):
                    yield _not_both(options, here.element, seen.element)


def _is_linked(element: Reference) -> bool:
    return isinstance(element, BaliseGroup) and element.linked


def _reflectors_apart(options: Options, rules: Rules) -> Iterator[Demand]:
    walk, layout = options.walk, rules.layout
    for one in walk.line.reflectors:
        if rules.view_zone.broken({"view_from_mm": one.view_from_mm, "view_to_mm": one.view_to_mm}):
            yield Demand(frozenset(), frozenset([options.number_of(one)]))
    widest = max((one.view_from_mm for one in walk.line.reflectors), default=0)
    reach = (
        max(
            widest + 2 * layout.tolerance_mm + layout.map_accuracy_mm,
            2 * (layout.tolerance_mm + layout.reflector_fix_mm),
        )
        + 1
    )
    for pair in pairs(walk, reach):
        figures = {
            "same_model": pair.first.model == pair.second.model,
            "spacing_mm": pair.spacing_mm,
            "next_view_from_mm": pair.second.view_from_mm,
            "previous_view_to_mm": pair.first.view_to_mm,
        }
        if (rules.neighbours if pair.one_route else rules.across_tracks).broken(figures):
            yield _not_both(options, pair.first, pair.second)


def _not_both(options: Options, first: Reference, second: Reference) -> Demand:
    return Demand(frozenset(), frozenset([options.number_of(first), options.number_of(second)]))


def off_joints(options: Options, rules: Rules) -> Iterator[Demand]:
    """Yield the demand that a group nearer before a joint than the audit permits is not chosen."""
    for one in groups_before_joints(options.walk) if rules.layout.tells_track else ():
        if rules.group_before_joint.broken({"to_joint_mm": one.to_joint_mm}):
            yield Demand(frozenset(), frozenset([options.number_of(one.group)]))
