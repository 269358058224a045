"""Neighbours on a route: reflectors that could be taken for each other, balises whose windows overlap (RFL-8, RFL-D4)."""

from __future__ import annotations

from safeloc.audit.findings import Ledger
from safeloc.audit.rules import Rules
from safeloc.audit.stretches import name
from safeloc.audit.walk import Seen, Walk
from safeloc.line.elements import BaliseGroup, Reflector


def check_reflectors(walk: Walk, rules: Rules, ledger: Ledger) -> None:
    """Every two reflectors near enough on some route to be taken for each other."""
    widest = max((reflector.view_from_mm for reflector in walk.line.reflectors), default=0)
    layout = rules.layout
    reach = max(widest + 2 * layout.tolerance_mm, 2 * (layout.tolerance_mm + layout.reflector_fix_mm)) + 1
    for seen in walk.everywhere():
        if isinstance(seen.element, Reflector):
            for other in walk.ahead(seen.run, seen.offset_mm, reach):
                if isinstance(other.element, Reflector) and _beyond(seen, other):
                    _pair(ledger, rules, walk, seen.element, other, other.element)


def _beyond(seen: Seen, other: Seen) -> bool:
    """Whether the other lies ahead; of two at one place, one order counts."""
    return other.distance_mm > 0 or seen.element.id < other.element.id


def _pair(ledger: Ledger, rules: Rules, walk: Walk, before: Reflector, seen: Seen, after: Reflector) -> None:
    ledger.check(
        rules.neighbours,
        walk.place(seen.run, seen.offset_mm),
        f"{name(before)} and then {name(after)}",
        same_model=before.model == after.model,
        spacing_mm=seen.distance_mm,
        next_view_from_mm=after.view_from_mm,
        previous_view_to_mm=before.view_to_mm,
    )


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
