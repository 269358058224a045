"""Locations in a railML document: converts spot and linear locations to places and stretches of edges."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from decimal import Decimal
from itertools import pairwise
from typing import TypeVar

from safeloc.errors import InputError
from safeloc.railway.map.elements import Direction, Stretch
from safeloc.railway.map.imports.building import made
from safeloc.railway.map.imports.lengths import decimal, millimetres
from safeloc.railway.map.imports.notes import Note
from safeloc.railway.map.imports.railml_network import NetElement, Network, intrinsic, measure
from safeloc.railway.map.imports.railml_xml import Element

Made = TypeVar("Made")
_DIRECTIONS: Mapping[str, tuple[Direction, ...]] = {
    "normal": ("increasing",),
    "reverse": ("decreasing",),
    "both": ("increasing", "decreasing"),
}


@dataclass(frozen=True)
class Spot:
    """A place on an edge, and the directions of travel to which it applies; empty if the document gives none."""

    edge: str
    position_mm: int
    directions: tuple[Direction, ...]


@dataclass(frozen=True)
class Places:
    """Finds places on the network, and notes those that cannot be carried over."""

    network: Network
    units: Mapping[str, Decimal]
    notes: list[Note]

    def each(self, elements: Iterable[Element], convert: Callable[[Element], Iterable[Made]]) -> Iterator[Made]:
        """Yield what every element converts to. An element whose data is wrong is left out, with a note: one bad place
        is no reason to refuse the map."""
        for element in elements:
            try:
                found = list(convert(element))
            except InputError as error:
                element.skip()
                reason = str(error).removeprefix(f"{element.place}: ").rstrip(".")
                self.notes.append(Note("refused", element.place, reason))
                continue
            yield from found

    def spot(self, owner: Element) -> Spot | None:
        """Return the only place of the element on the micro level; None, with a note, if it has none or several."""
        found = [spot for location in owner.all("spotLocation") if (spot := self._spot(owner, location)) is not None]
        if len(found) == 1:
            return found[0]
        remark = "no spot location on the micro level" if not found else f"{len(found)} spot locations"
        self.notes.append(Note("not carried over", owner.place, remark))
        return None

    def stretches(self, owner: Element) -> tuple[tuple[Stretch, ...], tuple[Direction, ...]]:
        """Return the stretches of the element's linear locations on the micro level, and the directions to which they apply."""
        stretches: list[Stretch] = []
        directions: set[Direction] = set()
        for location in owner.all("linearLocation"):
            directions |= set(_directions(location))
            stretches += self._pieces(owner, location)
        if not stretches:
            self.notes.append(Note("not carried over", owner.place, "no linear location on the micro level"))
        return tuple(stretches), tuple(sorted(directions))

    def _net(self, owner: Element, location: Element) -> NetElement | None:
        name = location.need("netElementRef")
        if name in self.network.elements:
            return self.network.elements[name]
        if name in self.network.elsewhere:
            location.skip()
            self.notes.append(Note("not carried over", owner.place, "place on a coarser level"))
            return None
        raise InputError(f"{owner.place}: {location.tag} line {location.line}: there is no netElement {name!r}.")

    def _spot(self, owner: Element, location: Element) -> Spot | None:
        net = self._net(owner, location)
        if net is None:
            return None
        place = f"{owner.place}: {location.tag} line {location.line}"
        metres = self._metres(place, location, net, ("pos", "intrinsicCoord", "linearCoordinate"))
        if metres is None and location.all("linearCoordinate"):
            return None
        if metres is None:
            raise InputError(f"{place}: gives neither pos, nor intrinsicCoord, nor a linearCoordinate.")
        return Spot(net.id, self._in_element(place, metres, net), _directions(location))

    def _pieces(self, owner: Element, location: Element) -> Iterator[Stretch]:
        for piece in location.all("associatedNetElement"):
            piece.get("keepsOrientation")
            piece.get("sequence")
            net = self._net(owner, piece)
            if net is None:
                continue
            place = f"{owner.place}: {piece.tag} line {piece.line}"
            ends = [
                self._metres(place, piece, net, (f"pos{end}", f"intrinsicCoord{end}", f"linearCoordinate{end}"))
                for end in ("Begin", "End")
            ]
            one, other = sorted(
                self._in_element(place, default if stated is None else stated, net)
                for stated, default in zip(ends, (Decimal(0), net.length_m), strict=True)
            )
            yield made(Stretch, place, edge=net.id, from_mm=one, to_mm=other)

    def _metres(self, place: str, location: Element, net: NetElement, names: tuple[str, str, str]) -> Decimal | None:
        """Return the distance from the beginning of the net element, from metres, share or kilometre, in this order."""
        stated = location.get(names[0])
        share = intrinsic(location, names[1]) if location.get(names[1]) is not None else None
        linear = location.one(names[2])
        by_kilometre = None if linear is None else self._by_kilometre(place, linear, net)
        found = [
            decimal(stated, f"{place}: {names[0]}") if stated is not None else None,
            share * net.length_m if share is not None else None,
            by_kilometre,
        ]
        given = [one for one in found if one is not None]
        if given and max(given) - min(given) > 1:
            shown = ", ".join(f"{one:f} m" for one in given)
            self.notes.append(
                Note("doubtful", place, f"its coordinates are more than 1 m apart ({shown}); the first is taken")
            )
        return given[0] if given else None

    def _by_kilometre(self, place: str, linear: Element, net: NetElement) -> Decimal | None:
        """Return the place of this kilometre on the net element; None, with a note, if it cannot be determined."""
        here = measure(linear, self.units)
        points = net.measures.get(linear.need("positioningSystemRef"), ())
        for (share, low), (next_share, high) in pairwise(points):
            if low != high and min(low, high) <= here <= max(low, high):
                return (share + (next_share - share) * (here - low) / (high - low)) * net.length_m
        self.notes.append(Note("not carried over", place, f"kilometre that net element {net.id!r} does not hold"))
        return None

    def _in_element(self, place: str, metres: Decimal, net: NetElement) -> int:
        rounded, exact = millimetres(metres)
        if not 0 <= metres <= net.length_m:
            raise InputError(f"{place}: {metres} m lies outside net element {net.id!r} of {net.length_m} m.")
        if not exact:
            self.notes.append(Note("rounded", place, "position to the nearest mm"))
        return min(rounded, net.length_mm)


def _directions(location: Element) -> tuple[Direction, ...]:
    stated = location.get("applicationDirection")
    if stated is None:
        return ()
    if stated not in _DIRECTIONS:
        raise InputError(f"{location.place}: applicationDirection must be normal, reverse or both, not {stated!r}.")
    return _DIRECTIONS[stated]
