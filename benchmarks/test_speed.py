"""How fast the same small odometer runs, written in many ways, in one run on one machine.

Each contender must end in the interpreter's state. Speed is printed and never asserted: it depends on the machine.
"""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmarks.by_hand import compiled_c, run_hand_written
from benchmarks.odometer import Last, Row, expected, odometer, on_board, stream
from benchmarks.other_packages import run_bare_transitions, run_python_statemachine, run_sismic
from safeloc.backends.batch import compile_batch, simulate
from safeloc.backends.compiled import compile_system
from safeloc.backends.runtime import to_fsm

Measure = Callable[[str, int, Callable[[], Last]], Last]
BATCH_STEPS, BATCH_RUNS = 200, 16384


def compete(measure: Measure, name: str, steps: int, prepare: Callable[[list[Row]], Callable[[], Last]]) -> None:
    """Measure a contender on a stream of so many steps, and hold it to the interpreter."""
    rows = stream(steps)
    assert expected(rows) == measure(name, steps, prepare(rows))


def plain(run: Callable[[list[Row]], Last]) -> Callable[[list[Row]], Callable[[], Last]]:
    """A contender that needs no preparation."""
    return lambda rows: lambda: run(rows)


def test_hand_written_class(measure: Measure) -> None:
    """A slotted class, one method call a step: the unit."""
    compete(measure, "hand-written class", 50_000, plain(run_hand_written))


def test_generated_step(measure: Measure) -> None:
    """Generated Python, one function call a step, state handed in and out."""
    code = compile_system(on_board())
    step, first = code.step, code.first()

    def run(rows: list[Row]) -> Last:
        state = first
        for row in rows:
            state, _ = step(state, row)
        mode, position, margin = state
        return mode, position, margin

    compete(measure, "generated Python, step", 50_000, plain(run))


def test_generated_tick(measure: Measure) -> None:
    """Generated Python that keeps its state, one function call a step: the like of the hand-written class."""
    code = compile_system(on_board())
    first = code.first()

    def run(rows: list[Row]) -> Last:
        tick, now = code.begin(first)
        for movement, present, reference in rows:
            tick(movement, present, reference)
        mode, position, margin = now()
        return mode, position, margin

    compete(measure, "generated Python, tick", 50_000, plain(run))


def test_generated_loop(measure: Measure) -> None:
    """Generated Python, the fused loop over a stream."""
    code = compile_system(on_board())
    first = code.first()

    def run(rows: list[Row]) -> Last:
        mode, position, margin = code.run(rows, first)
        return mode, position, margin

    compete(measure, "generated Python, fused", 50_000, plain(run))


def test_bare_transitions(measure: Measure) -> None:
    """The `transitions` package as its documentation shows."""
    compete(measure, "transitions, bare", 4000, plain(run_bare_transitions))


class Host:
    """A host controller's own object."""

    tick: Any


def test_embedded_transitions(measure: Measure) -> None:
    """The machine embedded in a host through `transitions`, its inputs checked in every step."""
    machine = odometer().machine

    def prepare(rows: list[Row]) -> Callable[[], Last]:
        records = [
            {"movement": movement, "reference": reference} if present else {"movement": movement}
            for movement, present, reference in rows
        ]

        def run() -> Last:
            host = Host()
            embedded = to_fsm(machine, host)
            tick = host.tick
            for record in records:
                tick(**record)
            mode, position, margin = embedded.values.values()
            return mode, position, margin

        return run

    compete(measure, "transitions, embedded", 4000, prepare)


def test_python_statemachine(measure: Measure) -> None:
    """The python-statemachine package."""
    compete(measure, "python-statemachine", 400, plain(run_python_statemachine))


def test_sismic(measure: Measure) -> None:
    """The sismic package."""
    compete(measure, "sismic", 800, plain(run_sismic))


def test_c_loop(measure: Measure, tmp_path: Path) -> None:
    """A fused loop in C, written by hand."""
    compiler = shutil.which("cc")
    if compiler is None:
        pytest.skip("no C compiler (cc) on this machine")
    compete(measure, "hand-written C, fused", 200_000, compiled_c(compiler, tmp_path))


def test_numpy_batch(measure: Measure) -> None:
    """Many runs at once in numpy, arrays checked at entry."""
    rows = stream(BATCH_STEPS + BATCH_RUNS)
    windows = np.lib.stride_tricks.sliding_window_view(np.array(rows), BATCH_RUNS, axis=0)[:BATCH_STEPS]
    movement, present, reference = (np.ascontiguousarray(windows[:, column]) for column in range(3))
    inputs = {"movement": movement, "reference.present": present.astype(bool), "reference": reference}
    batch = compile_batch(on_board())

    def run() -> Last:
        last = simulate(batch, inputs).last
        mode, position, margin = (int(array[0]) for array in last.values())
        return mode, position, margin

    assert expected(rows[:BATCH_STEPS]) == measure("numpy batch", BATCH_STEPS * BATCH_RUNS, run)
