"""Runs for testing a back end: shipped recordings, simulated runs, and random runs.

A random run is lawful (the environment runs beside the machine, and the assumption holds) or has any inputs in range.
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from safeloc.codegen.c99_vectors import Run
from safeloc.language.expr import Var
from safeloc.language.interpret import start, step
from safeloc.language.nodes import Value
from safeloc.language.system import TransitionSystem, without_ghosts
from safeloc.language.trace import present_inputs
from safeloc.proof.drawn_runs.lawful import Repair, first_state
from safeloc.proof.drawn_runs.profiles import FAULTY, PLAUSIBLE, Profile
from safeloc.runtime.streams.gzipped import name_of
from safeloc.runtime.streams.steps import Cell, read_steps
from safeloc.simulated import first_values
from safeloc.target import Target

STRETCH = 12


def sampled_runs(target: Target, *, seed: int = 0, steps: int = 200) -> list[Run]:
    """Return runs of the system on board, up to `steps` steps each; the same for the same seed."""
    on_board = without_ghosts(target.system)
    runs = [recorded_run(on_board, path, steps) for path in target.streams]
    if target.simulate is not None:
        made = target.simulate(seed)
        runs.append(Run("simulated", _read(on_board, made[:steps]), _kept(on_board, first_values(made))))
    return [*runs, drawn_run(target.system, seed, steps, lawful=True), drawn_run(on_board, seed, steps, lawful=False)]


def recorded_run(on_board: TransitionSystem, path: Path, steps: int) -> Run:
    """Return a shipped stream as the system on board reads it, up to `steps` steps."""
    stream = read_steps(path)
    return Run(name_of(path), _read(on_board, stream.steps[:steps]), _kept(on_board, stream.first))


def drawn_run(system: TransitionSystem, seed: int, steps: int, *, lawful: bool) -> Run:
    """Return a drawn run of the system on board.

    A lawful run satisfies the assumption; it is shorter than `steps` if the search finds no lawful inputs for some
    steps.
    """
    draw = random.Random(seed)
    first = first_state(system, draw)
    on_board = without_ghosts(system)
    rows = _read(on_board, list(_drawn(system, first, draw, steps, lawful)))
    return Run("lawful" if lawful else "any inputs in range", rows, _kept(on_board, first))


def _drawn(
    system: TransitionSystem, first: Mapping[str, Value], draw: random.Random, steps: int, lawful: bool
) -> Iterator[Mapping[str, Value]]:
    state, repair, profile = start(system, first), Repair(system), Profile(system, "steady", draw)
    kinds = PLAUSIBLE if lawful else (*PLAUSIBLE, *FAULTY)
    for number in range(steps):
        if number % STRETCH == 0:
            profile = Profile(system, draw.choice(kinds), draw)
        inputs: dict[Var, Value] | None = profile.inputs(state)
        if lawful and inputs is not None:
            inputs = repair.mend(state, inputs, draw, profile.pick)
        if inputs is not None:
            state, _ = step(system, state, inputs)
            yield present_inputs(system, {var.name: value for var, value in inputs.items()})


def _kept(on_board: TransitionSystem, first: Mapping[str, Value]) -> dict[str, Value]:
    """Return the first values of the system on board, without those of ghosts."""
    kept = {var.name for var in on_board.state}
    return {name: value for name, value in first.items() if name in kept}


def _read(on_board: TransitionSystem, steps: Sequence[Mapping[str, Cell]]) -> list[Mapping[str, Cell]]:
    """Keep only the inputs that the machine reads in each step, without ghosts and remarks."""
    names = {var.name for var in on_board.inputs}
    return [{name: value for name, value in step.items() if name in names} for step in steps]
