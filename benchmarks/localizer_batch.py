"""The whole localizer for many vehicles at once: python -m benchmarks.localizer_batch

Vehicle-steps a second with all checks, of numpy's batch and of the one in C (lanes), over recorded streams, each
vehicle at a place of its own in them, and over rows drawn at random. Two clocks: processor time, of all threads
together, and the clock on the wall, which says little where other programs run.
"""

from __future__ import annotations

import time
from collections.abc import Mapping

import numpy as np

from safeloc.codegen.batch import Prepared, compile_batch, simulate
from safeloc.codegen.batch_lanes import LanesBatch, compile_lanes
from safeloc.codegen.c99_vectors import Run
from safeloc.codegen.c_loader import load_c
from safeloc.codegen.numpy_code import Array
from safeloc.language.expr import BoolVar
from safeloc.language.interpret import read_inputs
from safeloc.language.system import TransitionSystem, without_ghosts
from safeloc.proof.drawn_runs.sampled import drawn_run, recorded_run
from safeloc.shipped_machines import ENTRIES

ROUNDS, TARGET = 5, 2e6
SIZES = ((1_000, 40), (10_000, 10), (100_000, 4))
"""Vehicles, and steps of each."""


def columns(system: TransitionSystem, run: Run) -> dict[str, Array]:
    """The inputs of a run, an array each."""
    rows = [read_inputs(system, step) for step in run.steps]
    return {
        var.name: np.array([row[var] for row in rows], dtype=np.bool_ if isinstance(var, BoolVar) else np.int64)
        for var in system.inputs
    }


def fleet(stream: Mapping[str, Array], vehicles: int, steps: int) -> dict[str, Array]:
    """Arrays [step, vehicle]: every vehicle drives the stream, each from another place in it."""
    length = len(next(iter(stream.values())))
    places = np.arange(steps)[:, None] + np.arange(vehicles) * 7 % (length - steps)
    return {name: values[places] for name, values in stream.items()}


def speeds(batch: Prepared, inputs: Mapping[str, Array]) -> tuple[float, float]:
    """Vehicle-steps a second of processor time and on the clock, each the best of all rounds."""
    steps, vehicles = next(iter(inputs.values())).shape
    best = (0.0, 0.0)
    for _ in range(ROUNDS):
        begin = time.process_time(), time.perf_counter()
        simulate(batch, inputs)
        taken = time.process_time() - begin[0], time.perf_counter() - begin[1]
        best = max(best[0], steps * vehicles / taken[0]), max(best[1], steps * vehicles / taken[1])
    return best


def by_rows(system: TransitionSystem, run: Run) -> float:
    """Steps a second of one vehicle in generated C, rows checked one by one; best of all rounds."""
    machine = load_c(system)
    rows, first, best = machine.rows([*run.steps] * 20), machine.save(), 0.0
    for _ in range(ROUNDS):
        machine.restore(first)
        begin = time.process_time()
        machine.run(rows)
        best = max(best, len(rows) / (time.process_time() - begin))
    return best


def contenders(system: TransitionSystem) -> dict[str, Prepared]:
    """By name."""
    many = compile_lanes(system)
    alone = LanesBatch(system, (), 1, many.library)
    return {
        "numpy": compile_batch(system),
        f"C, {alone.lanes} lanes, one thread": alone,
        f"C, {many.lanes} lanes, {many.threads} threads": many,
    }


def main() -> None:
    """Measures and prints."""
    target = ENTRIES["localizer"].make(ENTRIES["localizer"].config())
    system = without_ghosts(target.system)
    runs = [recorded_run(system, path, 400) for path in target.streams[:2]]
    runs.append(drawn_run(system, 0, 400, lawful=False))
    competing = contenders(system)
    print(f"{'':30} {'vehicles':>8} {'processor':>11} {'clock':>11}   steps/s; target {TARGET:,.0f}")
    for run in runs:
        print(f"{run.name}\n{'  C, rows of one vehicle':30} {1:8} {by_rows(system, run):11,.0f}", flush=True)
        for vehicles, steps in SIZES:
            inputs = fleet(columns(system, run), vehicles, steps)
            for name, batch in competing.items():
                processor, clock = speeds(batch, inputs)
                print(f"  {name:28} {vehicles:8} {processor:11,.0f} {clock:11,.0f}", flush=True)


if __name__ == "__main__":
    main()
