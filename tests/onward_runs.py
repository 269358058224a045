"""Search for runs of a composition to modes and transitions that only one of its machines alone shows.

A solver gets lost in the first states of a composition, where everything is open. From a known state of a lawful run it needs a few
steps and a fraction of a second: so each state of the recordings and of the runs found meanwhile that combines modes and flags anew
is a start, the earliest first.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from heapq import heapify, heappop, heappush
from itertools import count

from safeloc.codegen.smt import Unrolling
from safeloc.language.nodes import Value
from safeloc.language.spec import Goal
from safeloc.language.trace import Trace
from safeloc.proof.provers.asking import new_solver
from safeloc.proof.provers.deepening import Deepening
from safeloc.proof.provers.limits import deadline
from safeloc.proof.provers.reachable_targets import targets_of
from safeloc.proof.provers.recorded_witnesses import Recording, Replay, is_label, known_first, shown
from safeloc.proof.provers.replayed_evidence import confirmed
from safeloc.target import Target

FURTHER = 5
"""Most steps of a run beyond its start."""
SECONDS_EACH = 6.0
"""Most effort of the solver for one question."""
Tell = Callable[[str], None]


def onward_runs(target: Target, known: Sequence[Recording], minutes: float, tell: Tell = lambda _: None) -> list[Trace]:
    """Return lawful runs of the whole to events that `known` does not show, found within the minutes, or from the first start; none for a single
    machine.

    known  the recordings and the shipped runs of the whole
    tell   is called with a line for each event found
    """
    targets = targets_of(target.system) if target.system.parts else []
    goals = [one.goal for one in targets]
    reached = shown(goals, known)
    left = {number: goal for number, goal in enumerate(goals) if goal not in reached}
    if not left or not known:
        return []
    search, ends = _Search(target, left, known), time.monotonic() + 60 * minutes
    found = list[Trace]()
    while search.left and search.starts:
        for numbers, run in search.next_start():
            found.append(run)
            tell(f"{target.name}: {', '.join(targets[number].name for number in numbers)} in {len(run.steps)} steps")
        if time.monotonic() >= ends:
            break
    return found


@dataclass(frozen=True)
class _Start:
    """The state after a number of steps of a run."""

    run: Recording
    steps: int
    state: Sequence[Value]


class _Search:
    """The goals that are left, by number, and the starts that were not searched from yet, the earliest first."""

    def __init__(self, target: Target, goals: Mapping[int, Goal], known: Sequence[Recording]) -> None:
        self.left = dict(goals)
        self._system, self._replay = target.system, Replay(target.system, goals)
        self._unrolling = Unrolling(replace(self._replay.watched, assume=next(iter(goals.values())).system.assume))
        of_system = self._replay.watched.state[: len(target.system.state)]
        self._labels = [place for place, var in enumerate(of_system) if is_label(var)]
        self._seen, self._number = set[tuple[Value, ...]](), count()
        self.starts = [(one.steps, next(self._number), one) for run in known for one in self._new_starts(run)]
        heapify(self.starts)

    def _new_starts(self, run: Recording) -> Iterator[_Start]:
        for steps, (state, kept) in enumerate(self._replay.states(run)):
            if not all(kept):
                return
            combination = tuple(state[place] for place in self._labels)
            if combination not in self._seen:
                self._seen.add(combination)
                yield _Start(run, steps, state)

    def next_start(self) -> Iterator[tuple[list[int], Trace]]:
        """Search from the next start; yield the runs found, each with the numbers of the goals that it reaches."""
        _, _, start = heappop(self.starts)
        names = {var.name for var in self._system.inputs}
        before = [{name: cell for name, cell in one.items() if name in names} for one in start.run.steps[: start.steps]]
        first = known_first(self._system, start.run)
        for reached, stream in self._from(start):
            steps: list[Mapping[str, object]] = [*before, *stream]
            run = confirmed(self.left[reached[0]], first, steps, "bmc")
            for number in reached:
                del self.left[number]
            for one in self._new_starts(Recording(first, steps)):
                heappush(self.starts, (one.steps, next(self._number), one))
            yield reached, run

    def _from(self, start: _Start) -> Iterator[tuple[list[int], list[dict[str, Value]]]]:
        """Yield numbers of goals left and the inputs that lead to them from the state, the shortest first."""
        begins = zip(self._replay.watched.state, start.state, strict=True)
        runs = Deepening(self._unrolling, new_solver(), [self._unrolling.at(var, 0) == value for var, value in begins])
        while runs.depth + 1 < FURTHER and self.left and not runs.stuck:
            runs.deeper()
            while self.left:
                goods = [goal.good for goal in self.left.values()]
                model = runs.run(runs.fails(*goods), deadline(SECONDS_EACH))
                if model is None:
                    break
                yield [n for n, goal in self.left.items() if runs.failed(model, goal.good)], runs.stream(model)
