"""Data of a route for the simulations, taken from the map: markers, groups, reflectors, stop points, switches.

All places are in mm along the route; the vehicle starts with its front end at 0.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

from safeloc.errors import InputError
from safeloc.models.balise.groups import Group
from safeloc.models.layout_rules.marker_readers import MarkerReaders
from safeloc.models.reflector.simulate import Balise, Reflector
from safeloc.models.reflector.simulate import Route as ReflectorRoute
from safeloc.models.stop_point.simulate import StopPlace
from safeloc.models.turn_off.simulate import SwitchAhead
from safeloc.models.vocabulary.reflectors import MODEL, NO_MODEL
from safeloc.railway.map import elements
from safeloc.railway.map.clearance import clear_mm
from safeloc.railway.map.model import Line
from safeloc.railway.map.routes import Met, Route
from safeloc.railway.map.topology import Run
from safeloc.railway.map.walk import Seen, Walk
from safeloc.simulation.speed_profile import Limit

_FARTHEST_CLEAR_MM = 1_000_000
"""Distance beyond which no machine confuses two reflectors of one model."""
MODELS = tuple(one.label for one in MODEL if one is not NO_MODEL)


def identities(line: Line) -> dict[str, int]:
    """Return balise group -> its number on board: NID_BG if that is unique on the line, else the place in the map's list."""
    counts = Counter(group.identity for group in line.balise_groups)
    if max(counts.values(), default=0) <= 1 and 0 not in counts:
        return {group.id: group.identity for group in line.balise_groups}
    return {group.id: number for number, group in enumerate(line.balise_groups, 1)}


def _marker_identities(line: Line) -> dict[str, int]:
    """Return marker -> its number on board: its identity, unless a group has the same one; then they count on from the groups' numbers."""
    taken = set(identities(line).values())
    if taken.isdisjoint(one.identity for one in line.markers):
        return {one.id: one.identity for one in line.markers}
    return {one.id: number for number, one in enumerate(line.markers, max(taken) + 1)}


def balise_groups(route: Route) -> list[tuple[Met, elements.BaliseGroup]]:
    """Return the balise groups on the route, in order."""
    return [(met, met.element) for met in route.objects() if isinstance(met.element, elements.BaliseGroup)]


def reflectors(route: Route) -> list[tuple[int, elements.Reflector]]:
    """Return the reflectors on the route, in order; InputError for a model that no radar of the machines distinguishes."""
    found = [(met.position_mm, met.element) for met in route.objects() if isinstance(met.element, elements.Reflector)]
    for _, one in found:
        if one.model not in MODELS:
            raise InputError(f"reflector {one.id}: the machines know the models {', '.join(MODELS)}, not {one.model}.")
    return found


# ------------------------------------------------------------------ odometry and balise


def markers(route: Route, readers: MarkerReaders) -> list[tuple[int, int]]:
    """Return every marker, and every group that the readers read as one: identity on board and place, in order."""
    return [(number, place) for place, number, _ in sorted(_read(route, readers), key=lambda one: one[:2])]


def accuracies(route: Route, national_mm: int, detection_mm: int, readers: MarkerReaders) -> dict[int, int]:
    """Return marker -> greatest distance from its place at which it is read, mm: its own accuracy or the vehicle's figure; of a group
    location accuracy (own or national) and detection.
    """
    return {number: _within_mm(one, national_mm, detection_mm, readers) for _, number, one in _read(route, readers)}


def _read(route: Route, readers: MarkerReaders) -> Iterator[tuple[int, int, elements.Marker | elements.BaliseGroup]]:
    line = route.topology.line
    of_groups, of_markers = identities(line), _marker_identities(line)
    for met in route.objects():
        if isinstance(met.element, elements.Marker):
            yield met.position_mm, of_markers[met.element.id], met.element
        elif isinstance(met.element, elements.BaliseGroup) and readers.groups_are_markers:
            yield met.position_mm, of_groups[met.element.id], met.element


def _within_mm(
    one: elements.Marker | elements.BaliseGroup, national_mm: int, detection_mm: int, readers: MarkerReaders
) -> int:
    if isinstance(one, elements.BaliseGroup):
        return _accuracy_mm(one, national_mm) + detection_mm
    return readers.marker_accuracy_mm if one.accuracy_mm is None else one.accuracy_mm


def _accuracy_mm(group: elements.BaliseGroup, national_mm: int) -> int:
    return national_mm if group.location_accuracy_mm is None else group.location_accuracy_mm


def groups(route: Route) -> list[Group]:
    """Return the groups of the balise machine's map; a telegram gives the reflector for the route's direction."""
    known = identities(route.topology.line)
    return [_group(met, group, known[group.id]) for met, group in balise_groups(route)]


def _group(met: Met, group: elements.BaliseGroup, identity: int) -> Group:
    named = _reflector_of(met, group)
    return Group(
        identity,
        met.position_mm,
        balises=len(group.balises),
        orientation="REVERSE" if met.nominal is False else "NOMINAL",
        accuracy_mm=group.location_accuracy_mm,
        linked=group.linked,
        reflector_mm=named.distance_mm if named else None,
        search_mm=named.search_from_mm if named else None,
    )


def _reflector_of(met: Met, group: elements.BaliseGroup) -> elements.TelegramReflector | None:
    return next((named for named in group.telegram_reflectors if named.direction == met.direction), None)


# ------------------------------------------------------------------ reflectors


