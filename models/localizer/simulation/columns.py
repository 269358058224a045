"""Inputs of many vehicles under their names: arrays over cycles and vehicles, and the steps of one vehicle made from them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from safeloc.language.system import TransitionSystem, canonical
from safeloc.runtime.streams.steps import Cell
from safeloc.simulation.many_runs import Array


@dataclass(frozen=True, eq=False)
class Column:
    """Values of an input: array [cycle, vehicle], or one that spreads to it.

    present  where the input is present; None: everywhere
    labels   of an enumeration, whose numbers the values are
    """

    values: Array | int | bool
    present: Array | None = None
    labels: tuple[str, ...] = ()


Columns = Mapping[str, Column]
"""Columns by the names of the inputs, in the order in which a step has them."""


def steps_of(columns: Columns, shape: tuple[int, int], vehicle: int) -> list[dict[str, Cell]]:
    """Return the steps of one vehicle."""
    lists = [
        (name, _listed(one.values, shape, vehicle), None if one.present is None else _listed(one.present, shape, vehicle), one.labels)
        for name, one in columns.items()
    ]  # fmt: skip
    return [
        {
            name: labels[values[cycle]] if labels else values[cycle]
            for name, values, present, labels in lists
            if present is None or present[cycle]
        }
        for cycle in range(shape[0])
    ]


def _listed(values: Array | int | bool, shape: tuple[int, int], vehicle: int) -> list[int]:
    found: list[int] = np.broadcast_to(np.asarray(values), shape)[:, vehicle].tolist()
    return found


def arrays_of(columns: Columns, system: TransitionSystem, shape: tuple[int, int]) -> dict[str, Array]:
    """Return the columns that are inputs of a system as its arrays; an absent value is written as the system wants it."""
    absent = {option.value.name: canonical(option.value) for option in system.optionals}
    known = {var.name for var in system.inputs}
    found: dict[str, Array] = {}
    for name, one in columns.items():
        if name in known:
            found[name] = _spread(
                one.values if one.present is None else np.where(one.present, one.values, absent[name]), shape
            )
        if name in absent:
            found[f"{name}.present"] = _spread(True if one.present is None else one.present, shape)
    return found


def _spread(values: Array | int | bool, shape: tuple[int, int]) -> Array:
    return np.ascontiguousarray(np.broadcast_to(np.asarray(values), shape))
