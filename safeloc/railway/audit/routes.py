"""Checks that routes differ in the reflectors and balises seen on them (RFL-D6).

On a line with few routes every pair is compared from end to end. On a line with many, the ways behind every facing switch
are compared until they meet again or leave the horizon, so that the work grows in proportion to the line; and the ways from
every two entries of the map up to the horizon, which have no start in common and may run in opposite directions.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, product

import networkx as nx

from safeloc.railway.audit.confusion import NEVER, Sighting, common_suffix, faults_towards
from safeloc.railway.audit.findings import Ledger, Likeness, RoutePair
from safeloc.railway.audit.rules import Rules
from safeloc.railway.audit.stretches import longest
from safeloc.railway.map.elements import Reflector
from safeloc.railway.map.places import Place
from safeloc.railway.map.routes import through_routes
from safeloc.railway.map.topology import Run, Topology
from safeloc.railway.map.walk import Reference, Walk

MOST_ROUTES = 24
MOST_WORK = 2_000_000
"""Greatest number of compared sightings for all pairs of routes; beyond it, only the ways behind switches are compared."""
_WAYS_ON = 32
_HORIZON_STRETCHES = 3
_LONGEST_COMPARED_MM = 10_000_000
_KEPT_PAIRS = 100
_ENTRY_PAIRS = 2_000
"""Greatest number of pairs of entries that are compared; the audit tells how many are left."""


@dataclass(frozen=True)
class _Way:
    """A way along the line, with the sightings on it in order."""

    name: str
    runs: tuple[Run, ...]
    seen: tuple[Sighting, ...]
    length_mm: int

    @property
    def models(self) -> str:
        """The reflector models in order."""
        return "".join(one.what for one in self.seen if not one.certain)


def check_routes(walk: Walk, rules: Rules, ledger: Ledger) -> tuple[int | None, tuple[RoutePair, ...]]:
    """Check the routes; return their number (None if too many to compare one by one) and the pairs that were compared."""
    count = route_count(walk.topology)
    few = count is not None and count <= MOST_ROUTES and count**2 * _references(walk) ** 2 <= MOST_WORK
    pairs = [*(_end_to_end(walk, rules) if few else _within_horizon(walk, rules, ledger))]
    for pair in pairs:
        subject = f"{pair.first} and {pair.second}"
        ledger.check(rules.routes, pair.place, subject, faults_to_confuse=_faults(pair))
    if few:
        return count, tuple(pairs)
    close = sorted((pair for pair in pairs if pair.by_all.least is not None), key=_faults)
    return None, tuple(close[:_KEPT_PAIRS])


def _references(walk: Walk) -> int:
    return sum(len(there) for there in walk.references.values())


def _faults(pair: RoutePair) -> int:
    least = pair.by_all.least
    return NEVER if least is None else least


def route_count(topology: Topology) -> int | None:
    """Count the routes over the entire map; None if a loop makes the number infinite."""
    if not nx.is_directed_acyclic_graph(topology.graph):
        return None
    counts: dict[Run, int] = {}
    for run in nx.topological_sort(topology.graph):
        counts[run] = sum(counts[before] for before in topology.before(run)) or 1
    return sum(counts[run] for run in topology.exits())


def _gate_mm(rules: Rules) -> int:
    """Return the distance within which two estimated places of reflectors may be one: both errors, as in `separable_by_distance`."""
    return 2 * (rules.layout.tolerance_mm + rules.layout.reflector_fix_mm)


# ------------------------------------------------------------------ few routes


def _end_to_end(walk: Walk, rules: Rules) -> Iterator[RoutePair]:
    ways = [_seen_along(walk, rules, route.name, route.runs) for route in through_routes(walk.topology, MOST_ROUTES)]
    for first, second in combinations(ways, 2):
        same_start = first.runs[0] == second.runs[0]
        place = walk.place(_parting(first.runs, second.runs), 0)
        yield _pair(first, second, rules, same_start, place)


def _seen_along(walk: Walk, rules: Rules, name: str, runs: Sequence[Run]) -> _Way:
    seen: list[Sighting] = []
    start = 0
    for run in runs:
        seen += [_sighting(rules, element, run, start + offset) for offset, element in walk.references[run]]
        start += walk.topology.length_mm(run)
    return _Way(name, tuple(runs), tuple(seen), start)


def _sighting(rules: Rules, element: Reference, run: Run, position_mm: int) -> Sighting:
    if isinstance(element, Reflector):
        return Sighting(element.model, position_mm, element.id)
    way = "" if element.orientation is None else " nominal" if element.orientation == run.direction else " reverse"
    wider = 2 * max(rules.layout.balise_fix_mm(element.location_accuracy_mm) - rules.layout.reflector_fix_mm, 0)
    return Sighting(f"balise group {element.id}{way}", position_mm, element.id, certain=True, wider_mm=wider)


def _parting(first: Sequence[Run], second: Sequence[Run]) -> Run:
    """Return the first run of one route that the other does not have."""
    differing = (one for one, other in zip(first, second, strict=False) if one != other)
    return next(differing, first[-1])


def _pair(first: _Way, second: _Way, rules: Rules, same_start: bool, place: Place) -> RoutePair:
    one, other = ([seen for seen in way.seen if not seen.certain] for way in (first, second))
    alone = _likeness(one, other, None, same_start)
    every = _likeness(first.seen, second.seen, _gate_mm(rules), same_start)
    suffix = common_suffix(one, other)
    return RoutePair(first.name, second.name, first.models, second.models, alone, every, suffix, place)


def _likeness(first: Sequence[Sighting], second: Sequence[Sighting], gate_mm: int | None, same_start: bool) -> Likeness:
    there, back = ((first, second), (second, first))
    return Likeness(faults_towards(*there, gate_mm, same_start), faults_towards(*back, gate_mm, same_start))


# ------------------------------------------------------------------ many routes


def _within_horizon(walk: Walk, rules: Rules, ledger: Ledger) -> Iterator[RoutePair]:
    horizon = _HORIZON_STRETCHES * min(longest(0, rules.layout), _LONGEST_COMPARED_MM)
    yield from _behind_choices(walk, rules, ledger, horizon)
    yield from _from_entries(walk, rules, ledger, horizon)


def _from_entries(walk: Walk, rules: Rules, ledger: Ledger, horizon_mm: int) -> Iterator[RoutePair]:
    """Compare the ways from every two entries up to where they meet, whatever their directions; only where both see reflectors."""
    found = {run: _ways_on(walk, run, horizon_mm)[:_WAYS_ON] for run in walk.topology.entries()}
    ways = {run: those for run, those in found.items() if any(_named(walk, rules, way).models for way in those)}
    pairs = list(combinations(ways, 2))
    if len(pairs) > _ENTRY_PAIRS:
        place = walk.place(next(iter(ways)), 0)
        left = len(pairs) - _ENTRY_PAIRS
        ledger.add(rules.all_ways, place, f"{left} of {len(pairs)} pairs of entries to the map are not compared")
    for first, second in pairs[:_ENTRY_PAIRS]:
        apart = (_apart(walk, rules, left, right, horizon_mm) for left, right in product(ways[first], ways[second]))
        place = walk.place(first, 0)
        compared = [_pair(*both, rules, False, place) for both in apart if all(way.models for way in both)]
        if compared:
            yield min(compared, key=_faults)


def _apart(walk: Walk, rules: Rules, left: Sequence[Run], right: Sequence[Run], horizon_mm: int) -> tuple[_Way, _Way]:
    """Return both ways up to the run on which they meet, where vehicles on both are at one place, or up to the horizon."""
    met = next((run for run in left if run in right), None)
    parts = (left, right) if met is None else (_before(left, met), _before(right, met))
    one, other = (_shortened(_named(walk, rules, runs), horizon_mm) for runs in parts)
    return one, other


def _behind_choices(walk: Walk, rules: Rules, ledger: Ledger, horizon: int) -> Iterator[RoutePair]:
    for run in walk.runs:
        place = walk.place(run, walk.topology.length_mm(run))
        ways = [_ways_on(walk, branch, horizon) for branch in _branches(walk, run)]
        if any(len(one) > _WAYS_ON for one in ways):
            ledger.add(rules.all_ways, place, f"more than {_WAYS_ON} ways lead on from {walk.topology.end(run)}")
        for one, other in combinations(ways, 2):
            pairs = [
                _pair(*_until_they_meet(walk, left, right, rules), rules, True, place)
                for left, right in product(one[:_WAYS_ON], other[:_WAYS_ON])
            ]
            yield min(pairs, key=_faults)


def _branches(walk: Walk, run: Run) -> list[Run]:
    after = walk.topology.after(run)
    return after if len(after) > 1 else []


def _ways_on(walk: Walk, run: Run, horizon_mm: int) -> list[tuple[Run, ...]]:
    """Return the ways from the start of a run up to the horizon, at most one more than are compared."""
    found: list[tuple[Run, ...]] = []
    open_ways: list[tuple[tuple[Run, ...], int]] = [((run,), walk.topology.length_mm(run))]
    while open_ways and len(found) <= _WAYS_ON:
        runs, length = open_ways.pop()
        after = [] if length >= horizon_mm else [one for one in walk.topology.after(runs[-1]) if one not in runs]
        open_ways += [((*runs, one), length + walk.topology.length_mm(one)) for one in reversed(after)]
        if not after:
            found.append(runs)
    return found


def _until_they_meet(walk: Walk, left: Sequence[Run], right: Sequence[Run], rules: Rules) -> tuple[_Way, _Way]:
    """Return both ways up to the place where they meet and on to the next reference, which comes later on the longer way."""
    met = next((run for run in left if run in right), None)
    if met is None:
        ways = _named(walk, rules, left), _named(walk, rules, right)
        widest = max((one.wider_mm for way in ways for one in way.seen), default=0)
        common = min(way.length_mm for way in ways) - _gate_mm(rules) - widest
        return _shortened(ways[0], common), _shortened(ways[1], common)
    together = left[left.index(met) :]
    last = next((index for index, run in enumerate(together) if walk.references[run]), len(together) - 1)
    tail = together[: last + 1]
    return _named(walk, rules, (*_before(left, met), *tail)), _named(walk, rules, (*_before(right, met), *tail))


def _named(walk: Walk, rules: Rules, runs: Sequence[Run]) -> _Way:
    return _seen_along(walk, rules, " > ".join(run.edge for run in runs), runs)


def _before(runs: Sequence[Run], met: Run) -> Sequence[Run]:
    return runs[: runs.index(met)]


def _shortened(way: _Way, length_mm: int) -> _Way:
    """Cut the way at this length, because the other way was followed no further."""
    seen = tuple(one for one in way.seen if one.position_mm <= length_mm)
    return _Way(way.name, way.runs, seen, length_mm)
