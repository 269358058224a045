"""The map of many vehicles with the balise machine: it announces the next group when the machine asks for it."""

from __future__ import annotations

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
    """The maps of vehicles for which the same routes are set in the same cycles; `routes` has the first one in cycle 0."""

    def __init__(self, config: BaliseConfig, routes: Mapping[int, Sequence[Group]], vehicles: int) -> None:
        self._config, self._routes = config, routes
        self._announced_mm = np.full(vehicles, _NOTHING)
        self._replaces = np.zeros(vehicles, dtype=np.bool_)
        self._set_route(routes[0])

    def _set_route(self, groups: Sequence[Group]) -> None:
        self._groups = sorted((group for group in groups if group.linked), key=lambda group: group.place_mm)
        self._places_mm = np.array([group.place_mm for group in self._groups], dtype=np.int64)
        self._announced_mm[:] = _NOTHING

    def announced(self, cycle: int, told: Mapping[str, Array]) -> Iterator[tuple[int, Mapping[str, Cell]]]:
        """Yield each vehicle that is told something in a cycle, with its inputs: the next group ahead of what was announced before.

        told  outputs `ASKED` of the machines after the cycle before, array [vehicle] each
        """
        if cycle and cycle in self._routes:
            self._set_route(self._routes[cycle])
            self._replaces[:] = True
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
        for vehicle, number in zip(
            asking.tolist(), np.searchsorted(self._places_mm, beyond, side="right"), strict=True
        ):
            if number < len(self._groups):
                group = self._groups[number]
                self._announced_mm[vehicle] = group.place_mm
                yield vehicle, announcement(group, order="REPLACE" if replaces[vehicle] else "ADD")
            elif replaces[vehicle]:
                yield vehicle, {"linking_order": "WITHDRAW"}
