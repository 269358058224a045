"""Balise groups of a railML document: identity, place, order of the balises, orientation.

A group is a `baliseGroup` (railML 3.2 and later), or a `balise` with `isBaliseGroup="true"` (3.1), which is one balise by
itself, or the parent of those that belong to it. railML 3.1 has no field for NID_C and NID_BG: they come from designators
whose registers have these names.
"""

from __future__ import annotations

from collections.abc import Container, Iterator, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from typing import Any

from safeloc.errors import InputError
from safeloc.railway.map.elements import Balise, BaliseGroup, Direction, TrackEdge, opposite
from safeloc.railway.map.imports.building import made
from safeloc.railway.map.imports.lengths import decimal, millimetres
from safeloc.railway.map.imports.notes import Note
from safeloc.railway.map.imports.railml_places import Places, Spot
from safeloc.railway.map.imports.railml_xml import Element

_NO_IDENTITY = (
    "no identity as a Eurobalise group; give isEurobaliseGroup with countryID and groupID, or, in railML 3.1, designators "
    "with the registers NID_C and NID_BG"
)
_BELONGS = ("belongsToBaliseGroup", "baliseGroupRef", "belongsToParent")
_NUMBER = ("positionInGroup", "numberInGroup")
_PREDECESSOR = ("distanceToPredecessorBaliseWithinGroup", "distanceToPredecessor")


@dataclass(frozen=True)
class Single:
    """One balise of a group: its number and its place; None if the document does not give them."""

    element: Element
    number: int | None
    spot: Spot | None
    distance_mm: int | None


def balise_groups(functional: Element, places: Places, edges: Mapping[str, TrackEdge]) -> Iterator[BaliseGroup]:
    """Yield all Eurobalise groups that have an identity and a place. A group with a wrong balise is left out as a whole: a
    vehicle would read more balises than the map has."""
    every = functional.all("balises", "balise")
    parents = [balise for balise in every if _flag(balise, "isBaliseGroup", places.notes)]
    groups = [*functional.all("baliseGroups", "baliseGroup"), *parents]
    members: dict[str, list[Element]] = {group.need("id"): [] for group in groups}
    others = (balise for balise in every if balise not in parents)
    for owner, balise in places.each(others, lambda balise: [(_owner(balise, members), balise)]):
        members[owner].append(balise)
    return places.each(groups, lambda group: _group(group, _singles(members[group.need("id")], places), places, edges))


def _flag(element: Element, name: str, notes: list[Note]) -> bool:
    stated = element.get(name)
    if stated not in (None, "true", "false", "1", "0"):
        notes.append(Note("doubtful", element.place, f"{name} is {stated!r}, neither true nor false; taken as false"))
    return stated in ("true", "1")


def _owner(balise: Element, groups: Container[str]) -> str:
    for name in _BELONGS:
        owner = balise.get(name) or next((child.need("ref") for child in balise.all(name)), None)
        if owner is not None and owner not in groups:
            raise InputError(f"{balise.place}: there is no balise group {owner!r}.")
        if owner is not None:
            return owner
    raise InputError(f'{balise.place}: belongs to no balise group; give {_BELONGS[0]!r}, or isBaliseGroup="true".')


def _singles(balises: Sequence[Element], places: Places) -> list[Single]:
    try:
        return [_single(balise, places) for balise in balises]
    except InputError:
        for balise in balises:
            balise.skip()
        raise


def _single(balise: Element, places: Places) -> Single:
    euro = balise.one("isEurobalise")
    numbers = [one.get(name) for one in (balise, *([euro] if euro else [])) for name in _NUMBER]
    number = next((one for one in numbers if one is not None), None)
    distance = next((one for name in _PREDECESSOR if (one := balise.get(name)) is not None), None)
    spot = places.spot(balise) if distance is None or balise.all("spotLocation") else None
    return Single(
        balise,
        _whole_number(number, balise.place) if number is not None else None,
        spot,
        millimetres(decimal(distance, balise.place))[0] if distance is not None else None,
    )


def _group(
    group: Element, singles: Sequence[Single], places: Places, edges: Mapping[str, TrackEdge]
) -> Iterator[BaliseGroup]:
    euro = group.one("isEurobaliseGroup")
    numbers = _identity(group, euro)
    spot = places.spot(group) if group.all("spotLocation") else _first_place(singles)
    if numbers is None or spot is None:
        remark = _NO_IDENTITY if numbers is None else "no place on the micro level"
        places.notes.append(Note("not carried over", group.place, remark))
        return
    country, identity = numbers
    toward = _direction(group, spot, edges[spot.edge], places.notes)
    balises = _balises(group, singles, spot, toward, places.notes)
    linked = _linked(group, euro, places.notes)
    _count(group, len(balises), places.notes)
    if not linked and len(balises) < 2:
        places.notes.append(Note("not carried over", group.place, "unlinked group of which one balise is known"))
        return
    found = made(
        BaliseGroup,
        group.place,
        id=group.need("id"),
        edge=spot.edge,
        identity=identity,
        country=country,
        balises=balises,
        linked=linked,
        nominal_direction=toward if len(balises) == 1 else None,
    )
    if toward is not None and found.orientation != toward:
        places.notes.append(
            Note("doubtful", group.place, "order of its balises against its direction; the order is taken")
        )
    yield found


