"""The map of many vehicles with the balise machine: it announces the next group when the machine asks for it."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from safeloc.models.balise.groups import Group, announcement
from safeloc.models.balise.variables import BaliseConfig
from safeloc.runtime.streams.steps import Cell
from safeloc.simulation.many_runs import Array

ASKED = ("valid", "wants_linking", "position_mm", "margin_above_mm")
"""Outputs of the machine that the map hears."""
_NOTHING = np.iinfo(np.int64).min


@dataclass(frozen=True)
class RouteSet:
    """A route set in `cycle`: from then on the map announces these groups instead, and linking begins anew with REPLACE."""

    cycle: int
    groups: Sequence[Group]


class Announcing:
    """The maps of vehicles, each with its routes by the cycles in which they are set; the first one in cycle 0."""

    def __init__(self, config: BaliseConfig, routes: Sequence[Mapping[int, Sequence[Group]]]) -> None:
        self._config = config
        self._ahead: list[_Ahead] = [_Ahead(())] * len(routes)
        self._set: dict[int, list[tuple[int, _Ahead]]] = {}
        known: dict[int, _Ahead] = {}
        for vehicle, own in enumerate(routes):
            for cycle, groups in own.items():
                ahead = known.setdefault(id(groups), _Ahead(groups))
                self._set.setdefault(cycle, []).append((vehicle, ahead))
        self._announced_mm = np.full(len(routes), _NOTHING)
        self._replaces = np.zeros(len(routes), dtype=np.bool_)

    def announced(self, cycle: int, told: Mapping[str, Array]) -> Iterator[tuple[int, Mapping[str, Cell]]]:
        """Yield each vehicle that is told something in a cycle, with its inputs: the next group ahead of what was announced before.

        told  outputs `ASKED` of the machines after the cycle before, array [vehicle] each
        """
        for vehicle, ahead in self._set.get(cycle, ()):
            self._ahead[vehicle], self._announced_mm[vehicle] = ahead, _NOTHING
            self._replaces[vehicle] = cycle > 0
        valid = told["valid"]
        self._announced_mm[~valid] = _NOTHING
        replaces = self._replaces & valid
        self._replaces[:] = False
        asks = told["wants_linking"] & valid | replaces
        if asks.any():
            yield from self._next_groups(np.flatnonzero(asks), replaces, told)

    def _next_groups(
        self, asking: Array, replaces: Array, told: Mapping[str, Array]
    ) -> Iterator[tuple[int, Mapping[str, Cell]]]:
        here = told["position_mm"][asking] + told["margin_above_mm"][asking] - self._config.antenna_mm
        before = self._announced_mm[asking]
        beyond = np.where(before == _NOTHING, here, before)
        for vehicle, place_mm in zip(asking.tolist(), beyond.tolist(), strict=True):
            group = self._ahead[vehicle].first_beyond(place_mm)
            if group is not None:
                self._announced_mm[vehicle] = group.place_mm
                yield vehicle, announcement(group, order="REPLACE" if replaces[vehicle] else "ADD")
            elif replaces[vehicle]:
                yield vehicle, {"linking_order": "WITHDRAW"}


class _Ahead:
    """The linked groups of a route, in order of place."""

    def __init__(self, groups: Sequence[Group]) -> None:
        self._groups = sorted((group for group in groups if group.linked), key=lambda group: group.place_mm)
        self._places_mm = [group.place_mm for group in self._groups]

    def first_beyond(self, place_mm: int) -> Group | None:
        """Return the first group beyond a place."""
        number = bisect_right(self._places_mm, place_mm)
        return self._groups[number] if number < len(self._groups) else None
