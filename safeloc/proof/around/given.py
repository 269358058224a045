"""The stream that a tube is drawn around, as it is recorded, with the truth where the recording has it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from safeloc.language.first_values import Any_
from safeloc.language.interpret import read_inputs
from safeloc.language.nodes import Value
from safeloc.language.system import TransitionSystem, without_ghosts
from safeloc.language.trace import Trace
from safeloc.proof.around.tube import Given
from safeloc.proof.drawn_runs.quick import quick_run
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
    names = {var.name for var in board.inputs}
    on_board = [{name: value for name, value in one.items() if name in names} for one in stream.steps]
    full = run_of(target.system, path, stream) if with_truth else None
    trace = run_of(board, path, stream) if full is None else quick_run(board, on_board, first=_open_first(board, full))
    rows = [read_inputs(board, one) for one in on_board]
    first = {var: trace.initial[var.name] for var in board.state}
    return Recorded(Given(rows, first, *_truth(target.system, full)), trace)


def _open_first(board: TransitionSystem, run: Trace) -> dict[str, Value]:
    """Return the first values of the machine's open variables in a run of the whole system."""
    return {var.name: run.initial[var.name] for var in board.state if isinstance(board.initial[var], Any_)}


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
