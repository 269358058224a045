"""Many runs at once in C over numpy arrays: several runs share a vector register, and every core is used.

batch = compile_lanes(system, keep=["position_mm"])     needs a C compiler, and seconds for a large machine
trace = simulate(batch, inputs)                         as in `batch`: same arrays, same checks, same results
"""

from __future__ import annotations

import ctypes
import hashlib
import os
import subprocess
import tempfile
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from safeloc.codegen.batch import keepable, soundly_64_bits
from safeloc.codegen.c99_build import build, compiler
from safeloc.codegen.lanes_code import to_lanes
from safeloc.codegen.numpy_code import Array
from safeloc.errors import InputError
from safeloc.language.system import TransitionSystem

_NATIVE = "-march=native"
_FLAGS = ("-O1",)  # -O2 makes straight-line code no faster


@dataclass(frozen=True)
class LanesBatch:
    """A system as compiled C over vector lanes. It stores no state, so several simulations may use it at once.

    threads  the number of threads that run at once; the compiled code runs without Python's interpreter lock
    """

    system: TransitionSystem
    keep: tuple[str, ...]
    threads: int
    library: ctypes.CDLL

    @property
    def lanes(self) -> int:
        """The number of runs that share a register on this processor."""
        return ctypes.c_size_t.in_dll(self.library, "lanes_count").value

    def moved(self, columns: list[Array], state: list[Array], kept: list[Array], block_runs: int) -> list[Array]:
        """Return the last states of all runs; `kept` is filled."""
        runs, lanes = len(state[0]), self.lanes
        if 0 < runs < lanes:
            return self._widened(columns, state, kept, lanes)
        columns, state = list(map(_in_rows, columns)), list(map(np.ascontiguousarray, state))
        after, steps = [np.empty_like(array) for array in state], len(columns[0])
        strides = (ctypes.c_size_t * len(columns))(*(column.strides[0] for column in columns))
        before_, after_, columns_, kept_ = (_pointers(arrays) for arrays in (state, after, columns, kept))

        def take(block: tuple[int, int]) -> None:
            sizes = map(ctypes.c_size_t, (runs, *block, steps))
            self.library.run_lanes(before_, after_, columns_, strides, kept_, *sizes)

        with ThreadPoolExecutor(self.threads) as pool:
            list(pool.map(take, _blocks(runs, min(block_runs, -(-runs // self.threads)), lanes)))
        return after

    def _widened(self, columns: list[Array], state: list[Array], kept: list[Array], lanes: int) -> list[Array]:
        """Run fewer runs than there are lanes: the remaining lanes repeat the last run, and their results are dropped."""
        runs = len(state[0])
        places = np.minimum(np.arange(lanes), runs - 1)
        wide = [np.empty((len(array), lanes), array.dtype) for array in kept]
        after = self.moved([array[:, places] for array in columns], [array[places] for array in state], wide, lanes)
        for target, values in zip(kept, wide, strict=True):
            target[:] = values[:, :runs]
        return [array[:runs] for array in after]


def compile_lanes(
    system: TransitionSystem,
    keep: Sequence[str] = (),
    *,
    threads: int | None = None,
    folder: Path | None = None,
    cc: str | None = None,
) -> LanesBatch:
    """Generate, compile for this processor, and load.

    keep     as in `compile_batch`
    threads  the default is the number of cores
    folder   stores libraries for later use, each for its kind of processor; the default is a temporary folder
    cc       the C compiler; the default is $CC, cc, gcc or clang

    InputError as in `compile_batch`, and for threads below 1; EngineError if there is no compiler, or it fails.
    """
    if threads is not None and threads < 1:
        raise InputError(f"threads is {threads}; give at least 1.")
    soundly_64_bits(system)
    for name in keep:
        keepable(system, name)
    source = to_lanes(system, keep)
    library = _library(source, folder, compiler(cc))
    return LanesBatch(system, tuple(keep), threads or os.cpu_count() or 1, library)


def _library(source: str, folder: Path | None, cc: str) -> ctypes.CDLL:
    flags, processor = _native(cc)
    texts = {"lanes.c": f"/* For {processor}. */\n{source}"}
    if folder is not None:
        return _loaded(build(texts, folder, "lanes", cc=cc, flags=flags))
    with tempfile.TemporaryDirectory() as place:  # a loaded library does not need its file any more
        return _loaded(build(texts, Path(place), "lanes", cc=cc, flags=flags))


def _loaded(path: Path) -> ctypes.CDLL:
    library = ctypes.CDLL(str(path))
    library.run_lanes.restype = None
    return library


def _native(cc: str) -> tuple[tuple[str, ...], str]:
    """Return the flags for this processor, and a text that identifies it; the general ones if the compiler has no such flag."""
    command = [cc, _NATIVE, "-dM", "-E", "-x", "c", "-"]
    done = subprocess.run(command, input="", capture_output=True, text=True, check=False)
    if done.returncode != 0:
        return _FLAGS, "any processor"
    return (*_FLAGS, _NATIVE), f"processor {hashlib.sha256(done.stdout.encode()).hexdigest()[:16]}"


def _in_rows(column: Array) -> Array:
    """Return an array whose rows each lie in one piece; where all rows are one row, that row is in memory once."""
    if column.strides[0] == 0 and len(column) > 1:
        return np.broadcast_to(np.ascontiguousarray(column[0]), column.shape)
    return np.ascontiguousarray(column)


def _pointers(arrays: Sequence[Array]) -> ctypes.Array[Any]:
    return (ctypes.c_void_p * len(arrays))(*(array.ctypes.data for array in arrays))


def _blocks(runs: int, size: int, lanes: int) -> Iterator[tuple[int, int]]:
    """Yield begin and end of blocks of about `size` runs, none with fewer runs than lanes."""
    size = -(-size // lanes) * lanes
    begins = list(range(0, runs - lanes + 1, max(size, lanes)))
    yield from zip(begins, [*begins[1:], runs], strict=False)  # without runs there is no block
