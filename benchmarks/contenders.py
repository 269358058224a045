"""The same small odometer, written and run in many ways."""

from __future__ import annotations

import ctypes
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import safeloc.target
from benchmarks.by_hand import compiled_c, run_hand_written
from benchmarks.odometer import Last, Row, odometer, on_board, stream
from benchmarks.other_packages import run_bare_transitions, run_python_statemachine, run_sismic
from benchmarks.turns import Contender, Ready, Target
from safeloc.codegen.batch import compile_batch, simulate
from safeloc.codegen.c_loader import load_c
from safeloc.codegen.compiled import compile_system
from safeloc.language.interpret import start, step
from safeloc.language.system import lower
from safeloc.runtime.embedding import Controller, Program
from safeloc.runtime.embedding.snapshot import opened

UNIT = "hand-written class"
BATCH_RUNS = 16384
C_STEPS, C_RUNS = 200_000, 20

TARGETS = (
    Target("generated Python, tick", 1.0, UNIT),
    Target("generated Python, fused loop", 1.0, UNIT),
    Target("transitions, embedded", 0.8, "transitions, bare"),
    Target("generated C, fused loop", 0.8, "hand-written C, fused loop"),
    Target("numpy batch", 10.0, "generated Python, tick"),
    Target("numpy batch", 50e6, None),
)


def contenders(folder: Path) -> list[Contender]:
    """All of them; the C loop is compiled in `folder`, and left out where there is no C compiler."""
    compiler = shutil.which("cc")
    return [
        Contender("python-statemachine", 400, _plain(run_python_statemachine)),
        Contender("sismic", 800, _plain(run_sismic)),
        Contender("interpreter", 2_000, _plain(_interpreted)),
        Contender("transitions, embedded", 4_000, _embedded),
        Contender("transitions, bare", 4_000, _plain(run_bare_transitions)),
        Contender("generated Python, step", 50_000, _plain(_stepped())),
        Contender(UNIT, 50_000, _plain(run_hand_written)),
        Contender("generated Python, tick", 50_000, _plain(_ticked())),
        Contender("generated Python, fused loop", 50_000, _plain(_fused())),
        Contender("numpy batch", 200, _batch, BATCH_RUNS),
        *(_in_c(compiler, folder) if compiler else []),
    ]


def _in_c(compiler: str, folder: Path) -> list[Contender]:
    """By hand with and without the check of every row that generated code makes, and generated."""
    return [
        Contender("hand-written C, unchecked", C_STEPS, _by_hand(compiler, folder, border=False), C_RUNS),
        Contender("hand-written C, fused loop", C_STEPS, _by_hand(compiler, folder, border=True), C_RUNS),
        Contender("generated C, fused loop", C_STEPS, _generated_c(compiler, folder), C_RUNS),
    ]


def _plain(run: Callable[[list[Row]], Last]) -> Callable[[int], Ready]:
    """A contender that takes the rows as they are."""

    def prepare(steps: int) -> Ready:
        rows = stream(steps)
        return lambda: run(rows)

    return prepare


def _by_hand(compiler: str, folder: Path, *, border: bool) -> Callable[[int], Ready]:
    """A fused loop in C, written by hand."""
    return lambda steps: _again_and_again(compiled_c(compiler, folder, border=border)(stream(steps)))


def _again_and_again(run: Ready) -> Ready:
    """A run that is over too soon to be timed, many times."""
    return lambda: [run() for _ in range(C_RUNS)][-1]


def _generated_c(compiler: str, folder: Path) -> Callable[[int], Ready]:
    """The loop over columns of the generated C."""

    def prepare(steps: int) -> Ready:
        machine = load_c(on_board(), folder=folder, cc=compiler)
        columns, first = machine.columns(_arrays(stream(steps))), machine.save()

        def run() -> Last:
            machine.restore(first)
            machine.run_columns(columns)
            mode, position, margin = machine.state.values()
            return mode, position, margin

        return _again_and_again(run)

    return prepare


def _arrays(rows: list[Row]) -> list[ctypes.Array[Any]]:
    kinds = (ctypes.c_int64, ctypes.c_uint8, ctypes.c_int64)
    return [(kind * len(rows))(*column) for kind, column in zip(kinds, zip(*rows, strict=True), strict=True)]


def _interpreted(rows: list[Row]) -> Last:
    """The reference interpreter."""
    system = on_board()
    state = start(system)
    for row in rows:
        state, _ = step(system, state, dict(zip(system.inputs, row, strict=True)))
    mode, position, margin = state.values()
    return mode, position, margin


def _stepped() -> Callable[[list[Row]], Last]:
    """One function call a step, the state handed in and out."""
    code = compile_system(on_board())
    step, first = code.step, code.first()

    def run(rows: list[Row]) -> Last:
        state = first
        for row in rows:
            state, _ = step(state, row)
        mode, position, margin = state
        return mode, position, margin

    return run


def _ticked() -> Callable[[list[Row]], Last]:
    """One function call a step, the state kept inside: the like of the hand-written class."""
    code = compile_system(on_board())
    first = code.first()

    def run(rows: list[Row]) -> Last:
        tick, now = code.begin(first)
        for row in rows:
            tick(row)
        mode, position, margin = now()
        return mode, position, margin

    return run


def _fused() -> Callable[[list[Row]], Last]:
    """The loop over the stream inside the generated code."""
    code = compile_system(on_board())
    first = code.first()

    def run(rows: list[Row]) -> Last:
        mode, position, margin = code.run(rows, first)
        return mode, position, margin

    return run


class Host:
    """A host's own object."""


def _embedded(steps: int) -> Ready:
    """In a host whose object follows through `transitions`, the inputs judged in every step."""
    machine = odometer().machine
    program = Program(safeloc.target.Target(machine.name, (machine,), lower(machine), ()))
    records = [
        {"movement": movement, "reference": reference} if present else {"movement": movement}
        for movement, present, reference in stream(steps)
    ]

    def run() -> Last:
        controller = Controller(program, period_ms=100)
        controller.follow(Host())
        for record in records:
            controller.step_inputs(record)
        state = opened(controller.snapshot())["state"]
        mode, position, margin = (state[name] for name in program.code.state_names)
        return mode, position, margin

    return run


def _batch(steps: int) -> Ready:
    """Many runs at once, arrays checked at entry: each run is the stream, begun one step later than the run before."""
    rows = stream(steps + BATCH_RUNS)
    windows = np.lib.stride_tricks.sliding_window_view(np.array(rows), BATCH_RUNS, axis=0)[:steps]
    movement, present, reference = (np.ascontiguousarray(windows[:, column]) for column in range(3))
    inputs = {"movement": movement, "reference.present": present.astype(bool), "reference": reference}
    batch = compile_batch(on_board())

    def run() -> Last:
        last = simulate(batch, inputs).last
        mode, position, margin = (int(array[0]) for array in last.values())
        return mode, position, margin

    return run
