"""The options of a design: what stands on the line, and what may be added; each is chosen or not."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TypeAlias

from safeloc.errors import InputError
from safeloc.models.layout_rules import LayoutConfig
from safeloc.railway.design.figures import Costs
from safeloc.railway.map.elements import BaliseGroup, Marker, Reflector
from safeloc.railway.map.model import Line
from safeloc.railway.map.walk import Walk

Installed: TypeAlias = BaliseGroup | Reflector | Marker
_KINDS: dict[type[Installed], str] = {BaliseGroup: "balise group", Reflector: "reflector", Marker: "marker"}


@dataclass(frozen=True)
class Option:
    """An element that is kept, left out or added.

    new        it does not stand yet
    kept_for   why it has to be kept; empty if it may be left out
    """

    element: Installed
    cost_eur: int
    new: bool
    kept_for: str = ""

    @property
    def place(self) -> tuple[str, int]:
        """Edge and position."""
        return self.element.edge, self.element.position_mm

    @property
    def kind(self) -> str:
        """The kind in words."""
        return _KINDS[type(self.element)]


@dataclass(frozen=True, eq=False)
class Options:
    """All options of a design on one line."""

    line: Line
    every: tuple[Option, ...]

    @cached_property
    def costs(self) -> list[int]:
        """The cost of each, EUR."""
        return [one.cost_eur for one in self.every]

    @cached_property
    def number(self) -> dict[tuple[str, str], int]:
        """The number of each, by kind and identity of its element."""
        return {(one.kind, one.element.id): number for number, one in enumerate(self.every)}

    def number_of(self, element: Installed) -> int:
        """Return the number of an element."""
        return self.number[_KINDS[type(element)], element.id]

    @cached_property
    def walk(self) -> Walk:
        """The line with all options on it at once, to see what lies ahead of what."""
        return Walk(self.with_only(range(len(self.every))))

    def with_only(self, chosen: Iterable[int]) -> Line:
        """Return the line with these options alone. What a balise tells of a reflector that is left out, it no longer tells."""
        elements = [self.every[number].element for number in sorted(chosen)]
        reflectors = tuple(one for one in elements if isinstance(one, Reflector))
        groups = tuple(one for one in elements if isinstance(one, BaliseGroup))
        markers = tuple(one for one in elements if isinstance(one, Marker))
        named = {one.id for one in reflectors}
        told = tuple(_telling_only_of(one, named) for one in groups)
        update = {"checksum": None, "balise_groups": told, "reflectors": reflectors, "markers": markers}
        return self.line.model_copy(update=update)


def _telling_only_of(group: BaliseGroup, reflectors: set[str]) -> BaliseGroup:
    left = tuple(one for one in group.telegram_reflectors if one.reflector in reflectors)
    return group if left == group.telegram_reflectors else group.model_copy(update={"telegram_reflectors": left})


def kept(line: Line, wanted: Sequence[str]) -> frozenset[tuple[str, str]]:
    """Return kind in words and identity of each element that is to be kept; it is named by its identity, or as markers=IDENTITY.

    InputError if the line has no such element, and if elements of two kinds have the identity and none is said.
    """
    return frozenset(_kept(line, one) for one in wanted)


def _kept(line: Line, wanted: str) -> tuple[str, str]:
    lists: dict[str, Sequence[Installed]] = {
        "balise_groups": line.balise_groups, "reflectors": line.reflectors, "markers": line.markers
    }  # fmt: skip
    said, equals, rest = wanted.partition("=")
    identity = rest if equals and said in lists else wanted
    among = {said: lists[said]} if identity != wanted else lists
    found = {key: _KINDS[type(one)] for key, elements in among.items() for one in elements if one.id == identity}
    if not found:
        what = f"{said} with id" if identity != wanted else "balise group, reflector or marker"
        raise InputError(f"{line.name} has no {what} {identity!r}.")
    if len(found) > 1:
        ways = " or ".join(f"--keep {key}={identity}" for key in found)
        raise InputError(f"{line.name}: {identity!r} is a {' and a '.join(found.values())}; say which: {ways}.")
    return next(iter(found.values())), identity


def standing(line: Line, costs: Costs, keep: Sequence[str], layout: LayoutConfig | None = None) -> Iterator[Option]:
    """Yield an option for each balise group, reflector and marker of the line. Kept are those of `keep`, those that others refer to,
    and what a vehicle of these figures is not located by, so that other vehicles still find it.
    """
    asked = kept(line, keep)
    not_read = _not_read(layout or LayoutConfig())
    stops = {one.reflector: one.id for one in line.stop_points}
    originals = {one.duplicate_of: one.id for one in line.balise_groups if one.duplicate_of is not None}
    for group in line.balise_groups:
        why = (
            f"group {originals[group.id]} is its duplicate" if group.id in originals else not_read.get(BaliseGroup, "")
        )
        yield Option(
            group, costs.of(group, new=False), False, "as asked" if ("balise group", group.id) in asked else why
        )
    for reflector in line.reflectors:
        why = f"stop point {stops[reflector.id]}" if reflector.id in stops else not_read.get(Reflector, "")
        yield Option(
            reflector,
            costs.of(reflector, new=False),
            False,
            "as asked" if ("reflector", reflector.id) in asked else why,
        )
    for marker in line.markers:
        why = "as asked" if ("marker", marker.id) in asked else not_read.get(Marker, "")
        yield Option(marker, costs.of(marker, new=False), False, why)


def _not_read(layout: LayoutConfig) -> dict[type[Installed], str]:
    """Return the kinds of elements that do not locate the vehicle, with the reason for which they are kept."""
    why = "other vehicles read it"
    if layout.markers is None:
        return {Marker: why}
    return {Reflector: why} if layout.markers.groups_are_markers else {Reflector: why, BaliseGroup: why}
