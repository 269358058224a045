"""Judge the mutants of a target in several processes; stored results of earlier runs with the same content are used again."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property, partial
from typing import Any

from safeloc.assurance.kept_work import Batch, Keeping, kept_or_done
from safeloc.assurance.mutation.declared import Declared
from safeloc.assurance.mutation.judge_claim_mutant import Against, of_claim
from safeloc.assurance.mutation.judge_machine_mutant import Bench, bench, judged, with_outcome
from safeloc.assurance.mutation.judge_world_mutant import of_world
from safeloc.assurance.mutation.mutants import Mutant
from safeloc.assurance.mutation.results import SURVIVED, Judged, Outcome, from_data
from safeloc.proof.cache.store import Store
from safeloc.proof.cache.targets import asked
from safeloc.proof.provers.limits import CLOCK, Limits
from safeloc.proof.provers.workers import Lost, Task
from safeloc.target import Target

_KIND = "mutants"
_AT_ONCE = 6
"""Number of mutants that one process judges."""
_QUESTIONS = 12
"""Solver questions per mutant that may use their full limit before its process is stopped."""
OnJudged = Callable[[Judged], None]


@dataclass(frozen=True)
class Plan:
    """The effort for one target: limits of each question, the seed of drawn runs, and processes."""

    limits: Limits
    seed: int
    jobs: int


@dataclass(frozen=True, eq=False)
class Judging:
    """A job that judges mutants of one target.

    on_judged  called with the result of each mutant as soon as it is judged
    look_in    store with results of earlier runs; None: none is used
    keep_in    store for each new result, so that the next run continues after an interruption
    searched   search for runs that show that rows fire
    """

    target: Target
    declared: Declared
    plan: Plan
    on_judged: OnJudged
    look_in: Store | None = None
    keep_in: Store | None = None
    searched: bool = True

    def of_machine(self, mutants: Sequence[Mutant]) -> list[Judged]:
        """Judge mutants of the machine, in order."""
        return self._all(mutants, judged)

    def of_world(self, mutants: Sequence[Mutant]) -> list[Judged]:
        """Judge mutants of clauses, in order."""
        return self._all(mutants, partial(_timed, of_world))

    def of_claims(self, mutants: Sequence[Mutant], against: Against) -> list[Judged]:
        """Judge mutants of claims, in order; `against` has the judged mutants of the machine that weaker claims have to detect."""
        results = [(one.id, one.everywhere.fate, one.everywhere.by) for _, one in against]
        return self._all(mutants, partial(_timed, partial(of_claim, against=against)), results)

    def _all(
        self, mutants: Sequence[Mutant], judge: Callable[[Bench, Mutant], Judged], *besides: object
    ) -> list[Judged]:
        key = asked(self.target, _KIND, self.plan.limits, self.plan.seed, self.searched, *besides).key
        by_id = {mutant.id: mutant for mutant in mutants}
        found = dict[str, Judged]()

        def work(left: Sequence[str]) -> list[Batch]:
            return _batches(self._bench, [by_id[one] for one in left], judge)

        for name, data in kept_or_done([*by_id], work, Keeping(_KIND, key, self.look_in, self.keep_in), self.plan.jobs):
            found[name] = lost(by_id[name], data) if isinstance(data, Lost) else from_data(data)
            self.on_judged(found[name])
        return [found[mutant.id] for mutant in mutants]

    @cached_property
    def _bench(self) -> Bench:
        """The bench, made only if a result is not stored."""
        return bench(self.target, self.declared, self.plan.limits, self.plan.seed, searched=self.searched)


def _timed(judge: Callable[[Bench, Mutant], tuple[Outcome, str]], on: Bench, mutant: Mutant) -> Judged:
    started = time.monotonic()
    found, direction = judge(on, mutant)
    return with_outcome(mutant, found, found, time.monotonic() - started, direction)


def _batches(on: Bench, mutants: Sequence[Mutant], judge: Callable[[Bench, Mutant], Judged]) -> list[Batch]:
    chunks = [mutants[number : number + _AT_ONCE] for number in range(0, len(mutants), _AT_ONCE)]
    seconds = CLOCK * _QUESTIONS * _AT_ONCE * on.limits.seconds
    name = f"{on.unchanged.system.name}: mutants"
    return [Batch(tuple(one.id for one in chunk), Task(name, _work(on, chunk, judge), seconds)) for chunk in chunks]


def _work(
    on: Bench, chunk: Sequence[Mutant], judge: Callable[[Bench, Mutant], Judged]
) -> Callable[[], list[Mapping[str, Any]]]:
    return lambda: [asdict(judge(on, mutant)) for mutant in chunk]


def lost(mutant: Mutant, why: Lost) -> Judged:
    """Return the result of a mutant whose process failed or took too long: it counts as survived."""
    outcome = Outcome(SURVIVED, (), f"not judged: {why.reason}")
    return with_outcome(mutant, outcome, outcome, 0.0)
