"""Exact search for a few steps from the states in which a recorded run reaches something new.

Some cases are too deep for a search from the first state, and no recording shows them, though one comes near: a fault in
a mode that takes minutes to reach, for example. A search of one or two steps from a known state is cheap.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import z3

from safeloc.codegen.smt import Unrolling
from safeloc.language.nodes import Value
from safeloc.language.spec import Goal
from safeloc.language.system import TransitionSystem
from safeloc.language.trace import Trace
from safeloc.proof.provers.asking import new_solver
from safeloc.proof.provers.deepening import Deepening
from safeloc.proof.provers.limits import Deadline, deadline
from safeloc.proof.provers.recorded_witnesses import Recording, Replay, is_label, known_first
from safeloc.proof.provers.replayed_evidence import confirmed

FURTHER = 3
_MOST_STARTS = 80
SECONDS_EACH = 2.0


@dataclass(frozen=True)
class _Start:
    """The state after a number of steps of a recording."""

    recording: Recording
    steps: int
    state: Sequence[Value]


def onward(
    system: TransitionSystem,
    goals: Mapping[int, Goal],
    recordings: Sequence[Recording],
    ends: Deadline,
    further: int = FURTHER,
    each_s: float = SECONDS_EACH,
) -> dict[int, Trace]:
    """Return runs that follow a recording and reach a goal a few steps later, by number of the goal.

    All goals rely on the same assumption.

    further  the greatest number of these steps
    each_s   seconds of effort for the search from one state
    """
    found: dict[int, Trace] = {}
    if not goals or not recordings:
        return found
    replay = Replay(system, goals)
    relied = next(iter(goals.values())).system.assume
    unrolling = Unrolling(replace(replay.watched, assume=relied))
    for start in _starts(replay, recordings, ends):
        left = {number: goal for number, goal in goals.items() if number not in found}
        if ends.passed or not left:
            break
        begins = zip(replay.watched.state, start.state, strict=True)
        suffix = _suffix(
            unrolling,
            [unrolling.at(var, 0) == value for var, value in begins],
            left,
            deadline(min(each_s, ends.left)),
            further,
        )
        if suffix is not None:
            names = {var.name for var in system.inputs}
            recorded: list[Mapping[str, object]] = [
                {k: v for k, v in one.items() if k in names} for one in start.recording.steps[: start.steps]
            ]
            for number in suffix.reached:
                first, stream = known_first(system, start.recording), [*recorded, *suffix.stream]
                found[number] = confirmed(left[number], first, stream, "bmc")
    return found


def _starts(replay: Replay, recordings: Sequence[Recording], ends: Deadline) -> list[_Start]:
    """Return the states of the recordings that have a new combination of modes and flags, the latest first."""
    width = len(replay.system.state)
    labels = [place for place, var in enumerate(replay.watched.state[:width]) if is_label(var)]
    seen: dict[tuple[Value, ...], _Start] = {}
    for recording in recordings:
        for steps, (state, kept) in enumerate(replay.states(recording)):
            if ends.passed or not all(kept):
                break
            seen.setdefault(tuple(state[place] for place in labels), _Start(recording, steps, state))
    return list(reversed(seen.values()))[:_MOST_STARTS]


@dataclass(frozen=True)
class _Suffix:
    """The steps that a solver found, and the goals that they reach."""

    reached: list[int]
    stream: list[dict[str, Value]]


def _suffix(
    unrolling: Unrolling, begins: Sequence[z3.BoolRef | bool], goals: Mapping[int, Goal], ends: Deadline, further: int
) -> _Suffix | None:
    """Search for the fewest steps from a state to one of the goals; None if there are none within the limits."""
    runs = Deepening(unrolling, new_solver(), begins)
    while runs.depth + 1 < further:
        runs.deeper()
        model = runs.run(runs.fails(*(goal.good for goal in goals.values())), ends)
        if model is not None:
            reached = [number for number, goal in goals.items() if runs.failed(model, goal.good)]
            return _Suffix(reached, runs.stream(model))
        if runs.stuck:
            return None
    return None