def reflector_route(
    route: Route, walk: Walk, *, antenna_mm: int, national_mm: int, detection_mm: int
) -> ReflectorRoute:
    """Return balises and reflectors of the route, and reflectors of other branches that the radar sees from it.

    A balise's place is that of the front end when the antenna, `antenna_mm` behind it, reads the balise.
    """
    known, clear = identities(route.topology.line), clear_mm(walk, _FARTHEST_CLEAR_MM)
    balises = tuple(
        Balise(
            known[group.id],
            met.position_mm + antenna_mm,
            _accuracy_mm(group, national_mm) + detection_mm,
            reference=_reflector_of(met, group) is not None,
            search_from_mm=_search_from(met, group, antenna_mm),
        )
        for met, group in balise_groups(route)
    )
    own = tuple(_reflector(one, place, clear) for place, one in reflectors(route))
    others = tuple(Reflector(place, one.model, one.view_from_mm, one.view_to_mm) for place, one in _beside(route, walk))
    return ReflectorRoute(balises, own, beside=others)


def _search_from(met: Met, group: elements.BaliseGroup, antenna_mm: int) -> int | None:
    """Return the distance after which the search begins, counted from the place of reading, not from the group."""
    named = _reflector_of(met, group)
    return None if named is None or named.search_from_mm is None else max(0, named.search_from_mm - antenna_mm)


def _reflector(one: elements.Reflector, place_mm: int, clear: Mapping[str, int]) -> Reflector:
    return Reflector(place_mm, one.model, one.view_from_mm, one.view_to_mm, clear[one.id])


def _beside(route: Route, walk: Walk) -> list[tuple[int, elements.Reflector]]:
    """Return the reflectors of the other branches of the route's switches, at their places along the route; each once."""
    own = {one.id for _, one in reflectors(route)}
    seen: dict[str, tuple[int, elements.Reflector]] = {}
    for place, one in _on_other_branches(route, walk):
        if one.id not in own and one.model in MODELS and one.id not in seen:
            seen[one.id] = (place, one)
    return list(seen.values())


def seen_beside(route: Route, rivals: Sequence[Route], walk: Walk) -> list[tuple[int, elements.Reflector]]:
    """Return the reflectors of other branches that are seen from the route, or from a rival that may share its track; each once."""
    own = {one.id for _, one in reflectors(route)}
    found = {one.id: (place, one) for rival in (*reversed(rivals), route) for place, one in _beside(rival, walk)}
    return [placed for name, placed in found.items() if name not in own]


def _on_other_branches(route: Route, walk: Walk) -> Iterator[tuple[int, elements.Reflector]]:
    reach = 2 * max((one.view_from_mm for one in walk.line.reflectors), default=0)
    end = -route.start_mm
    for before, after in pairwise(route.runs):
        end += walk.topology.length_mm(before)
        for other in walk.topology.after(before):
            if other != after:
                yield from _placed(walk.ahead(other, 0, reach), end, 1)
        for other in walk.topology.before(after):
            if other != before:
                yield from _placed(walk.behind(other, walk.topology.length_mm(other), reach), end, -1)


def _placed(found: Iterator[Seen], junction_mm: int, sign: int) -> Iterator[tuple[int, elements.Reflector]]:
    for seen in found:
        if isinstance(seen.element, elements.Reflector):
            yield junction_mm + sign * seen.distance_mm, seen.element


# ------------------------------------------------------------------ stop points and switches


def platforms(route: Route) -> list[list[tuple[int, elements.StopPoint]]]:
    """Return the stop points of each platform on the route, in order; one that names no platform is a platform by itself."""
    found: dict[str, list[tuple[int, elements.StopPoint]]] = {}
    for met in route.objects():
        if isinstance(met.element, elements.StopPoint):
            name = f"platform {met.element.platform}" if met.element.platform else f"stop {met.element.id}"
            found.setdefault(name, []).append((met.position_mm, met.element))
    return list(found.values())


def stop_places(platform: Sequence[tuple[int, elements.StopPoint]]) -> tuple[StopPlace, ...]:
    """Return the stop points of one platform in the form of the machine's map."""
    return tuple(StopPlace(place, stop.window_before_mm, stop.window_after_mm) for place, stop in platform)


def switches_ahead(route: Route) -> list[SwitchAhead]:
    """Return the facing switches that the vehicle passes in view of the first reflector behind them."""
    behind = reflectors(route)
    found = []
    for met in route.switches():
        first = next(((place, one) for place, one in behind if place > met.position_mm), None)
        if met.passage.facing and first is not None and first[0] - first[1].view_from_mm < met.position_mm:
            course = route.topology.course(met.passage)
            found.append(SwitchAhead(met.position_mm, course, first[0], -first[1].lateral_offset_mm))
    return found


def limits(route: Route) -> list[Limit]:
    """Return the speed limits along the route, for its direction."""
    found = []
    start = -route.start_mm
    for run in route.runs:
        length = route.topology.length_mm(run)
        found += [_limit(one, run, start, length) for one in route.topology.line.speed_limits if _holds(one, run)]
        start += length
    return found


def _holds(limit: elements.SpeedLimit, run: Run) -> bool:
    return limit.edge == run.edge and limit.direction in (None, run.direction)


def _limit(one: elements.SpeedLimit, run: Run, start_mm: int, length_mm: int) -> Limit:
    low, high = sorted((one.from_mm, one.to_mm))
    if run.direction == "decreasing":
        low, high = length_mm - high, length_mm - low
    return Limit(start_mm + low, start_mm + high, one.max_speed_mm_s)


def without(route: ReflectorRoute, *, balises: Sequence[int] = (), missing: Sequence[int] = ()) -> ReflectorRoute:
    """Return the route with balises that are never read, and with reflectors (by place) that are missing on the track."""
    read = tuple(one for one in route.balises if one.identity not in balises)
    return replace(route, balises=read, missing=frozenset(missing))
