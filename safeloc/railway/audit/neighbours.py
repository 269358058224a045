"""Neighbours on a route: reflectors that could be taken for each other, balises whose windows overlap (RFL-8, RFL-D4)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from safeloc.railway.audit.findings import Ledger
from safeloc.railway.audit.rules import Rules
from safeloc.railway.audit.stretches import name
from safeloc.railway.map.clearance import Pair, pairs
from safeloc.railway.map.elements import BaliseGroup
from safeloc.railway.map.places import Place
from safeloc.railway.map.walk import Seen, Walk


def check_reflectors(walk: Walk, rules: Rules, ledger: Ledger) -> None:
    """Check every view zone, and every two reflectors so close that they could be confused, on one route or across tracks."""
    for one in walk.line.reflectors:
        place, figures = (
            Place(one.edge, one.position_mm),
            {"view_from_mm": one.view_from_mm, "view_to_mm": one.view_to_mm},
        )
        ledger.check(rules.view_zone, place, name(one), **figures)
    widest = max((reflector.view_from_mm for reflector in walk.line.reflectors), default=0)
    layout = rules.layout
    reach = (
        max(
            widest + 2 * layout.tolerance_mm + layout.map_accuracy_mm,
            2 * (layout.tolerance_mm + layout.reflector_fix_mm),
        )
        + 1
    )
    for pair in pairs(walk, reach):
        _pair(pair, rules, ledger)


def _pair(pair: Pair, rules: Rules, ledger: Ledger) -> None:
    before, after = pair.first, pair.second
    place = Place(after.edge, after.position_mm)
    same = before.model == after.model
    if pair.one_route:
        ledger.check(
            rules.neighbours,
            place,
            f"{name(before)} and then {name(after)}",
            same_model=same,
            spacing_mm=pair.spacing_mm,
            next_view_from_mm=after.view_from_mm,
            previous_view_to_mm=before.view_to_mm,
        )
    else:
        subject = f"{name(before)} and {name(after)} beside another track"
        ledger.check(rules.across_tracks, place, subject, same_model=same, spacing_mm=pair.spacing_mm)


def check_balises(walk: Walk, rules: Rules, ledger: Ledger) -> None:
    """Check every two linked groups that are so close on some route that their expectation windows may meet."""
    accuracies = [_accuracy_mm(rules, group) for group in walk.line.balise_groups if group.linked]
    reach = 2 * (max(accuracies, default=0) + rules.layout.tolerance_mm + rules.layout.detection_accuracy_mm) + 1
    nearest: dict[frozenset[str], _Linked] = {}
    for found in _linked_pairs(walk, reach):
        pair = frozenset((found.first.id, found.second.id))
        if pair not in nearest or found.seen.distance_mm < nearest[pair].seen.distance_mm:
            nearest[pair] = found
    for found in nearest.values():
        ledger.check(
            rules.balise_windows,
            walk.place(found.seen.run, found.seen.offset_mm),
            f"balise groups {found.first.id} and {found.second.id}",
            spacing_mm=found.seen.distance_mm,
            first_accuracy_mm=_accuracy_mm(rules, found.first),
            second_accuracy_mm=_accuracy_mm(rules, found.second),
        )


@dataclass(frozen=True)
class _Linked:
    """Two linked groups, the second seen from the first."""

    first: BaliseGroup
    second: BaliseGroup
    seen: Seen


def _linked_pairs(walk: Walk, reach_mm: int) -> Iterator[_Linked]:
    for here in walk.everywhere():
        first = here.element
        if isinstance(first, BaliseGroup) and first.linked:
            for seen in walk.ahead(here.run, here.offset_mm, reach_mm):
                second = seen.element
                if isinstance(second, BaliseGroup) and second.linked and second is not first:
                    yield _Linked(first, second, seen)


def _accuracy_mm(rules: Rules, group: BaliseGroup) -> int:
    accuracy_mm = group.location_accuracy_mm
    return rules.layout.balise_accuracy_mm if accuracy_mm is None else accuracy_mm
