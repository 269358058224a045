"""Search by leaps: a few steps from the states of runs that are known, then from those of the runs that this finds.

From a known state a search of a few steps is little work, where one from the first state to the same place is too much.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from safeloc.language.spec import Goal
from safeloc.language.trace import Trace
from safeloc.proof.provers.limits import Limits, deadline
from safeloc.proof.provers.onward import SECONDS_EACH, onward
from safeloc.proof.provers.recorded_witnesses import Recording
from safeloc.proof.provers.searches import first_runs

_SHALLOW = 3
"""Steps after which a search without the assumption goes on from the runs found, as long as that finds new goals."""
_LEAPS = (3, 6)
"""Steps by which such a search goes on from a run: a few at first, more for what is left."""


def leaping(goals: Sequence[Goal], limits: Limits, runs: Sequence[Trace], modes: Sequence[Goal]) -> dict[Goal, Trace]:
    """Find runs of few steps to goals or modes, and go on from these and from `runs`: a mode is the way to the next one.

    From a known state any inputs are possible without the assumption, so a search of a few steps takes no time.
    """
    wanted = list(dict.fromkeys([*goals, *modes]))
    found = dict(first_runs(wanted, replace(limits, depth=min(_SHALLOW, limits.depth))).found)
    found |= farther(goals, [goal for goal in wanted if goal not in found], limits, [*runs, *found.values()])
    return {goal: run for goal, run in found.items() if goal in set(goals)}


def farther(
    goals: Sequence[Goal], wanted: Sequence[Goal], limits: Limits, runs: Sequence[Trace], each_s: float = SECONDS_EACH
) -> dict[Goal, Trace]:
    """Go on from runs to the wanted goals, and from what that finds, as long as some of `goals` are left."""
    found, left = dict[Goal, Trace](), set(goals).intersection(wanted)
    for further in _LEAPS:
        new = list(runs) + list(found.values())
        while new and not left <= found.keys():
            asked = dict(enumerate(goal for goal in wanted if goal not in found))
            known = [Recording(run.initial, run.stream()) for run in new]
            more = onward(goals[0].plain, asked, known, deadline(limits.seconds), further, each_s)
            found |= {asked[number]: run for number, run in more.items()}
            new = list(more.values())
    return found
