"""Balise groups as the map knows them: along a route, and as inputs of the balise machine."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from safeloc.railway.map.elements import BaliseGroup
from safeloc.railway.map.routes import Inventory, Met, Route
from safeloc.runtime.streams.steps import Cell

Orientation = Literal["UNKNOWN", "NOMINAL", "REVERSE"]
Reaction = Literal["NONE", "SERVICE_BRAKE", "TRAIN_TRIP"]
GROUPS_OF_A_COUNTRY = 16_384
"""NID_BG has 14 bits."""


@dataclass(frozen=True)
class Group:
    """A balise group of the line: `place_mm` is that of balise 1 along the route.

    accuracy_mm   location accuracy that linking gives; None: the national or default value counts
    reflector_mm  from balise 1 to the next reflector, told by the telegram; None: it says nothing
    """

    identity: int
    place_mm: int
    balises: int = 2
    orientation: Orientation = "NOMINAL"
    accuracy_mm: int | None = 3_000
    reaction: Reaction = "SERVICE_BRAKE"
    linked: bool = True
    reflector_mm: int | None = None
    search_mm: int | None = None


def announcement(group: Group, *, order: Literal["ADD", "REPLACE"] = "ADD") -> dict[str, Cell]:
    """Return the inputs that announce a group."""
    inputs: dict[str, Cell] = {
        "linking_order": order,
        "linking_group": group.identity,
        "linking_position_mm": group.place_mm,
        "linking_reaction": group.reaction,
        "linking_orientation": group.orientation if group.balises > 1 else "UNKNOWN",
    }
    return inputs if group.accuracy_mm is None else {**inputs, "linking_accuracy_mm": group.accuracy_mm}


def telegram(group: Group, *, age_ms: int = 0, since_mm: int | None = None, place: bool = True) -> dict[str, Cell]:
    """Return the inputs of a complete and undamaged reading in the orientation of the route; `place`: the map knows the group."""
    nominal = group.orientation != "REVERSE"
    inputs: dict[str, Cell | None] = {
        "telegram_group": group.identity,
        "telegram_link": "LINKED" if group.linked else "UNLINKED",
        "telegram_check": "PASSED",
        "telegram_total": group.balises,
        "telegram_read": group.balises,
        "telegram_first": 1 if nominal else group.balises,
        "telegram_last": group.balises if nominal else 1,
        "telegram_age_ms": age_ms,
        "telegram_position_mm": group.place_mm if place else None,
        "telegram_orientation": group.orientation if place else None,
        "telegram_since_mm": since_mm,
        "telegram_reflector_mm": group.reflector_mm,
        "telegram_search_mm": group.search_mm,
    }
    return {name: value for name, value in inputs.items() if value is not None}


def groups_along(
    route: Route, inventory: Inventory | None = None, *, reaction: Reaction = "SERVICE_BRAKE"
) -> list[Group]:
    """Return the groups that a vehicle meets on a route of the line, in order, with one linking reaction for all.

    A group's identity is made of country and group number (NID_C, NID_BG); places count from the route's start.
    """
    return list(_groups(route, inventory, reaction))


def _groups(route: Route, inventory: Inventory | None, reaction: Reaction) -> Iterator[Group]:
    for met in route.objects(inventory):
        if isinstance(met.element, BaliseGroup):
            yield _group(met, met.element, reaction)


def _group(met: Met, found: BaliseGroup, reaction: Reaction) -> Group:
    named = next((one for one in found.telegram_reflectors if one.direction == met.direction), None)
    return Group(
        found.country * GROUPS_OF_A_COUNTRY + found.identity + 1,
        met.position_mm,
        len(found.balises),
        "UNKNOWN" if met.nominal is None else "NOMINAL" if met.nominal else "REVERSE",
        found.location_accuracy_mm,
        reaction,
        found.linked,
        None if named is None else named.distance_mm,
        None if named is None else named.search_from_mm,
    )
