"""Inputs of many vehicles under their names: arrays over cycles and vehicles, and the steps of one vehicle made from them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from safeloc.language.expr import NumVar
from safeloc.language.system import TransitionSystem, canonical
from safeloc.language.units import Enumeration
from safeloc.runtime.streams.steps import Cell
from safeloc.simulation.many_runs import Array


@dataclass(frozen=True, eq=False)
class Column:
    """Values of an input: array [cycle, vehicle], or one that spreads to it.

    present  where the input is present; None: everywhere
    """

    values: Array | int | bool
    present: Array | None = None


Columns = Mapping[str, Column]
"""Columns by the names of the inputs."""


def steps_of(system: TransitionSystem, inputs: Mapping[str, Array], vehicle: int) -> list[dict[str, Cell]]:
    """Return the steps of one vehicle from the arrays of a system's inputs, without absent inputs; enumerations by their labels."""
    flags = {option.value.name: option.present.name for option in system.optionals}
    hidden = set(flags.values())
    lists = {name: values[:, vehicle].tolist() for name, values in inputs.items()}
    labels = {
        var.name: var.unit.members
        for var in system.inputs
        if isinstance(var, NumVar) and isinstance(var.unit, Enumeration)
    }
    shown = [
        (name, values, lists.get(flags.get(name, "")), labels.get(name))
        for name, values in lists.items()
        if name not in hidden
    ]
    return [
        {
            name: labelled[values[cycle]] if labelled else values[cycle]
            for name, values, present, labelled in shown
            if present is None or present[cycle]
        }
        for cycle in range(len(next(iter(lists.values()))))
    ]


def arrays_of(columns: Columns, system: TransitionSystem, shape: tuple[int, int]) -> dict[str, Array]:
    """Return the columns that are inputs of a system as its arrays; an absent value is written as the system wants it.

    What is the same in all cycles stands in memory once (`numpy.broadcast_to`).
    """
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
    found = np.asarray(values)
    if found.ndim == 0 or len(found) == 1:
        row = np.ascontiguousarray(np.broadcast_to(found.reshape(-1), shape[1:]))
        return np.broadcast_to(row, shape)
    return np.ascontiguousarray(np.broadcast_to(found, shape))
