"""Breaks every clause of a target's world alone, and every pair that alone do no harm, in several processes."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from itertools import combinations
from typing import Any

from safeloc.assurance.evidence.core_work import cores_of
from safeloc.assurance.evidence.effects import CYCLES, Effect, End, Run, effect
from safeloc.assurance.evidence.interval import HOLDS, holds_truth
from safeloc.language.expr import TRUE
from safeloc.proof.cache.engine import undisturbed
from safeloc.proof.cache.store import Store
from safeloc.proof.cache.targets import asked
from safeloc.proof.cores.clauses import ClauseId, assumed_clauses
from safeloc.proof.cores.cores import Core
from safeloc.proof.provers.limits import CLOCK, Limits
from safeloc.proof.provers.workers import Lost, Task, in_processes
from safeloc.target import Target

KIND = "faults"


@dataclass(frozen=True, eq=False)
class Breaking:
    """How clauses are broken: limits for each claim, processes, and where results are kept.

    on_effect  hears of each effect as it comes, and how many there will be
    """

    limits: Limits
    jobs: int
    on_effect: Callable[[Effect, int], None]
    look_in: Store | None = None
    keep_in: Store | None = None

    def singles(self, target: Target) -> list[Effect]:
        """Return what becomes of the target when each clause of its world is broken alone."""
        rests = self._cores(target)
        clauses = assumed_clauses(target.system)
        return self._effects(target, {(one,): _may_rest_on(target, rests, (one,)) for one in clauses})

    def pairs(self, target: Target, singles: Sequence[Effect]) -> list[Effect]:
        """Return the same for every two clauses that do no harm to the interval alone, as far as the interval is concerned.

        Of a composition, for two clauses of different machines.
        """
        harmless = [one.broken[0] for one in singles if one.end == "contained"]
        rests = [one for one in self._cores(target) if one.claim == HOLDS]
        both = dict[tuple[ClauseId, ...], frozenset[str]]()
        for first, second in combinations(harmless, 2):
            if not target.system.parts or first.machine != second.machine:
                both[first, second] = _may_rest_on(target, rests, (first, second))
        return self._effects(target, both, interval_only=True)

    def _cores(self, target: Target) -> list[Core]:
        top = holds_truth(target)
        claims = [prop for prop in target.properties if prop.kind != "reachable"]
        every = [*claims, *([top] if top is not None else [])]
        return cores_of(
            target, every, self.limits, jobs=self.jobs, on_core=_heard, look_in=self.look_in, keep_in=self.keep_in
        )

    def _effects(
        self, target: Target, wanted: Mapping[tuple[ClauseId, ...], frozenset[str]], *, interval_only: bool = False
    ) -> list[Effect]:
        key = asked(target, KIND, self.limits, CYCLES, interval_only).key
        found = dict(self._kept(key, wanted))
        for known in found.values():
            self.on_effect(known, len(wanted))
        left = [one for one in wanted if one not in found]
        told = _only_interval(target) if interval_only else target
        tasks = [self._task(told, one, wanted[one]) for one in left]
        for number, data, _ in in_processes(tasks, self.jobs):
            one = left[number]
            found[one] = _undecided(target, one, wanted[one]) if isinstance(data, Lost) else from_data(data)
            if self.keep_in is not None and not isinstance(data, Lost) and undisturbed():
                self.keep_in.put(KIND, _place(key, one), json.dumps(data).encode())
            self.on_effect(found[one], len(wanted))
        return [found[one] for one in wanted]

    def _kept(
        self, key: str, wanted: Mapping[tuple[ClauseId, ...], frozenset[str]]
    ) -> Iterator[tuple[tuple[ClauseId, ...], Effect]]:
        for one in wanted if self.look_in is not None else ():
            entry = None if self.look_in is None else self.look_in.get(KIND, _place(key, one))
            if entry is not None:
                yield one, from_data(json.loads(entry.data))

    def _task(self, target: Target, broken: tuple[ClauseId, ...], names: frozenset[str]) -> Task:
        questions = 2 * (len(names) + len(CYCLES) + 2)
        return Task(
            f"{target.name} without {' and '.join(map(str, broken))}",
            lambda: asdict(effect(target, broken, names, self.limits)),
            CLOCK * questions * self.limits.seconds,
        )


def _heard(_: Core) -> None:
    """Progress tells of effects."""


def _only_interval(target: Target) -> Target:
    return replace(target, properties=())


def _may_rest_on(target: Target, cores: Sequence[Core], broken: Sequence[ClauseId]) -> frozenset[str]:
    """The claims whose proof may need one of the clauses. The others were proved without them.

    Of a composition, lemmas and contracts are proved by its machines, from clauses that the core does not tell.
    """
    gone = {(one.machine, one.name) for one in broken}
    owed = {part.name for part in target.system.parts if part.owed is not TRUE}
    found = set[str]()
    for one in cores:
        clauses = {(element.machine, element.name) for element in one.rests_on if element.kind == "clause"}
        by_others = target.system.parts and (
            one.kept_by in owed if one.kept_by else any(element.kind != "clause" for element in one.rests_on)
        )
        if one.why_none or by_others or not gone.isdisjoint(clauses):
            found.add(one.claim)
    return frozenset(found)


def _undecided(target: Target, broken: tuple[ClauseId, ...], names: frozenset[str]) -> Effect:
    kept = tuple(prop.name for prop in target.properties if prop.name not in names and prop.kind != "reachable")
    open_ = tuple(prop.name for prop in target.properties if prop.name in names)
    end: End = "undecided" if HOLDS in names else "contained"
    return Effect(broken, kept, {}, open_, "no interval" if holds_truth(target) is None else end)


def _place(key: str, broken: tuple[ClauseId, ...]) -> str:
    return f"{key}-{'-'.join(map(str, broken))}"


def from_data(data: Mapping[str, Any]) -> Effect:
    """Return an effect from what `asdict` made of it."""
    run = data["run"]
    return Effect(
        tuple(ClauseId(**one) for one in data["broken"]),
        tuple(data["kept"]),
        dict(data["lost"]),
        tuple(data["open_"]),
        data["end"],
        data["within_cycles"],
        None if run is None else Run(dict(run["first"]), tuple(map(dict, run["inputs"])), run["fired"]),
        tuple(data["withdrawn_by"]),
    )
