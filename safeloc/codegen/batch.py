"""Many runs at once in numpy, over arrays of shape [step, run].

The generated code is straight-line, over int64 and bool arrays, and takes the runs in blocks that fit the processor's cache.
int64 wraps around without an error, so a system whose terms might exceed 64 bits is refused.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from safeloc.codegen.batch_inputs import admitted_inputs, first_states
from safeloc.codegen.numpy_code import Array, Function, load, to_function
from safeloc.errors import InputError
from safeloc.language.expr import Expr, Num
from safeloc.language.nodes import Value
from safeloc.language.ranges import beyond_int64
from safeloc.language.renamed import renamed
from safeloc.language.system import TransitionSystem
from safeloc.language.terms import Substitution

_BLOCK_RUNS = (
    8192  # 64 KiB an array: fits the cache, and is below the size for which the allocator calls the kernel each time
)


@dataclass(frozen=True)
class BatchTrace:
    """The result of a batch run.

    kept  recorded values: name -> array [step, run]
    last  the last state: name -> array [run]
    """

    kept: Mapping[str, Array]
    last: Mapping[str, Array]


@dataclass(frozen=True)
class Batch:
    """A system as a numpy function: `step(state arrays, input arrays)` for one block of runs.

    keep  names of the values that are recorded in every step
    """

    system: TransitionSystem
    source: str
    keep: tuple[str, ...]
    step: Function

    def moved(self, columns: list[Array], state: list[Array], kept: list[Array], block_runs: int) -> list[Array]:
        """Run all steps of all runs; return the last states, and write the recorded values into `kept`."""
        runs = len(state[0])
        for begin in range(0, runs, block_runs):
            _run_block(self.step, columns, state, kept, slice(begin, min(begin + block_runs, runs)))
        return state


class Prepared(Protocol):
    """A system ready to run over arrays: a Batch, or a LanesBatch."""

    @property
    def system(self) -> TransitionSystem:
        """The system that runs."""
        ...

    @property
    def keep(self) -> tuple[str, ...]:
        """The names of the values that are recorded in every step."""
        ...

    def moved(self, columns: list[Array], state: list[Array], kept: list[Array], block_runs: int) -> list[Array]:
        """Run all steps of all runs; return the last states, and write the recorded values into `kept`."""
        ...


def compile_batch(system: TransitionSystem, keep: Sequence[str] = ()) -> Batch:
    """Generate and load the function. `keep` names the state variables, outputs and fired variables to record.

    Raises InputError for an unknown name, and for a system whose terms may exceed 64 bits.
    """
    soundly_64_bits(system)
    source = _to_numpy(system, keep)
    return Batch(system, source, tuple(keep), load(source, "step"))


def soundly_64_bits(system: TransitionSystem) -> None:
    """Raise InputError if a term might exceed 64 bits, whichever branch is taken."""
    wide = beyond_int64([*system.next.values(), *system.fired.values(), *system.outputs.values(), system.init])
    if wide:
        raise InputError(
            f"{system.name}: {len(wide)} terms may exceed 64 bits, for example {wide[0]!r}; narrow the ranges of their "
            "variables."
        )


def simulate(
    system: TransitionSystem | Prepared,
    inputs: Mapping[str, Array],
    *,
    start_state: Mapping[str, Array | Value] | None = None,
    keep: Sequence[str] = (),
    block_runs: int = _BLOCK_RUNS,
) -> BatchTrace:
    """Run every column of the inputs.

    inputs       name -> array [step, run], integers or booleans; optional inputs may be left out (absent), or come
                 with `name.present`
    start_state  name -> value or array [run], for variables declared ANY
    keep         as in `compile_batch`; leave it out for a Batch or LanesBatch, which has its own
    block_runs   the number of runs that take all steps before the next runs begin

    Raises InputError, naming array, step and run, for a wrong dtype, shape, name or value out of range.
    """
    if block_runs < 1 or (keep and not isinstance(system, TransitionSystem)):
        raise InputError(
            f"block_runs is {block_runs}, keep is {keep}; give a block_runs of at least 1, and no keep for a compiled batch."
        )
    batch = compile_batch(system, keep) if isinstance(system, TransitionSystem) else system
    columns, steps, runs = admitted_inputs(batch.system, inputs)
    state = first_states(batch.system, start_state or {}, runs)
    kept = [np.empty((steps, runs), dtype=_dtype_of(batch.system, name)) for name in batch.keep]
    state = batch.moved(columns, state, kept, block_runs)
    last = {var.name: array for var, array in zip(batch.system.state, state, strict=True)}
    return BatchTrace(dict(zip(batch.keep, kept, strict=True)), last)


def _run_block(step: Function, columns: list[Array], state: list[Array], kept: list[Array], block: slice) -> None:
    now = [np.ascontiguousarray(array[block]) for array in state]
    for number in range(len(columns[0])):
        now, shown = step(now, [column[number, block] for column in columns])
        for target, values in zip(kept, shown, strict=True):
            target[number, block] = values
    for target, values in zip(state, now, strict=True):
        target[block] = values


def _dtype_of(system: TransitionSystem, name: str) -> type[np.generic]:
    return np.int64 if isinstance(keepable(system, name), Num) else np.bool_


def keepable(system: TransitionSystem, name: str) -> Expr:
    """Return the term, over state before the step and inputs, of a value to record; InputError for an unknown name."""
    for var in system.state:
        if var.name == name:
            return system.next[var]
    for fired, term in system.fired.items():
        if fired.name == name:
            return term
    if name in system.outputs:
        return _after(system, system.outputs[name])
    known = list(dict.fromkeys([var.name for var in (*system.state, *system.fired)] + list(system.outputs)))
    raise InputError(f"{system.name}: cannot keep {name!r}; it has {known}{renamed([name], known)}.")


def _after(system: TransitionSystem, term: Expr) -> Expr:
    return Substitution(dict(system.next))(term)


def _to_numpy(system: TransitionSystem, keep: Sequence[str] = ()) -> str:
    """Return the source of `step(state, inputs)` -> (state after, recorded values)."""
    kept = [keepable(system, name) for name in keep]
    moved = [system.next[var] for var in system.state]
    return to_function("step", {"state": system.state, "inputs": system.inputs}, [moved, kept])
