"""Bounded search for runs to many goals at once: one solver makes the runs longer step by step.

The interpreter replays the run found for a goal.
"""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass

import z3

from safeloc.codegen.smt import Unrolling
from safeloc.language.spec import Goal, Watch, watch
from safeloc.language.trace import Trace
from safeloc.proof.provers.asking import plain_solver
from safeloc.proof.provers.bmc import declared_state
from safeloc.proof.provers.deepening import Deepening
from safeloc.proof.provers.limits import Deadline, Limits, deadline
from safeloc.proof.provers.replayed_evidence import confirmed_together

TOGETHER, ALONE = 0.1, 0.1
"""Shares of the time left that a search spends on one question about all goals, and about one goal."""
TRIES = 3
"""Lengths at which a search asks for a goal in vain before it leaves the goal out."""
AT_FIRST = 0.1
"""Share of the limit for the first search: small machines need less; in large ones known runs are gone on from next, in compositions a machine alone."""


@dataclass(frozen=True, eq=False)
class Runs:
    """The shortest run to each target that was found, and the number of steps that were searched completely."""

    found: Mapping[Goal, Trace]
    depth: int


def first_runs(goals: Sequence[Goal], limits: Limits, known: Container[Goal] = ()) -> Runs:
    """Return the shortest runs to as many targets as the limits allow; all goals are of one system and one assumption.

    The search ends when a run to every goal is found, or is `known` to exist.
    """
    if not goals:
        return Runs({}, limits.depth)
    watched = watch(goals[0].plain, goals)
    runs, found = Deepening(Unrolling(watched.system), plain_solver(limits.seed)), dict[Goal, Trace]()
    ends = deadline(limits.seconds)
    while runs.depth < limits.depth:
        if not _search_length(watched, runs, found, ends):
            return Runs(found, runs.depth)
        if all(goal in found or goal in known for goal in goals):
            return Runs(found, runs.depth + 1)
        runs.deeper()
    return Runs(found, limits.depth)


def _search_length(watched: Watch, runs: Deepening, found: dict[Goal, Trace], ends: Deadline) -> bool:
    """Add the targets found at this length; return whether the length was searched completely."""
    while left := [goal for goal in watched.goals if goal not in found]:
        if ends.passed:
            return False
        model = runs.run(runs.fails(*(goal.good for goal in left)), ends)
        if model is None:
            return not runs.stuck
        found |= _reached(watched, runs, model, left)
    return True


def _reached(watched: Watch, runs: Deepening, model: z3.ModelRef, goals: Sequence[Goal]) -> dict[Goal, Trace]:
    """Return the goals that a run of the solver reaches, each with the run as the interpreter makes it."""
    first, stream = runs.first(model, declared_state(watched)), runs.stream(model)
    return confirmed_together(watched, [goal for goal in goals if runs.failed(model, goal.good)], first, stream, "bmc")


def sparing_runs(goals: Sequence[Goal], limits: Limits) -> Runs:
    """Do as `first_runs`, but leave out goals that are too hard, before they use up the time.

    A goal for which the solver gives up at some length is asked for alone from then on, since it keeps the solver from the
    others, and left out after TRIES lengths; lengths count as searched completely before that only.
    """
    search = _Search(watch(goals[0].plain, goals), limits)
    while search.length <= limits.depth and not search.ends.passed:
        search.this_length()
        if len(search.found) == len(goals):
            return Runs(search.found, search.length)
        if not search.left:
            break
        search.longer()
    return Runs(search.found, min(search.complete, limits.depth))


class _Search:
    """A search for runs that become longer step by step.

    left      the goals that are asked for: neither found nor left out
    hard      those for which the solver has given up at some length, with the number of these lengths
    complete  number of steps that were searched completely for all goals that were not found; -1 if none
    """

    def __init__(self, watched: Watch, limits: Limits) -> None:
        self._watched, self.ends = watched, deadline(limits.seconds)
        self._seed = limits.seed
        self._runs = Deepening(Unrolling(watched.system), plain_solver(self._seed))
        self.left, self.found = list(watched.goals), dict[Goal, Trace]()
        self.hard, self.complete = dict[Goal, int](), -1

    @property
    def length(self) -> int:
        """The number of steps of the runs that are searched now."""
        return self._runs.depth + 1

    def longer(self) -> None:
        """Go on to runs that are one step longer."""
        self._runs.deeper()

    def this_length(self) -> None:
        """Find the goals that runs of this length reach: asked for together, or where that is too hard one by one."""
        hard = list(self.hard)
        while easy := [goal for goal in self.left if goal not in hard]:
            if not self._note(self._runs.run(self._one_of(easy), self._share(TOGETHER))):
                break
        if easy and self._runs.stuck:
            self._one_by_one(easy)
        self._one_by_one([goal for goal in hard if goal in self.left])
        if not self.hard:
            self.complete = self.length

    def _one_by_one(self, goals: Sequence[Goal]) -> None:
        """Ask for each goal alone; leave out those for which the solver has given up TRIES times."""
        for goal in goals:
            if goal not in self.left:  # another goal's run reaches it
                continue
            solver = plain_solver(self._seed)
            if (
                not self._note(self._runs.run_anew(self._one_of([goal]), self._share(ALONE), solver))
                and self._runs.stuck
            ):
                self.hard[goal] = self.hard.get(goal, 0) + 1
                if self.hard[goal] == TRIES:
                    self.left.remove(goal)

    def _one_of(self, goals: Sequence[Goal]) -> z3.BoolRef:
        return self._runs.fails(*(goal.good for goal in goals))

    def _share(self, share: float) -> Deadline:
        return deadline(self.ends.left * share)

    def _note(self, model: z3.ModelRef | None) -> bool:
        """Note all goals that the run of a model reaches; return whether there is a run."""
        if model is None:
            return False
        self.found |= _reached(self._watched, self._runs, model, self.left)
        self.left = [goal for goal in self.left if goal not in self.found]
        return True
