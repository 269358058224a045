"""Whole shipped machines over a service, as the generated back ends run them: the odometry, and the localizer."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from benchmarks.turns import Contender, Last, Ready, Target
from safeloc.codegen.batch import compile_batch, simulate
from safeloc.codegen.c_loader import load_c
from safeloc.codegen.compiled import Compiled, Row, compile_system
from safeloc.language.interpret import run
from safeloc.language.nodes import BoolVar, Value
from safeloc.language.system import TransitionSystem, lower, without_ghosts
from safeloc.models import localizer, odometry
from safeloc.models.localizer.simulation import recorded_runs
from safeloc.models.odometry import simulate as odometry_streams
from safeloc.models.odometry.variables import OdometryConfig
from safeloc.runtime.streams.steps import read_steps

UNIT = "generated Python, tick"
BATCH_STEPS, BATCH_RUNS, C_RUNS = 20, 8_192, 200
INTERPRETED = 100
SEED = 20_250_101

Record = Mapping[str, Value]


@dataclass(frozen=True, eq=False)
class Service:
    """Steps with a first state, as far as that is open; what is of the environment only stands among them."""

    first: Record
    steps: Sequence[Mapping[str, object]]


@dataclass(eq=False)
class Whole:
    """A machine, `service` that it runs over, how many steps of it, and what speed is wanted."""

    title: str
    make: Callable[[], TransitionSystem]
    service: Callable[[], Service]
    steps: int
    targets: tuple[Target, ...]

    @cached_property
    def system(self) -> TransitionSystem:
        """As it runs on board."""
        return without_ghosts(self.make())

    @cached_property
    def code(self) -> Compiled:
        """In generated Python."""
        return compile_system(self.system)

    @cached_property
    def first(self) -> Record:
        """The first state's open values."""
        names = {var.name for var in self.system.state}
        return {name: value for name, value in self.service().first.items() if name in names}

    @cached_property
    def records(self) -> list[Record]:
        """The steps' inputs."""
        names = self.code.input_names
        taken = [{name: step[name] for name in names if name in step} for step in self.service().steps]
        return [dict(zip(names, self.code.read(step), strict=True)) for step in taken]

    def expected(self, steps: int) -> Last:
        """The state after the first steps, as the interpreter has it."""
        return _plain(list(run(self.system, self.records[:steps], first=self.first).steps[-1].state.values()))

    def contenders(self) -> list[Contender]:
        """The generated back ends, and the interpreter."""
        return [
            Contender("interpreter", INTERPRETED, self.expected_later),
            Contender("generated Python, step", self.steps, self._stepped),
            Contender(UNIT, self.steps, self._ticked),
            Contender("generated Python, fused loop", self.steps, self._fused),
            Contender("numpy batch", BATCH_STEPS, self._batch, BATCH_RUNS),
            *([Contender("generated C, fused loop", self.steps, self._in_c, C_RUNS)] if shutil.which("cc") else []),
        ]

    def expected_later(self, steps: int) -> Ready:
        """The interpreter as a contender."""
        return lambda: self.expected(steps)

    def _rows(self, steps: int) -> list[Row]:
        return [self.code.read(record) for record in self.records[:steps]]

    def _stepped(self, steps: int) -> Ready:
        rows, step, first = self._rows(steps), self.code.step, self.code.first(self.first)

        def run_all() -> Last:
            state = first
            for row in rows:
                state, _ = step(state, row)
            return _plain(state)

        return run_all

    def _ticked(self, steps: int) -> Ready:
        rows, begin, first = self._rows(steps), self.code.begin, self.code.first(self.first)

        def run_all() -> Last:
            tick, now = begin(first)
            for row in rows:
                tick(row)
            return _plain(now())

        return run_all

    def _fused(self, steps: int) -> Ready:
        rows, loop, first = self._rows(steps), self.code.run, self.code.first(self.first)
        return lambda: _plain(loop(rows, first))

    def _in_c(self, steps: int) -> Ready:
        """The loop over rows of the generated C, many times, since it is soon over."""
        machine = load_c(self.system, first=self.first)
        rows, first = machine.rows(self.records[:steps]), machine.save()

        def run_all() -> Last:
            for _ in range(C_RUNS):
                machine.restore(first)
                machine.run(rows)
            return _plain(list(machine.state.values()))

        return run_all

    def _batch(self, steps: int) -> Ready:
        """Every run is the service, begun one step later than the run before, and over again from its end."""
        rows = np.array(self._rows(len(self.records)), dtype=np.int64)
        steps_of_runs = (np.arange(steps)[:, None] + np.arange(BATCH_RUNS)[None, :]) % len(rows)
        inputs = {
            var.name: rows[steps_of_runs, column].astype(np.bool_ if isinstance(var, BoolVar) else np.int64)
            for column, var in enumerate(self.system.inputs)
        }
        batch = compile_batch(self.system)
        return lambda: tuple(int(array[0]) for array in simulate(batch, inputs, start_state=self.first).last.values())


def _plain(state: Sequence[Value]) -> Last:
    return tuple(map(int, state))


def _odometry_service() -> Service:
    return Service({}, odometry_streams.simulate(OdometryConfig(), seed=SEED, seconds=600))


def _localizer_service() -> Service:
    """Out of a hall, under satellites and into a tunnel."""
    recorded = read_steps(recorded_runs.FOLDER / "localizer-main-line.jsonl.gz")
    return Service(recorded.first, recorded.steps)


ODOMETRY = Whole(
    "Odometry with two devices, 46 state variables",
    lambda: lower(odometry.machine()),
    _odometry_service,
    1_000,
    (Target("generated C, fused loop", 5e6, None),),
)
LOCALIZER = Whole(
    "Localizer with five sources",
    lambda: localizer.compose_machines().composition.system,
    _localizer_service,
    320,
    (Target(UNIT, 1e5, None), Target("generated C, fused loop", 5e6, None)),
)
WHOLE = (ODOMETRY, LOCALIZER)
