"""Validation of the inputs of a batch run by the interpreter's rules, for arrays. It clips no value and fills in none."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from safeloc.codegen.numpy_code import Array, load, to_function
from safeloc.errors import InputError
from safeloc.language.expr import BoolVar, Lit, NumVar, Optional, Var
from safeloc.language.interpret import start
from safeloc.language.machine import Any_
from safeloc.language.nodes import Value
from safeloc.language.renamed import renamed
from safeloc.language.system import TransitionSystem, canonical


def admitted_inputs(system: TransitionSystem, inputs: Mapping[str, Array]) -> tuple[list[Array], int, int]:
    """Return arrays [step, run] in the order of the system's inputs, the number of steps and the number of runs.

    Raises InputError, naming array, step and run, for a wrong type, shape, name, missing array or value out of range.
    """
    steps, runs = _shape(system, inputs)
    left = dict(inputs)
    columns: dict[Var, Array] = {}
    for option in system.optionals:
        value, present = left.pop(option.value.name, None), left.pop(option.present.name, None)
        columns |= _optional(system, option, value, present, (steps, runs))
    for var in system.inputs:
        if var not in columns:
            if var.name not in left:
                raise InputError(f"{system.name}: input {var.name!r} is missing{_renamed(left, system.inputs)}.")
            columns[var] = _admitted(system, var, left.pop(var.name))
    if left:
        raise InputError(f"{system.name}: unknown inputs {sorted(left)}{_renamed(left, system.inputs)}.")
    return [columns[var] for var in system.inputs], steps, runs


def _renamed(given: Iterable[str], known: Iterable[Var]) -> str:
    return renamed(given, [var.name for var in known])


def _shape(system: TransitionSystem, inputs: Mapping[str, Array]) -> tuple[int, int]:
    for name, array in inputs.items():
        if type(array) is not np.ndarray:  # a masked array would lose its mask
            raise InputError(f"{system.name}: input {name!r} is a {type(array).__name__}; it must be a plain array.")
    shapes = sorted({array.shape for array in inputs.values()})
    if len(shapes) != 1 or len(shapes[0]) != 2:
        raise InputError(f"{system.name}: inputs must be arrays of one shape [step, run]; got {shapes}.")
    return shapes[0][0], shapes[0][1]


def _optional(
    system: TransitionSystem, option: Optional, value: Array | None, present: Array | None, shape: tuple[int, int]
) -> dict[Var, Array]:
    """Return the arrays of value and presence; without a presence array, the value is present in every step."""
    if present is None:
        present = np.broadcast_to(np.bool_(value is not None), shape)
    if value is None:
        value = np.full(shape, canonical(option.value))
        wrong = present
    else:
        rows, flags = _different(value), _different(present)
        wrong = np.logical_and(np.logical_not(flags), rows != canonical(option.value))
    flags, numbers = _admitted(system, option.present, present), _admitted(system, option.value, value)
    if wrong.any():
        step, run = np.argwhere(wrong)[0]
        raise InputError(
            f"{system.name}: at step {step}, run {run}, {option.present.name!r} is {flags[step, run]} but "
            f"{option.value.name!r} is {numbers[step, run]}; an absent value is written as {canonical(option.value)}, "
            "and a present one needs its array."
        )
    return {option.value: numbers, option.present: flags}


def _admitted(system: TransitionSystem, var: Var, array: Array) -> Array:
    """Return the array as int64 or bool; floats (and so NaN) are refused, whatever their values."""
    _check_type(f"{system.name}: input {var.name!r}", var, array)
    if isinstance(var, BoolVar):
        return array
    rows = _different(array)
    if rows.size and (rows.min() < var.low or rows.max() > var.high):
        step, run = np.argwhere(np.logical_or(array < var.low, array > var.high))[0]
        raise InputError(
            f"{system.name}: input {var.name!r} at step {step}, run {run} is {array[step, run]}, outside "
            f"{var.low}..{var.high} {var.unit.name}."
        )
    return array.astype(np.int64, copy=False)


def _different(array: Array) -> Array:
    """Return the rows of an array that may differ: of one whose rows are all one row in memory, that row."""
    return array[:1] if array.strides[0] == 0 else array


def _check_type(what: str, var: Var, array: Array) -> None:
    if isinstance(var, BoolVar) and array.dtype != np.bool_:
        raise InputError(f"{what} has dtype {array.dtype}; it takes booleans.")
    if isinstance(var, NumVar) and not np.issubdtype(array.dtype, np.integer):
        raise InputError(f"{what} has dtype {array.dtype}; it takes whole numbers.")


# ------------------------------------------------------------------ first states


def first_states(system: TransitionSystem, chosen: Mapping[str, Array | Value], runs: int) -> list[Array]:
    """Return the first state of every run: arrays [run] in the order of the system's state.

    Raises InputError if `interpret.start` would refuse the first state of any run.
    """
    spread = {name: array for name, array in chosen.items() if isinstance(array, np.ndarray)}
    if not spread:
        values = start(system, {name: value for name, value in chosen.items() if not isinstance(value, np.ndarray)})
        return [_filled(var, values[var], runs) for var in system.state]
    unknown = sorted(set(chosen) - {var.name for var in system.state})
    if unknown:
        raise InputError(f"{system.name}: unknown state variables {unknown}{_renamed(unknown, system.state)}.")
    state = [_first(system, var, chosen, runs) for var in system.state]
    _check_initially(system, state)
    return state


def _first(system: TransitionSystem, var: Var, chosen: Mapping[str, Array | Value], runs: int) -> Array:
    low, high = _allowed(system, var)
    array = chosen.get(var.name, min(max(0, low), high))
    if not isinstance(array, np.ndarray):
        array = _filled(var, array, runs)
    what = f"{system.name}: start {var.name!r}"
    if array.shape != (runs,):
        raise InputError(f"{what} has shape {array.shape}, expected ({runs},).")
    _check_type(what, var, array)
    _check_every_run(f"{what} must be {low}..{high}", np.logical_and(array >= low, array <= high))
    return array.astype(np.bool_ if isinstance(var, BoolVar) else np.int64)


def _allowed(system: TransitionSystem, var: Var) -> tuple[int, int]:
    """Return the least and the greatest first value of a variable: its range if declared ANY, else the declared value."""
    declared = system.initial[var]
    if isinstance(declared, Any_):
        return (var.low, var.high) if isinstance(var, NumVar) else (0, 1)
    value = declared.value if isinstance(declared, Lit) else declared
    return value, value


def _filled(var: Var, value: object, runs: int) -> Array:
    return np.full(runs, value, dtype=np.bool_ if isinstance(var, BoolVar) else np.int64)


def _check_initially(system: TransitionSystem, state: Sequence[Array]) -> None:
    starts = load(to_function("starts", {"state": system.state}, [[system.init]]), "starts")
    _check_every_run(f"{system.name}: the chosen first state must satisfy `initially`", starts(state)[0][0])


def _check_every_run(what: str, good: Array) -> None:
    if not good.all():
        raise InputError(f"{what}, which run {np.argmin(good)} does not satisfy.")
