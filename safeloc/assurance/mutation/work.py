"""Judges the mutants of a target, in several processes; what an earlier run judged of the same content is not judged again."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from safeloc.assurance.mutation.declared import Declared
from safeloc.assurance.mutation.judging import Bench, bench, judged
from safeloc.assurance.mutation.mutants import Mutant
from safeloc.assurance.mutation.results import SURVIVED, Judged, Outcome, from_data
from safeloc.proof.cache.engine import undisturbed
from safeloc.proof.cache.store import Store
from safeloc.proof.cache.targets import asked
from safeloc.proof.provers.limits import CLOCK, Limits
from safeloc.proof.provers.workers import Lost, Task, in_processes
from safeloc.target import Target

KIND = "mutants"
AT_ONCE = 6
"""Mutants that one process judges before the next one begins."""
QUESTIONS = 12
"""How often the limit may be used up for one mutant."""
OnJudged = Callable[[Judged], None]


@dataclass(frozen=True)
class Plan:
    """The effort for one target: limits of each question, the seed of drawn runs, and processes."""

    limits: Limits
    seed: int
    jobs: int


def judge_all(
    target: Target,
    declared: Declared,
    mutants: Sequence[Mutant],
    plan: Plan,
    *,
    on_judged: OnJudged,
    look_in: Store | None = None,
    keep_in: Store | None = None,
) -> list[Judged]:
    """Judge these mutants, in order; `on_judged` hears of each as it comes.

    look_in  where an earlier run kept what it judged; None looks at nothing
    keep_in  where each mutant is kept as soon as it is judged, so that an interrupted run goes on from there
    """
    key = asked(target, "mutants", plan.limits, plan.seed).key
    found = dict(_kept(look_in, key, mutants))
    for one in found.values():
        on_judged(one)
    left = [mutant for mutant in mutants if mutant.id not in found]
    if left:
        for one in _in_chunks(bench(target, declared, plan.limits, plan.seed), left, plan):
            found[one.id] = one
            if keep_in is not None and one.seconds and undisturbed():
                keep_in.put(KIND, _place(key, one.id), json.dumps(asdict(one)).encode())
            on_judged(one)
    return [found[mutant.id] for mutant in mutants]


def _kept(store: Store | None, key: str, mutants: Sequence[Mutant]) -> Iterator[tuple[str, Judged]]:
    for mutant in mutants if store is not None else ():
        entry = store.get(KIND, _place(key, mutant.id)) if store is not None else None
        if entry is not None:
            yield mutant.id, from_data(json.loads(entry.data))


def _place(key: str, mutant: str) -> str:
    return f"{key}-{mutant}"


def _in_chunks(on: Bench, mutants: Sequence[Mutant], plan: Plan) -> Iterator[Judged]:
    chunks = [mutants[number : number + AT_ONCE] for number in range(0, len(mutants), AT_ONCE)]
    seconds = CLOCK * QUESTIONS * AT_ONCE * plan.limits.seconds
    tasks = [Task(f"{on.whole.system.name}: mutants", _work(on, chunk), seconds) for chunk in chunks]
    for number, data, _ in in_processes(tasks, plan.jobs):
        if isinstance(data, Lost):
            yield from (_lost(mutant, data) for mutant in chunks[number])
        else:
            yield from map(from_data, data)


def _work(on: Bench, chunk: Sequence[Mutant]) -> Callable[[], list[Mapping[str, Any]]]:
    return lambda: [asdict(judged(on, mutant)) for mutant in chunk]


def _lost(mutant: Mutant, why: Lost) -> Judged:
    """What was not judged in time counts as survived, says so, and took no time that is told: it is not kept."""
    outcome = Outcome(SURVIVED, (), f"not judged: {why.reason}")
    plain = {name: getattr(mutant, name) for name in _TOLD}
    return Judged(**plain, everywhere=outcome, alone=outcome, seconds=0.0)


_TOLD = (
    "id", "machine", "kind", "words", "place", "source", "term", "becomes", "where", "shared_with", "requirements",
)  # fmt: skip