def _identity(group: Element, euro: Element | None) -> tuple[int, int] | None:
    """Return NID_C and NID_BG, from the Eurobalise group or else from designators; None if the document gives neither."""
    if euro is not None:
        return _whole_number(euro.need("countryID"), group.place), _whole_number(euro.need("groupID"), group.place)
    stated = {(one.get("register") or "").strip("_").upper(): one for one in group.all("designator")}
    found = [stated[name].need("entry") for name in ("NID_C", "NID_BG") if name in stated]
    return (_whole_number(found[0], group.place), _whole_number(found[1], group.place)) if len(found) == 2 else None


def _first_place(singles: Sequence[Single]) -> Spot | None:
    """Return the place of balise number 1; None if the document does not number them."""
    return next((one.spot for one in singles if one.number == 1), None)


def _direction(group: Element, spot: Spot, edge: TrackEdge, notes: list[Note]) -> Direction | None:
    """Return the nominal direction, from the direction of the kilometres or the direction of application."""
    found: dict[str, Direction] = {}
    mileage = group.get("mileageDirection")
    if mileage not in (None, "nominal", "reverse"):
        raise InputError(f"{group.place}: mileageDirection must be nominal or reverse, not {mileage!r}.")
    if mileage is not None and edge.kilometres:
        rising = edge.kilometres[0].direction
        found["mileageDirection"] = rising if mileage == "nominal" else opposite(rising)
    elif mileage is not None:
        notes.append(Note("not carried over", group.place, "mileageDirection on an edge without kilometres"))
    if len(spot.directions) == 1:
        found["applicationDirection"] = spot.directions[0]
    if len(set(found.values())) > 1:
        notes.append(Note("doubtful", group.place, "mileageDirection against applicationDirection; taken as unknown"))
        return None
    return next(iter(found.values()), None)


def _balises(
    group: Element, singles: Sequence[Single], spot: Spot, toward: Direction | None, notes: list[Note]
) -> tuple[Balise, ...]:
    """Return the balises in the order of their numbers; if order or a place is unknown, one at the group's own place."""
    _numbers(group, singles, notes)
    ordered = _ordered(singles, toward)
    if singles and ordered is None:
        notes.append(Note("not carried over", group.place, "single balises, whose order is unknown"))
    positions = _positions(ordered or [], spot, toward)
    if ordered and positions is None:
        notes.append(Note("not carried over", group.place, "single balises: not all lie on the group's net element"))
    if ordered and positions and positions[0] != spot.position_mm:
        remark = f"balise number 1 lies at {positions[0]} mm, the group at {spot.position_mm} mm; the balise is taken"
        notes.append(Note("doubtful", group.place, remark))
    if ordered and positions and any(one.number is None for one in ordered):
        notes.append(Note("assumed", group.place, "numbers of its balises, from its direction"))
    return tuple(made(Balise, group.place, position_mm=place) for place in positions or [spot.position_mm])


def _numbers(group: Element, singles: Sequence[Single], notes: list[Note]) -> None:
    """Check that numbers begin at 1 and rise one by one. InputError for a number given twice."""
    numbers = sorted(one.number for one in singles if one.number is not None)
    if len(set(numbers)) < len(numbers):
        raise InputError(f"{group.place}: two of its balises have the same number; numbers are {numbers}.")
    if numbers and numbers != list(range(1, len(numbers) + 1)):
        notes.append(Note("doubtful", group.place, f"numbers of its balises are {numbers}; their order is taken"))


def _ordered(singles: Sequence[Single], toward: Direction | None) -> list[Single] | None:
    numbers = [one.number for one in singles]
    if all(number is not None for number in numbers):
        return sorted(singles, key=lambda one: one.number or 0)
    if any(one.spot is None for one in singles) or toward is None:
        return None
    return sorted(singles, key=lambda one: one.spot.position_mm if one.spot else 0, reverse=toward == "decreasing")


def _positions(ordered: Sequence[Single], spot: Spot, toward: Direction | None) -> list[int] | None:
    positions: list[int] = []
    for one in ordered:
        if one.spot is not None and one.spot.edge == spot.edge:
            positions.append(one.spot.position_mm)
        elif one.spot is None and one.distance_mm is not None and positions and toward is not None:
            positions.append(positions[-1] + (one.distance_mm if toward == "increasing" else -one.distance_mm))
        elif one.spot is None and not positions and one.number == 1:
            positions.append(spot.position_mm)
        else:
            return None
    return positions


def _linked(group: Element, euro: Element | None, notes: list[Note]) -> bool:
    linked = None if euro is None else euro.get("isLinked")
    if euro is None or linked is None:
        notes.append(Note("assumed", group.place, "linked: the document does not say"))
        return True
    if linked not in ("true", "false", "1", "0"):
        raise InputError(f"{euro.place}: isLinked must be true or false, not {linked!r}.")
    return linked in ("true", "1")


def _count(group: Element, carried: int, notes: list[Note]) -> None:
    stated = group.get("numberOfBalisesInGroup")
    if stated is not None and _whole_number(stated, group.place) != carried:
        notes.append(
            Note("not carried over", group.place, f"numberOfBalisesInGroup {stated}: places of {carried} are known")
        )


def _whole_number(text: Any, place: str) -> int:
    value: Decimal = decimal(text, place)
    if value != value.to_integral_value():
        raise InputError(f"{place}: expected a whole number, got {text!r}.")
    return int(value)
