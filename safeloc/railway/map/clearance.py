"""Distances between reflectors of one model, on one route or on neighbouring tracks (RFL-8, RFL-10).

A vehicle sees the reflectors that face it: those of its own route, those of the other branch of a switch ahead or behind,
and those beside a parallel track, which are found by their kilometre.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import combinations

from safeloc.railway.map.elements import Reflector
from safeloc.railway.map.places import kilometre_mm
from safeloc.railway.map.walk import Seen, Walk

_BESIDE_MM = 1_000_000
"""How far from their switch two branches are taken to lie beside each other; the map does not tell how far apart they are."""


@dataclass(frozen=True)
class Pair:
    """Two reflectors near each other; on one route `first` comes before `second`."""

    first: Reflector
    second: Reflector
    spacing_mm: int
    one_route: bool


def pairs(walk: Walk, reach_mm: int) -> list[Pair]:
    """Return every two reflectors nearer than `reach_mm` on a route or across tracks, each with its least spacing."""
    found: dict[tuple[str, str, bool], Pair] = {}
    for pair in (*_on_routes(walk, reach_mm), *_on_branches(walk, reach_mm), *_by_kilometre(walk, reach_mm)):
        first, second = sorted((pair.first.id, pair.second.id))
        key = (first, second, pair.one_route)
        if key not in found or pair.spacing_mm < found[key].spacing_mm:
            found[key] = pair
    return [pair for (first, second, _), pair in found.items() if pair.one_route or (first, second, True) not in found]


def clear_mm(walk: Walk, reach_mm: int) -> dict[str, int]:
    """Return for each reflector the distance to the nearest other one of its model that a vehicle may see, at most `reach_mm`."""
    clear = {reflector.id: reach_mm for reflector in walk.line.reflectors}
    for pair in pairs(walk, reach_mm):
        if pair.first.model == pair.second.model:
            for one in (pair.first, pair.second):
                clear[one.id] = min(clear[one.id], pair.spacing_mm)
    return clear


def _on_routes(walk: Walk, reach_mm: int) -> Iterator[Pair]:
    for seen in walk.everywhere():
        if isinstance(seen.element, Reflector):
            for other in walk.ahead(seen.run, seen.offset_mm, reach_mm):
                if isinstance(other.element, Reflector) and _beyond(seen, other):
                    yield Pair(seen.element, other.element, other.distance_mm, True)


def _beyond(seen: Seen, other: Seen) -> bool:
    """Return whether the other reflector lies ahead; two at one place are ordered by identity."""
    return other.distance_mm > 0 or seen.element.id < other.element.id


def _on_branches(walk: Walk, reach_mm: int) -> Iterator[Pair]:
    """Yield pairs on two branches of a switch: that far from it they may still lie beside each other."""
    far = max(_BESIDE_MM, reach_mm)
    for run in walk.runs:
        after, before = walk.topology.after(run), walk.topology.before(run)
        for one, other in combinations(after, 2) if len(after) > 1 else ():
            yield from _across(walk.ahead(one, 0, far), walk.ahead(other, 0, far), reach_mm)
        for one, other in combinations(before, 2) if len(before) > 1 else ():
            ends = [walk.behind(leg, walk.topology.length_mm(leg), far) for leg in (one, other)]
            yield from _across(ends[0], ends[1], reach_mm)


def _across(left: Iterable[Seen], right: Iterable[Seen], reach_mm: int) -> Iterator[Pair]:
    others = [seen for seen in right if isinstance(seen.element, Reflector)]
    for seen in left:
        for other in others:
            first, second = seen.element, other.element
            if isinstance(first, Reflector) and isinstance(second, Reflector) and first is not second:
                spacing = abs(seen.distance_mm - other.distance_mm)
                if spacing <= reach_mm:
                    yield Pair(first, second, spacing, False)


def _by_kilometre(walk: Walk, reach_mm: int) -> Iterator[Pair]:
    """Yield pairs of reflectors beside tracks of one kilometre line that face the same way along it."""
    lanes: dict[tuple[str, bool], list[tuple[int, str, Reflector]]] = {}
    for reflector in walk.line.reflectors:
        found = _lane(walk, reflector)
        if found is not None:
            line, upwards, kilometre = found
            lanes.setdefault((line, upwards), []).append((kilometre, reflector.id, reflector))
    for lane in lanes.values():
        lane.sort(key=lambda entry: entry[:2])
        yield from _within_reach(lane, reach_mm)


def _within_reach(lane: list[tuple[int, str, Reflector]], reach_mm: int) -> Iterator[Pair]:
    for index, (kilometre, _, first) in enumerate(lane):
        for there, _, second in lane[index + 1 :]:
            if there - kilometre > reach_mm:
                break
            yield Pair(first, second, there - kilometre, False)


def _lane(walk: Walk, reflector: Reflector) -> tuple[str, bool, int] | None:
    """Return kilometre line, whether the kilometre grows for vehicles that see the reflector, and its kilometre in mm."""
    edge = walk.topology.edges[reflector.edge]
    found = kilometre_mm(edge, reflector.position_mm)
    if found is None:
        return None
    point = [one for one in edge.kilometres if one.position_mm <= reflector.position_mm][-1]
    return found[0], point.direction == reflector.direction, found[1]
