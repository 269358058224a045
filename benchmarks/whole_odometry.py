"""The whole odometry machine of `models/odometry.py`, as the generated back ends run it: a simulated service."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from functools import cache

import numpy as np

from benchmarks.turns import Contender, Last, Ready, Target
from safeloc.backends.batch import compile_batch, simulate
from safeloc.backends.c_loader import load_c
from safeloc.backends.compiled import Compiled, Row, compile_system
from safeloc.interpret import run
from safeloc.models import odometry, odometry_streams
from safeloc.models.odometry_parts.variables import OdometryConfig
from safeloc.nodes import BoolVar, Value
from safeloc.system import TransitionSystem, lower, without_ghosts

UNIT = "generated Python, tick"
TARGETS = (Target("generated C, fused loop", 5e6, None),)
STEPS, BATCH_STEPS, BATCH_RUNS = 1_000, 20, 8_192
C_RUNS = 200
SEED = 20_250_101


@cache
def _system() -> TransitionSystem:
    return without_ghosts(lower(odometry.machine()))


@cache
def _code() -> Compiled:
    return compile_system(_system())


@cache
def _records() -> list[dict[str, Value]]:
    names = {var.name for var in _system().inputs}
    stream = odometry_streams.simulate(OdometryConfig(), seed=SEED, seconds=600)
    return [{name: value for name, value in record.items() if name in names} for record in stream]


def _rows(steps: int) -> list[Row]:
    return [_code().read(record) for record in _records()[:steps]]


@cache
def expected(steps: int) -> Last:
    """The state after the stream, as the interpreter has it."""
    return tuple(int(value) for value in run(_system(), _records()[:steps]).steps[-1].state.values())


def contenders() -> list[Contender]:
    """The generated back ends, and the interpreter."""
    return [
        Contender("interpreter", 100, _interpreted),
        Contender("generated Python, step", STEPS, _stepped),
        Contender(UNIT, STEPS, _ticked),
        Contender("generated Python, fused loop", STEPS, _fused),
        Contender("numpy batch", BATCH_STEPS, _batch, BATCH_RUNS),
        *([Contender("generated C, fused loop", STEPS, _in_c, C_RUNS)] if shutil.which("cc") else []),
    ]


def _plain(state: Sequence[Value]) -> Last:
    return tuple(map(int, state))


def _interpreted(steps: int) -> Ready:
    system, records = _system(), _records()[:steps]
    return lambda: _plain(list(run(system, records).steps[-1].state.values()))


def _stepped(steps: int) -> Ready:
    rows, step, first = _rows(steps), _code().step, _code().first()

    def run_all() -> Last:
        state = first
        for row in rows:
            state, _ = step(state, row)
        return _plain(state)

    return run_all


def _ticked(steps: int) -> Ready:
    rows, begin, first = _rows(steps), _code().begin, _code().first()

    def run_all() -> Last:
        tick, now = begin(first)
        for row in rows:
            tick(*row)
        return _plain(now())

    return run_all


def _fused(steps: int) -> Ready:
    rows, loop, first = _rows(steps), _code().run, _code().first()
    return lambda: _plain(loop(rows, first))


def _in_c(steps: int) -> Ready:
    """The loop over rows of the generated C, many times, since it is soon over."""
    machine = load_c(_system())
    rows, first = machine.rows(_records()[:steps]), machine.save()

    def run_all() -> Last:
        for _ in range(C_RUNS):
            machine.restore(first)
            machine.run(rows)
        return _plain(list(machine.state.values()))

    return run_all


def _batch(steps: int) -> Ready:
    """Every run is the stream, begun one step later than the run before, and over again from its end."""
    rows = np.array(_rows(len(_records())), dtype=np.int64)
    steps_of_runs = (np.arange(steps)[:, None] + np.arange(BATCH_RUNS)[None, :]) % len(rows)
    inputs = {
        var.name: rows[steps_of_runs, column].astype(np.bool_ if isinstance(var, BoolVar) else np.int64)
        for column, var in enumerate(_system().inputs)
    }
    batch = compile_batch(_system())
    return lambda: tuple(int(array[0]) for array in simulate(batch, inputs).last.values())
