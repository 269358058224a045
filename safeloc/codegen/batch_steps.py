"""Many runs of a system, one step at a time: inputs of a step may follow from what the runs told in the step before.

code = compile_steps(system, keep=["position_mm"])    once for a system
runs = code.begin(inputs)                             arrays [step, run] of all inputs, optional ones with `name.present`
runs.told["position_mm"]                              array [run]: the output after the last step, at first that of the first state
runs.step(number)                                     takes that row of the inputs, which may have been written just before
code.through(inputs)["position_mm"]                   array [step, run]: all steps at once, where no input follows from what was told

A few runs take generated Python, many take C over vector lanes, or numpy where there is no compiler; all tell the same. The
code checks nothing: inputs must be in their ranges, and an absent value must be written as `absent_everywhere` does.
"""

from __future__ import annotations

import ctypes
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Protocol

import numpy as np

from safeloc.codegen.batch import Batch, compile_batch
from safeloc.codegen.batch_inputs import first_states
from safeloc.codegen.batch_lanes import LanesBatch, compile_lanes
from safeloc.codegen.c99_build import compiler
from safeloc.codegen.compiled import Compiled, compile_system
from safeloc.codegen.numpy_code import Array, Function
from safeloc.errors import EngineError, InputError
from safeloc.language.expr import Num
from safeloc.language.interpret import outputs, start
from safeloc.language.system import TransitionSystem

_BLOCK_RUNS = 8_192
_FEW = 8
"""Fewer runs than this are stepped one by one: no register has more lanes."""


class Runs(Protocol):
    """Runs under way."""

    @property
    def told(self) -> Mapping[str, Array]:
        """The kept outputs after the last step: name -> array [run], overwritten by the next step."""
        ...

    def step(self, number: int) -> None:
        """Take the step with this row of the inputs."""
        ...


@dataclass(frozen=True, eq=False)
class Stepped:
    """A system that is stepped in many runs. `folder` stores compiled C for later processes; the default is a temporary one."""

    system: TransitionSystem
    keep: tuple[str, ...]
    folder: Path | None = None

    def begin(self, inputs: Mapping[str, Array]) -> Runs:
        """Return the runs before their first step, one for each column of the inputs.

        InputError for a missing input, and for arrays that differ in shape or do not lie in memory row by row.
        """
        columns = self._columns(inputs)
        runs = columns[0].shape[1]
        told = self._told_first(runs)
        if runs < _FEW:
            return _OneByOne(self.python, columns, told)
        state = first_states(self.system, {}, runs)
        if self._lanes is None:
            return _InNumpy(self._numpy.step, columns, state, told)
        return _InLanes(self._lanes, columns, state, told)

    def through(self, inputs: Mapping[str, Array]) -> dict[str, Array]:
        """Take all steps; return the kept outputs after each: name -> array [step, run]. InputError as in `begin`."""
        columns = self._columns(inputs)
        steps, runs = columns[0].shape
        found = {name: np.empty((steps, runs), _dtype(self.system.outputs[name])) for name in self.keep}
        batch = None if runs < _FEW else self._lanes or self._numpy
        if batch is not None:
            batch.moved(columns, first_states(self.system, {}, runs), list(found.values()), _BLOCK_RUNS)
            return found
        taken = self.begin(inputs)
        for number in range(steps):
            taken.step(number)
            for name, values in found.items():
                values[number] = taken.told[name]
        return found

    def _columns(self, inputs: Mapping[str, Array]) -> list[Array]:
        missing = [var.name for var in self.system.inputs if var.name not in inputs]
        if missing:
            raise InputError(f"{self.system.name}: input {missing[0]!r} is missing.")
        columns = [inputs[var.name] for var in self.system.inputs]
        for var, column in zip(self.system.inputs, columns, strict=True):
            if (column.dtype, column.shape) != (_dtype(var), columns[0].shape) or not column.flags.c_contiguous:
                raise InputError(
                    f"{self.system.name}: input {var.name!r} is {column.dtype} {column.shape}; all inputs must be contiguous "
                    f"arrays of one shape [step, run], of int64 or bool."
                )
        return columns

    def _told_first(self, runs: int) -> dict[str, Array]:
        first = outputs(self.system, start(self.system, {}))
        return {name: np.full(runs, first[name], _dtype(self.system.outputs[name])) for name in self.keep}

    @cached_property
    def python(self) -> Compiled:
        """The system in generated Python."""
        return compile_system(self.system)

    @cached_property
    def _numpy(self) -> Batch:
        return compile_batch(self.system, self.keep)

    @cached_property
    def _lanes(self) -> LanesBatch | None:
        """The system in C; None without a compiler."""
        try:
            cc = compiler()
        except EngineError:
            return None
        return compile_lanes(self.system, self.keep, threads=1, folder=self.folder, cc=cc)


