"""Neighbours on a route: reflectors that could be taken for each other, balises whose windows overlap (RFL-8, RFL-D4)."""

from __future__ import annotations

from safeloc.audit.findings import Ledger
from safeloc.audit.rules import Rules
from safeloc.audit.stretches import name
from safeloc.line.clearance import Pair, pairs
from safeloc.line.elements import BaliseGroup
from safeloc.line.places import Place
from safeloc.line.walk import Seen, Walk


def check_reflectors(walk: Walk, rules: Rules, ledger: Ledger) -> None:
    """Every view zone; and every two reflectors near enough, on one route or across tracks, to be taken for each other."""
    for one in walk.line.reflectors:
        place, figures = (
            Place(one.edge, one.position_mm),
            {"view_from_mm": one.view_from_mm, "view_to_mm": one.view_to_mm},
        )
        ledger.check(rules.view_zone, place, name(one), **figures)
    widest = max((reflector.view_from_mm for reflector in walk.line.reflectors), default=0)
    layout = rules.layout
    reach = max(widest + 2 * layout.tolerance_mm, 2 * (layout.tolerance_mm + layout.reflector_fix_mm)) + 1
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
    """Every two linked groups near enough on some route for their expectation windows to meet."""
    layout = rules.layout
    accuracies = [_accuracy_mm(rules, group) for group in walk.line.balise_groups if group.linked]
    reach = 2 * (max(accuracies, default=0) + layout.tolerance_mm + layout.detection_accuracy_mm) + 1
    nearest: dict[tuple[str, str], tuple[int, BaliseGroup, BaliseGroup, Seen]] = {}
    for seen in walk.everywhere():
        if isinstance(seen.element, BaliseGroup) and seen.element.linked:
            for other in walk.ahead(seen.run, seen.offset_mm, reach):
                if isinstance(other.element, BaliseGroup) and other.element.linked and other.element != seen.element:
                    key = (min(seen.element.id, other.element.id), max(seen.element.id, other.element.id))
                    found = (other.distance_mm, seen.element, other.element, other)
                    if key not in nearest or found[0] < nearest[key][0]:
                        nearest[key] = found
    for distance, first, second, seen in nearest.values():
        ledger.check(
            rules.balise_windows,
            walk.place(seen.run, seen.offset_mm),
            f"balise groups {first.id} and {second.id}",
            spacing_mm=distance,
            first_accuracy_mm=_accuracy_mm(rules, first),
            second_accuracy_mm=_accuracy_mm(rules, second),
        )


def _accuracy_mm(rules: Rules, group: BaliseGroup) -> int:
    own = group.location_accuracy_mm
    return rules.layout.balise_accuracy_mm if own is None else own
