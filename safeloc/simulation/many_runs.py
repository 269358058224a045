"""Runs of many vehicles at once: inputs of a machine as arrays, and what of a simulation a campaign may draw.

A simulation of many vehicles (ManySimulation) names the figures that it takes, each with unit and range, and the places with their
kinds of fault. Faults are those of the single run (safeloc.simulation.faults).
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from safeloc.errors import InputError
from safeloc.language.expr import BoolVar, NumVar, Var
from safeloc.language.interpret import admitted
from safeloc.language.nodes import Value
from safeloc.language.system import TransitionSystem, canonical
from safeloc.language.units import Enumeration
from safeloc.runtime.streams.steps import Cell
from safeloc.simulation.faults import Fault, Kinds
from safeloc.simulation.vehicle_seed import VehicleSeed

Array = NDArray[Any]


@dataclass(frozen=True)
class DrawnFigure:
    """A figure of a simulation that may differ from vehicle to vehicle.

    discrete  each value costs a computation of its own, so that only single values may be drawn
    """

    unit: str
    low: float
    high: float
    default: float
    what: str
    discrete: bool = False


@dataclass(frozen=True, eq=False)
class Drawn:
    """The draws of each vehicle: figures (name -> array [vehicle]), faults, and the seed of its sensors.

    weights  the number of vehicles of the declared distributions for which each stands; None: 1 each
    """

    vehicles: int
    figures: Mapping[str, NDArray[np.float64]]
    faults: Sequence[Sequence[Fault]]
    seeds: Sequence[VehicleSeed]
    weights: NDArray[np.float64] | None = None


@dataclass(frozen=True, eq=False)
class ManyRuns:
    """Inputs of many runs, ghosts included: name -> array [cycle, vehicle], with `name.present` of optional ones.

    first  values of open state variables: name -> value or array [vehicle]
    """

    inputs: Mapping[str, Array]
    first: Mapping[str, Array | Value] = field(default_factory=dict)


class ManySimulation(Protocol):
    """A simulation of many vehicles of one kind on one line."""

    @property
    def figures(self) -> Mapping[str, DrawnFigure]:
        """The figures that may be drawn, by name."""
        ...

    @property
    def kinds(self) -> Mapping[str | int, Kinds]:
        """The places that may be faulty, each with its kinds of fault."""
        ...

    @property
    def timeless(self) -> Collection[str | int]:
        """Those of these places whose faults act for the whole run."""
        ...

    @property
    def period_ms(self) -> int:
        """The length of a cycle."""
        ...

    def runs(self, drawn: Drawn, cycles: int) -> ManyRuns:
        """Return the runs of the vehicles; the same for the same draws."""
        ...


def absent_everywhere(
    system: TransitionSystem, cycles: int, vehicles: int, *, but: Mapping[str, Array] | None = None
) -> dict[str, Array]:
    """Return arrays for all inputs, in which optional ones are absent and the others have the value nearest to zero, or false.

    but  arrays of inputs that are taken instead
    """
    known = but or {}
    return {
        var.name: known[var.name] if var.name in known else np.full((cycles, vehicles), _rest(var))
        for var in system.inputs
    }


def _rest(var: Var) -> np.int64 | np.bool_:
    return np.bool_(False) if isinstance(var, BoolVar) else np.int64(canonical(var))


def packed(system: TransitionSystem, streams: Sequence[Sequence[Mapping[str, Cell]]], cycles: int) -> dict[str, Array]:
    """Return step streams as arrays, a vehicle each, up to `cycles` cycles; names that no input has are remarks.

    Ranges are not checked here. InputError for a shorter stream, a missing input, and a value of another kind.
    """
    short = [len(stream) for stream in streams if len(stream) < cycles]
    if short:
        raise InputError(f"{system.name}: a simulated run has {short[0]} cycles; ask for no more than that.")
    flags = {option.present.name: option.value.name for option in system.optionals}
    needed = {var.name for var in system.inputs} - flags.keys() - set(flags.values())
    inputs = absent_everywhere(system, cycles, len(streams))
    writer = Writer(system, inputs)
    for run, stream in enumerate(streams):
        for cycle, step in enumerate(stream[:cycles]):
            if not needed <= step.keys():
                raise InputError(f"{system.name}: input {min(needed - step.keys())!r} is missing in a simulated step.")
            writer.write(cycle, run, step)
    return inputs


def joined(parts: Sequence[tuple[NDArray[np.int64], ManyRuns]], vehicles: int) -> ManyRuns:
    """Return the runs of several groups of vehicles, each at its own place."""
    if len(parts) == 1:
        return parts[0][1]
    inputs = {}
    for name, first in parts[0][1].inputs.items():
        inputs[name] = np.empty((len(first), vehicles), first.dtype)
        for which, part in parts:
            inputs[name][:, which] = part.inputs[name]
    return ManyRuns(inputs)


class Writer:
    """Writes cells of steps into arrays of inputs; names that no input has are remarks. Ranges are not checked here."""

    def __init__(self, system: TransitionSystem, inputs: Mapping[str, Array]) -> None:
        self._inputs, self._kinds = inputs, {var.name: _Kind(var) for var in system.inputs}
        self._present = {option.value.name: inputs[option.present.name] for option in system.optionals}

    def write(self, cycle: int, run: int, cells: Mapping[str, Cell]) -> None:
        """Write the cells of a step. InputError for a value of another kind."""
        for name, cell in cells.items():
            if name in self._kinds:
                self._inputs[name][cycle, run] = self._kinds[name].value(cell)
                if name in self._present:
                    self._present[name][cycle, run] = True


def through_border(system: TransitionSystem, inputs: Mapping[str, Array]) -> tuple[dict[str, Array], NDArray[np.int64]]:
    """Leave out optional values beyond their range, as the border on board refuses them; return the number refused of each vehicle."""
    found = dict(inputs)
    vehicles = next(iter(inputs.values())).shape[1]
    refused = np.zeros(vehicles, dtype=np.int64)
    for option in system.optionals:
        var, value = option.value, found[option.value.name]
        rows = value[:1] if value.strides[0] == 0 else value
        if rows.min() < var.low or rows.max() > var.high:
            beyond = (value < var.low) | (value > var.high)
            refused += beyond.sum(axis=0)
            found[var.name] = np.where(beyond, canonical(var), value)
            found[option.present.name] = found[option.present.name] & ~beyond
    return found, refused


def refuse_beyond_ranges(system: TransitionSystem, inputs: Mapping[str, Array]) -> None:
    """Raise InputError for the first value out of its range that any run has."""
    for var in system.inputs:
        if isinstance(var, NumVar):
            beyond = (inputs[var.name] < var.low) | (inputs[var.name] > var.high)
            if beyond.any():
                admitted(var, int(inputs[var.name][tuple(np.argwhere(beyond)[0])]))


class _Kind:
    """The kind of an input: whole number, truth value, or member of an enumeration, whose label becomes its number."""

    def __init__(self, var: Var) -> None:
        self._var = var
        self._type = bool if isinstance(var, BoolVar) else int
        members = var.unit.members if isinstance(var, NumVar) and isinstance(var.unit, Enumeration) else ()
        self._labels = {label: number for number, label in enumerate(members)}

    def value(self, cell: Cell) -> int:
        """Return the value as arrays hold it."""
        if type(cell) is self._type:
            return cell
        if isinstance(cell, str) and cell in self._labels:
            return self._labels[cell]
        return admitted(self._var, cell)  # refuses it, with the reason
