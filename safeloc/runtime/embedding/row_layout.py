"""The places of inputs in the row of values of a step, and the mapping from names in records to inputs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from safeloc.errors import InputError
from safeloc.language.expr import BoolVar, NumVar, Var
from safeloc.language.nodes import Value
from safeloc.language.system import TransitionSystem
from safeloc.language.units import Enumeration
from safeloc.runtime.border import Channel

Placed = Mapping[int, Value]
"""Inputs of a step: place in the row -> value. Presence flags follow from it."""


class Entry(NamedTuple):
    """An input: its place in the row, and the place of its presence flag (None: it cannot be absent).

    The input takes a value of type `kind` from `low` to `high` as it is, and a label in `members` as the number there; any
    other value needs a closer check.
    """

    var: Var
    at: int
    present_at: int | None
    kind: type
    low: int
    high: int
    members: Mapping[str, int]

    @property
    def is_named(self) -> bool:
        """Return whether the input takes truth values or labels instead of plain numbers."""
        return self.kind is bool or bool(self.members)

    def held(self, value: int | str) -> Value:
        """Return an admitted value, a label as its number."""
        return self.members[value] if isinstance(value, str) else value


def entries_of(system: TransitionSystem) -> dict[str, Entry]:
    """Return the entries of all inputs by full name, without presence flags."""
    places = {var: at for at, var in enumerate(system.inputs)}
    flags: dict[Var, int] = {option.value: places[option.present] for option in system.optionals}
    hidden = set(flags.values())
    return {var.name: _entry(var, at, flags.get(var)) for var, at in places.items() if at not in hidden}


def _entry(var: Var, at: int, present_at: int | None) -> Entry:
    if isinstance(var, BoolVar):
        return Entry(var, at, present_at, bool, False, True, {})
    labels = var.unit.members if isinstance(var.unit, Enumeration) else ()
    return Entry(var, at, present_at, int, var.low, var.high, {label: n for n, label in enumerate(labels)})


def routes_of(entries: Mapping[str, Entry], other_names: Mapping[str, str]) -> dict[str, tuple[Entry, ...]]:
    """Map each name in records to inputs: to one, or in a composition to one of every machine with an input of that name.

    other_names  further names of inputs
    """
    routes: dict[str, tuple[Entry, ...]] = {}
    for full, entry in entries.items():
        for name in dict.fromkeys((full, full.rpartition(".")[2])):
            routes[name] = (*routes.get(name, ()), entry)
    for name, other in other_names.items():
        routes[name] = (*routes.get(name, ()), *routes[other])
    return routes


def limits(name: str, entries: Sequence[Entry]) -> Channel | None:
    """Return the range that all of these inputs have in common; None if one of them is no plain number."""
    numbers = [one.var for one in entries if isinstance(one.var, NumVar) and not one.is_named]
    if len(numbers) < len(entries):
        return None
    low, high = max(var.low for var in numbers), min(var.high for var in numbers)
    if low > high or not all(var.unit.same(numbers[0].unit) for var in numbers):
        raise InputError(f"inputs {[var.name for var in numbers]} share the name {name!r} but no range and unit.")
    return Channel(name, numbers[0].unit.name, low, high, 0)


def beginnings(name: str) -> list[str]:
    """Return the possible channels of an input: of `front_marker_since_mm`, front, front_marker, front_marker_since and itself."""
    parts = name.split("_")
    return ["_".join(parts[:count]) for count in range(1, len(parts) + 1)]
