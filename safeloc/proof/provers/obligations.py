"""Proof obligations of every machine, checked without any declared property.

ranges       every state variable stays in its declared range, for ALL inputs in range
overflow     no intermediate term leaves 64 bits
division     every divisor is a positive constant
overlap      two transitions of one rank are never enabled together in a reachable state
absence      the value of an absent optional input is never read, and no claim depends on it (if properties are given)
antecedents  every case of every property occurs (if properties are given)
reachable    every mode and every transition occurs in some run, under the assumption or without it; the run is the witness
assumption   the assumption can be satisfied (by a witness), for ever, and from every reachable state
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial

from safeloc.language.expr import TRUE
from safeloc.language.spec import Property
from safeloc.language.system import TransitionSystem, first_without_the_world
from safeloc.language.verdict import Proved, Unknown
from safeloc.proof.drawn_runs.quick import Again
from safeloc.proof.provers.absence import absence
from safeloc.proof.provers.absent_in_claims import absence_in_claims
from safeloc.proof.provers.arithmetic import division, overflow, ranges
from safeloc.proof.provers.assumption import assumption_kept
from safeloc.proof.provers.case_search import CaseSearch
from safeloc.proof.provers.limits import CLOCK, Limits
from safeloc.proof.provers.obligation import Obligation
from safeloc.proof.provers.overlap import overlap
from safeloc.proof.provers.portfolio import GRACE_SECONDS, OnFinding, with_base
from safeloc.proof.provers.proved_base import Base
from safeloc.proof.provers.reachability import beyond_known_runs, in_known_runs
from safeloc.proof.provers.recorded_witnesses import NO_WITNESSES, Recording, Witnesses
from safeloc.proof.provers.verdicts_as_data import Packed, pack, steps_of, unpack
from safeloc.proof.provers.workers import Lost, Queue, Task, Then
from safeloc.proof.results import Finding

Check = Callable[[TransitionSystem, Limits], Iterator[Obligation]]
CHECKS: dict[str, Check] = {
    "ranges": ranges,
    "overflow": overflow,
    "division": division,
    "overlap": overlap,
    "absence": absence,
}
"""The checks that are one task each, besides that of the assumption; modes and transitions take two, and the cases of properties have a
search of their own."""
REACHABLE, CLAIMS, ASSUMPTION, CASES = "reachable", "absence in claims", "assumption", "cases"
ORDER = ("ranges", "overflow", "division", "overlap", "absence", CLAIMS, REACHABLE, ASSUMPTION, CASES)
SEARCHES = 5  # searches of one check, each with the full time limit; and one more for each machine


def obligations(
    system: TransitionSystem,
    limits: Limits,
    *,
    jobs: int = 1,
    on_finding: OnFinding | None = None,
    recordings: Sequence[Recording] = (),
    witnesses: Witnesses = NO_WITNESSES,
    properties: Sequence[Property] = (),
) -> list[Finding]:
    """Return all free obligations of a system, one Finding each; checks run in `jobs` processes with time limits.

    Events that `recordings` or
    `witnesses` show need no search. The cases of `properties` have to occur.
    """
    queue, cases = Queue(jobs), CaseSearch(system, properties, limits, recordings, witnesses)
    obliging = Obliging(system, limits, cases, on_finding, recordings, witnesses)

    def begin(_known: Base, _seconds: float) -> None:
        obliging.begin_search(queue)
        obliging.begin_assumption(queue)
        obliging.begin_checks(queue)
        cases.begin_search(queue)

    with_base(queue, system, limits, begin)
    obliging.begin_known_runs(queue)
    cases.begin_known_runs(queue)
    queue.run()
    return obliging.findings


def assumption_obligations(
    system: TransitionSystem,
    limits: Limits,
    *,
    jobs: int = 1,
    on_finding: OnFinding | None = None,
    recordings: Sequence[Recording] = (),
) -> list[Finding]:
    """Return the obligations of the assumption alone: without them a proof under it may be empty."""
    queue = Queue(jobs)
    obliging = Obliging(
        system, limits, CaseSearch(system, (), limits, recordings, NO_WITNESSES), on_finding, recordings
    )

    def begin(_known: Base, _seconds: float) -> None:
        obliging.begin_assumption(queue)

    with_base(queue, system, limits, begin)
    queue.run()
    return obliging.findings


class Obliging:
    """The checks of a system's free obligations, as tasks of a queue.

    Modes and transitions are looked for in known runs first (`begin_known_runs`), which may begin before the base is proved; what
    is left is searched (`begin_search`).
    """

    def __init__(
        self,
        system: TransitionSystem,
        limits: Limits,
        cases: CaseSearch,
        on_finding: OnFinding | None = None,
        recordings: Sequence[Recording] = (),
        witnesses: Witnesses = NO_WITNESSES,
    ) -> None:
        self._system, self._limits, self._cases = system, limits, cases
        self._tell = on_finding or (lambda _: None)
        self._recordings, self._witnesses = recordings, witnesses
        self._found: dict[str, list[Finding]] = {}
        self._known_runs: list[Obligation] | None = None
        self._search_asked = False
        self._looked_for, self._waiting = False, list[Callable[[], None]]()
        cases.when_known(self._occurring)

    @property
    def findings(self) -> list[Finding]:
        """The findings so far, check by check, and then those about the cases of properties."""
        return [finding for name in ORDER for finding in self._found.get(name, ())]

    @property
    def reached(self) -> list[Finding]:
        """The findings about modes and transitions."""
        return list(self._found.get(REACHABLE, ()))

    def when_reached(self, then: Callable[[], None]) -> None:
        """Call `then` as soon as it is known which modes and transitions occur: now, if it is."""
        if self._looked_for:
            then()
        else:
            self._waiting.append(then)

    def _reached_known(self) -> None:
        self._looked_for = True
        for then in self._waiting:
            then()
        self._waiting.clear()

    def begin_assumption(self, queue: Queue) -> None:
        """Add the check of the assumption, which takes longest."""
        self._check(queue, ASSUMPTION, partial(assumption_kept, recordings=self._recordings))

    def begin_checks(self, queue: Queue) -> None:
        """Add every other check that is one task."""
        in_claims: Check = partial(absence_in_claims, self._cases.properties)
        for name, check in {**CHECKS, CLAIMS: in_claims}.items():
            self._check(queue, name, check)

    def _check(self, queue: Queue, name: str, check: Check) -> None:
        self._add(queue, name, partial(check, self._system, self._limits), partial(self._receive, name))

    def begin_known_runs(self, queue: Queue) -> None:
        """Add the look for modes and transitions in known runs; it needs no proved fact."""
        looked = partial(in_known_runs, self._system, self._limits, self._recordings, self._witnesses)
        self._add(queue, "known runs", looked, partial(self._receive_known_runs, queue))

    def begin_search(self, queue: Queue) -> None:
        """Add the search for the modes and transitions that no known run shows, as soon as these are known."""
        self._search_asked = True
        if self._known_runs is not None:
            self._search(queue, self._known_runs)

    def _add(
        self, queue: Queue, name: str, work: Callable[[], Iterator[Obligation]], then: Then, *, next_: bool = False
    ) -> None:
        most = CLOCK * (SEARCHES + len(self._system.parts)) * self._limits.seconds + GRACE_SECONDS
        queue.add(Task(f"{self._system.name}: {name}", partial(_packed, work), most), then, next_=next_)

    def _search(self, queue: Queue, known_runs: Sequence[Obligation]) -> None:
        if all(map(_is_shown, known_runs)):
            self._reached_known()
            return

        def others() -> Iterator[Obligation]:
            every = beyond_known_runs(self._system, self._limits, known_runs, self._witnesses)
            pairs = zip(every, known_runs, strict=True)
            return (replace(one, name=known.name) for one, known in pairs if not _is_shown(known))

        self._add(queue, REACHABLE, others, self._receive_others, next_=True)

    def _receive_known_runs(self, queue: Queue, packed: list[Packed] | Lost, seconds: float) -> None:
        made = list(_distinct(_unpacked(self._system, REACHABLE, packed)))
        if isinstance(packed, Lost):
            self._keep(REACHABLE, [_finding(self._system, one, seconds) for one in made])
            self._reached_known()
            return
        self._known_runs = made
        shown = [one for one in made if _is_shown(one)]
        self._keep(REACHABLE, [_finding(self._system, one, seconds / len(shown)) for one in shown])
        if self._search_asked:
            self._search(queue, made)

    def _receive_others(self, packed: list[Packed] | Lost, seconds: float) -> None:
        """Keep the findings of the search, each in its place among the modes and transitions."""
        others = _unpacked(self._system, REACHABLE, packed)
        found = [_finding(self._system, one, seconds / len(others)) for one in others]
        place = {_id(self._system, one): number for number, one in enumerate(self._known_runs or ())}
        shown = self._found[REACHABLE]
        self._found[REACHABLE] = sorted([*shown, *found], key=lambda one: place.get(one.id, len(place)))
        for finding in found:
            self._tell(finding)
        self._reached_known()

    def _receive(self, name: str, packed: list[Packed] | Lost, seconds: float) -> None:
        made = _unpacked(self._system, name, packed)
        share = seconds / max(1, len(made))
        self._keep(name, [_finding(self._system, one, share) for one in _distinct(made)])

    def _occurring(self, seconds: float) -> None:
        self._keep(CASES, [_finding(self._system, one, seconds) for one in self._cases.obligations()])

    def _keep(self, name: str, findings: list[Finding]) -> None:
        self._found[name] = findings
        for finding in findings:
            self._tell(finding)


def reaching(system: TransitionSystem, findings: Sequence[Finding]) -> list[Finding]:
    """Return those of the findings that are about modes and transitions."""
    of = (_about(system, "mode "), _about(system, "transition "))
    return [one for one in findings if one.id.startswith(of)]


def _is_shown(one: Obligation) -> bool:
    return isinstance(one.verdict, Proved)


def _packed(check: Callable[[], Iterator[Obligation]]) -> list[Packed]:
    return [(one.name, one.statement, pack(one.verdict), one.method) for one in check()]


def _unpacked(system: TransitionSystem, check: str, packed: list[Packed] | Lost) -> list[Obligation]:
    if isinstance(packed, Lost):
        return [Obligation(check, f"obligations of kind {check!r}", Unknown(packed.reason), "ended by the clock")]
    free, again = replace(system, assume=TRUE, init=first_without_the_world(system)), Again()
    # a run may have been found without the assumption
    longest_first = sorted(enumerate(packed), key=lambda one: -steps_of(one[1][2]))
    made = {number: unpack(data, free, free, again) for number, (_, _, data, _) in longest_first}
    return [Obligation(name, text, made[number], method) for number, (name, text, _, method) in enumerate(packed)]


def _distinct(made: Sequence[Obligation]) -> Iterator[Obligation]:
    """Give each obligation a unique name: a mode or row of one machine may read like one of another."""
    seen: Counter[str] = Counter()
    for one in made:
        seen[one.name] += 1
        yield one if seen[one.name] == 1 else replace(one, name=f"{one.name} ({seen[one.name]})")


def _finding(system: TransitionSystem, one: Obligation, seconds: float) -> Finding:
    return Finding(_id(system, one), system.name, "obligation", one.statement, one.verdict, one.method, seconds)


def _id(system: TransitionSystem, one: Obligation) -> str:
    return _about(system, one.name)


def _about(system: TransitionSystem, name: str) -> str:
    return f"{system.name}/obligation/{name}"
