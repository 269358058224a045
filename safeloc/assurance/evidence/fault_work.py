"""Breaking of every clause of a target's world alone, and of pairs of clauses that alone do no harm, in several processes."""

from __future__ import annotations

import hashlib
from collections.abc import Collection, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from itertools import combinations
from typing import Any, Protocol

from safeloc.assurance.evidence.core_work import cores_of
from safeloc.assurance.evidence.effects import CYCLES, Effect, End, Run, does_no_harm, effect
from safeloc.assurance.evidence.interval import claims_of, holds_truth
from safeloc.assurance.evidence.pairs_together import harmless_together
from safeloc.assurance.evidence.top_event import hazard_claims, top_claims
from safeloc.assurance.kept_work import Batch, Keeping, kept_or_done
from safeloc.language.expr import TRUE
from safeloc.proof.cache.store import Store
from safeloc.proof.cache.targets import asked
from safeloc.proof.cores.clauses import ClauseId, assumed_clauses
from safeloc.proof.cores.cores import Core
from safeloc.proof.provers.limits import CLOCK, Limits
from safeloc.proof.provers.workers import Lost, Task
from safeloc.target import Target

_KIND = "faults"
_TOGETHER = "faults together"
SECONDS_A_CLAIM = 10.0
"""Default limit of effort for each claim, in seconds of an idle computer."""


class _Progress(Protocol):
    """A display of progress."""

    def say(self, text: str, planned: int) -> None:
        """Begin a phase with the expected number of results."""

    def tick(self, line: str) -> None:
        """Count one result."""


@dataclass(frozen=True, eq=False)
class Breaking:
    """A job that breaks clauses: limits for each claim, processes, display of progress, and stores for results."""

    limits: Limits
    jobs: int
    progress: _Progress
    look_in: Store | None = None
    keep_in: Store | None = None

    def cores(self, target: Target) -> list[Core]:
        """Return the proof cores of the target's claims, including the claim that its interval contains the truth."""
        every = claims_of(target)
        self.progress.say(f"proof cores of {target.name}", len(every))
        return cores_of(
            target,
            every,
            self.limits,
            jobs=self.jobs,
            on_core=lambda one: self.progress.tick(f"{len(one.rests_on):3} elements  {one.claim}"),
            look_in=self.look_in,
            keep_in=self.keep_in,
        )

    def singles(self, target: Target, cores: Sequence[Core], clauses: Sequence[ClauseId] | None = None) -> list[Effect]:
        """Return the effect of each clause of the world broken alone, or of each of these. `cores`: the proof cores of the target."""
        wanted = [*assumed_clauses(target.system)] if clauses is None else clauses
        return self._effects(target, {(one,): _may_rest_on(target, cores, (one,)) for one in wanted})

    def pairs(self, target: Target, cores: Sequence[Core], singles: Sequence[Effect]) -> list[Effect]:
        """Return the effect on interval and hazard of each pair of clauses that alone do no harm to them.

        In a composition, only of pairs of clauses of different machines. Most pairs are proved together (`pairs_together`); of these
        no transition is told that withdraws the interval.
        """
        harmless = [one.broken[0] for one in singles if one.end in ("contained", "no hazard")]
        rests = [one for one in cores if one.claim in top_claims(target)]
        both = dict[tuple[ClauseId, ...], frozenset[str]]()
        for first, second in combinations(harmless, 2):
            if not target.system.parts or first.machine != second.machine:
                both[first, second] = _may_rest_on(target, rests, (first, second))
        safe = harmless_together(both, lambda sets: self._without_harm(target, rests, sets))
        left = {pair: names for pair, names in both.items() if pair not in safe}
        found = {one.broken: one for one in self._effects(target, left, top_only=True)}
        return [found[pair] if pair in found else _harmless(target, pair) for pair in both]

    def _without_harm(self, target: Target, cores: Sequence[Core], sets: Sequence[tuple[ClauseId, ...]]) -> list[bool]:
        """Return for each set of clauses whether no harm is proved without all of them."""
        self.progress.say(f"breaking sets of clauses of {target.name}", len(sets))
        key = asked(target, _TOGETHER, self.limits, target.hazard).key
        by_name = {_digest(one): one for one in sets}
        found = dict[str, bool]()

        def work(left: Sequence[str]) -> list[Batch]:
            return [Batch((name,), self._together(target, cores, by_name[name])) for name in left]

        keeping = Keeping(_TOGETHER, key, self.look_in, self.keep_in)
        for name, data in kept_or_done([*by_name], work, keeping, self.jobs):
            found[name] = data is True
            self.progress.tick(f"without {len(by_name[name])} clauses: {'no harm' if found[name] else 'not proved'}")
        return [found[_digest(one)] for one in sets]

    def _together(self, target: Target, cores: Sequence[Core], broken: tuple[ClauseId, ...]) -> Task:
        names = _may_rest_on(target, cores, broken)
        return Task(
            f"{target.name} without {len(broken)} clauses",
            lambda: [does_no_harm(target, broken, names, self.limits)],
            CLOCK * 2 * (len(names) + 2) * self.limits.seconds,
        )

    def _effects(
        self, target: Target, wanted: Mapping[tuple[ClauseId, ...], frozenset[str]], *, top_only: bool = False
    ) -> list[Effect]:
        self.progress.say(f"breaking clauses of {target.name}", len(wanted))
        key = asked(target, _KIND, self.limits, CYCLES, top_only, target.hazard).key
        judged = replace(target, properties=hazard_claims(target)) if top_only else target
        by_name = {"-".join(map(str, one)): one for one in wanted}
        found = dict[tuple[ClauseId, ...], Effect]()

        def work(left: Sequence[str]) -> list[Batch]:
            return [Batch((name,), self._task(judged, by_name[name], wanted[by_name[name]])) for name in left]

        for name, data in kept_or_done([*by_name], work, Keeping(_KIND, key, self.look_in, self.keep_in), self.jobs):
            one = by_name[name]
            found[one] = _undecided(target, one, wanted[one]) if isinstance(data, Lost) else from_data(data)
            self.progress.tick(f"without {' and '.join(map(str, one))}: {_told(found[one])}")
        return [found[one] for one in wanted]

    def _task(self, target: Target, broken: tuple[ClauseId, ...], names: frozenset[str]) -> Task:
        questions = 2 * (len(names) + len(CYCLES) + 2)
        return Task(
            f"{target.name} without {' and '.join(map(str, broken))}",
            lambda: [asdict(effect(target, broken, names, self.limits))],
            CLOCK * questions * self.limits.seconds,
        )


