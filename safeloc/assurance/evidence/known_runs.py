"""Search for a run that breaks a claim and begins like a known run.

A bounded search from the first states comes a few steps far in a large machine, and a breach often shows only after a whole train
has passed, or ten cycles after it began. Known runs come that far: the recordings and witnesses of the target, which obey the
unbroken world and so the broken one, and runs that break other claims.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

from safeloc.codegen.smt import Unrolling
from safeloc.errors import InputError, StreamError
from safeloc.language.expr import all_of, any_of
from safeloc.language.interpret import Values, start, taken
from safeloc.language.nodes import Value
from safeloc.language.spec import Goal, is_initially
from safeloc.language.system import environment
from safeloc.language.trace import Trace
from safeloc.proof.provers.asking import new_solver
from safeloc.proof.provers.deepening import Deepening
from safeloc.proof.provers.limits import Limits, deadline
from safeloc.proof.provers.recorded_witnesses import Recording
from safeloc.proof.provers.replayed_evidence import replayed
from safeloc.proof.verification.replay import run_with_truth
from safeloc.proof.verification.witness_files import read_witnesses
from safeloc.target import Target

_STATES = 24
"""Most states of one known run from which a search begins, spread over it; the last one is among them."""
_LONGEST = 600
"""Steps of a recording that are looked at."""


@dataclass(frozen=True)
class _Begin:
    """A state of a known run of a goal's system, and how the run came there."""

    state: Values
    first: Mapping[str, Value]
    inputs: tuple[Mapping[str, object], ...]


def known_runs(target: Target) -> list[Recording]:
    """Return the witnesses of the target, and its recordings that have the truth."""
    found = list(read_witnesses(target.witnesses).get(target.system.name, ()))
    for path in target.streams:
        try:
            run = run_with_truth(target, path)
        except StreamError:  # recorded with other figures
            continue
        if run is not None:
            found.append(Recording(run.initial, [step.inputs for step in run.steps[:_LONGEST]]))
    return found


def run_that_goes_on(goal: Goal, begun: Sequence[Recording], limits: Limits) -> Trace | None:
    """Return a run that begins like one of these and breaks the claim, with the fewest steps after that; None if none is found."""
    begins = [one for recording in begun for one in _begins(goal, recording)]
    if not begins:
        return None
    somewhere = any_of(all_of(is_initially(var, value) for var, value in one.state.items()) for one in begins)
    system = replace(goal.system, init=somewhere)
    runs, ends = Deepening(Unrolling(system), new_solver(limits.seed)), deadline(limits.seconds)
    while runs.depth < limits.depth and not ends.passed:
        model = runs.run(runs.fails(goal.good), ends)
        if model is not None:
            first = runs.first(model, system.state)
            begin = next(one for one in begins if all(first[var.name] == value for var, value in one.state.items()))
            return replayed(goal, begin.first, [*begin.inputs, *runs.stream(model)])
        if runs.stuck:
            return None
        runs.deeper()
    return None


def _begins(goal: Goal, recording: Recording) -> Iterator[_Begin]:
    """Yield states of the run as far as it is lawful, with the observers of the goal."""
    system, hidden = goal.system, {var.name for var in goal.observers}
    names = {var.name for var in system.inputs}
    try:
        first = {name: value for name, value in recording.first.items() if name not in hidden}
        state = start(system, first)
    except InputError:
        return
    rows = [{name: cell for name, cell in row.items() if name in names} for row in recording.steps]
    states = [state]
    with suppress(InputError):  # an input that the machine cannot take ends the run
        for _, after in taken(system, state, rows, while_=environment(system)):
            states.append(after)
    every = max(1, -(-len(states) // _STATES))
    for number in range(len(states) - 1, -1, -every):
        yield _Begin(states[number], first, tuple(rows[:number]))