def compile_steps(system: TransitionSystem, keep: Sequence[str], *, folder: Path | None = None) -> Stepped:
    """Prepare a system, in which `keep` names the outputs that are told. InputError for a name that is no output."""
    unknown = [name for name in keep if name not in system.outputs]
    if unknown:
        raise InputError(f"{system.name}: no output {unknown[0]!r}; it has {list(system.outputs)}.")
    return Stepped(system, tuple(keep), folder)


def _dtype(term: object) -> np.dtype[np.int64] | np.dtype[np.bool_]:
    return np.dtype(np.int64) if isinstance(term, Num) else np.dtype(np.bool_)


@dataclass(eq=False)
class _OneByOne:
    """Each run in generated Python."""

    code: Compiled
    columns: list[Array]
    told: dict[str, Array]
    states: list[tuple[int, ...]] = field(init=False)

    def __post_init__(self) -> None:
        self.states = [self.code.first()] * self.columns[0].shape[1]
        self._places = [self.code.output_names.index(name) for name in self.told]

    def step(self, number: int) -> None:
        """Take the step."""
        for run, state in enumerate(self.states):
            row = tuple([column.item(number, run) for column in self.columns])
            self.states[run], _ = self.code.step(state, row)
            outputs_ = self.code.outputs(self.states[run])
            for values, place in zip(self.told.values(), self._places, strict=True):
                values[run] = outputs_[place]


@dataclass(eq=False)
class _InNumpy:
    """All runs in numpy."""

    function: Function
    columns: list[Array]
    state: list[Array]
    told: dict[str, Array]

    def step(self, number: int) -> None:
        """Take the step."""
        self.state, kept = self.function(self.state, [column[number] for column in self.columns])
        for values, found in zip(self.told.values(), kept, strict=True):
            values[:] = found


class _InLanes:
    """All runs in C. Two states take turns, since the last lanes of a block may step a run twice."""

    def __init__(self, batch: LanesBatch, columns: list[Array], state: list[Array], told: dict[str, Array]) -> None:
        self.told = told
        self._kept = (
            columns,
            [state, [np.empty_like(array) for array in state]],
        )  # the addresses below must stay theirs
        self._of_states = [_addresses(arrays) for arrays in self._kept[1]]
        self._of_told, self._first_rows = _addresses(list(told.values())), _addresses(columns)
        self._row_bytes = np.array([column.strides[0] for column in columns], dtype=np.uintp)
        self._rows, self._strides = self._first_rows.copy(), np.zeros(len(columns), dtype=np.uintp)
        runs = len(state[0])
        sizes = tuple(ctypes.c_size_t(size) for size in (runs, 0, runs, 1))
        before, after, rows, strides, of_told = (
            ctypes.c_void_p(array.ctypes.data) for array in (*self._of_states, self._rows, self._strides, self._of_told)
        )
        self._given = [
            (one, other, rows, strides, of_told, *sizes) for one, other in ((before, after), (after, before))
        ]
        self._run = batch.library.run_lanes

    def step(self, number: int) -> None:
        """Take the step."""
        np.multiply(self._row_bytes, np.uintp(number), out=self._rows)
        np.add(self._rows, self._first_rows, out=self._rows)
        self._run(*self._given[0])
        self._given.reverse()


def _addresses(arrays: Sequence[Array]) -> Array:
    return np.array([array.ctypes.data for array in arrays], dtype=np.uintp)
