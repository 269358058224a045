"""The stream that a tube is drawn around, as it is recorded, with the truth where the recording has it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from safeloc.language.interpret import read_inputs
from safeloc.language.system import TransitionSystem, without_ghosts
from safeloc.language.trace import Trace
from safeloc.proof.around.tube import Given
from safeloc.proof.verification.replay import has_truth, run_of
from safeloc.runtime.streams.steps import StepStream
from safeloc.target import Target


@dataclass(frozen=True, eq=False)
class Recorded:
    """A stream with its run on board."""

    given: Given
    trace: Trace


def recorded(target: Target, path: Path, stream: StepStream) -> Recorded:
    """Return a stream of a target, and its run. StreamError, with file and line, for a step that the machine cannot take."""
    board = without_ghosts(target.system)
    with_truth = has_truth(target, stream)
    trace = run_of(board, path, stream)
    full = run_of(target.system, path, stream) if with_truth else None
    names = {var.name for var in board.inputs}
    rows = [read_inputs(board, {k: v for k, v in one.items() if k in names}) for one in stream.steps]
    first = {var: trace.initial[var.name] for var in board.state}
    return Recorded(Given(rows, first, *_truth(target.system, full)), trace)


def _truth(system: TransitionSystem, run: Trace | None) -> tuple[list[dict], list[dict]]:  # type: ignore[type-arg] # of Row
    """Return the choices of each cycle, and the ghosts after each, the first state at 0."""
    if run is None:
        return [], []
    choices = [var for var in system.inputs if var in system.ghosts]
    ghosts = [var for var in system.state if var in system.ghosts]
    states = [run.initial, *(one.state for one in run.steps)]
    return (
        [{var: one.inputs[var.name] for var in choices} for one in run.steps],
        [{var: state[var.name] for var in ghosts} for state in states],
    )