def _told(one: Effect) -> str:
    """Return the outcome of a breach in a few words; of a target without an interval and a hazard, how many claims are lost."""
    if one.end == "no interval":
        return f"{len(one.lost) or 'no'} claim{'s' if len(one.lost) != 1 else ''} lost"
    return _IN_SHORT[one.end]


_IN_SHORT: Mapping[End, str] = {
    "contained": "the interval stays right",
    "withdrawn": "a wrong interval is withdrawn in time",
    "wrong": "the interval can be wrong",
    "hazard": "the hazard can occur",
    "no hazard": "the hazard does not occur",
    "undecided": "undecided",
}


def _digest(clauses: Sequence[ClauseId]) -> str:
    return hashlib.sha256("\0".join(map(str, clauses)).encode()).hexdigest()[:20]


def _harmless(target: Target, pair: tuple[ClauseId, ...]) -> Effect:
    """Return the effect of a pair that was proved to do no harm."""
    return Effect(pair, tuple(prop.name for prop in hazard_claims(target)), end=_end_without_answer(target, ()))


def planned(target: Target, clauses: Sequence[ClauseId] | None = None) -> int:
    """Return the number of results of cores and single breaches of a target, or of breaches of these clauses."""
    return len(claims_of(target)) + len(assumed_clauses(target.system) if clauses is None else clauses)


def _may_rest_on(target: Target, cores: Sequence[Core], broken: Sequence[ClauseId]) -> frozenset[str]:
    """Return the claims whose proof may need one of the clauses; the others were proved without them.

    In a composition, lemmas and contracts are proved by its machines, from clauses that are not in the core.
    """
    gone = {(one.machine, one.name) for one in broken}
    contracts = {part.name for part in target.system.parts if part.contract is not TRUE}
    found = set[str]()
    for one in cores:
        clauses = {(element.machine, element.name) for element in one.rests_on if element.kind == "clause"}
        by_others = target.system.parts and (
            one.kept_by in contracts if one.kept_by else any(element.kind != "clause" for element in one.rests_on)
        )
        if one.why_none or by_others or not gone.isdisjoint(clauses):
            found.add(one.claim)
    return frozenset(found)


def _undecided(target: Target, broken: tuple[ClauseId, ...], names: frozenset[str]) -> Effect:
    kept = tuple(prop.name for prop in target.properties if prop.name not in names and prop.kind != "reachable")
    open_ = tuple(prop.name for prop in target.properties if prop.name in names)
    return Effect(broken, kept, {}, open_, _end_without_answer(target, names))


def _end_without_answer(target: Target, names: Collection[str]) -> End:
    """Return the end effect where no question about `names` was answered; everything else was proved before."""
    if not top_claims(target).isdisjoint(names):
        return "undecided"
    if holds_truth(target) is not None:
        return "contained"
    return "no interval" if target.hazard is None else "no hazard"


def from_data(data: Mapping[str, Any]) -> Effect:
    """Return an effect from its plain data (`asdict`)."""
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
