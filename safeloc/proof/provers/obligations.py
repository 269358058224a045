"""Proof obligations of every machine, checked without any declared property.

ranges       every state variable stays in its declared range, for ALL inputs in range
overflow     no intermediate term leaves 64 bits
division     every divisor is a positive constant
overlap      two transitions of one rank are never enabled together in a reachable state
absence      the value of an absent optional input is never read
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
from safeloc.language.verdict import Unknown
from safeloc.proof.provers.absence import absence
from safeloc.proof.provers.arithmetic import division, overflow, ranges
from safeloc.proof.provers.assumption import assumption_kept
from safeloc.proof.provers.case_search import CaseSearch
from safeloc.proof.provers.limits import CLOCK, Limits
from safeloc.proof.provers.obligation import Obligation
from safeloc.proof.provers.overlap import overlap
from safeloc.proof.provers.portfolio import GRACE_SECONDS, OnFinding, with_base
from safeloc.proof.provers.proved_base import Base
from safeloc.proof.provers.reachability import reached
from safeloc.proof.provers.recorded_witnesses import NO_WITNESSES, Recording, Witnesses
from safeloc.proof.provers.verdicts_as_data import Packed, pack, unpack
from safeloc.proof.provers.workers import Lost, Queue, Task
from safeloc.proof.results import Finding

Check = Callable[[TransitionSystem, Limits], Iterator[Obligation]]
CHECKS: dict[str, Check] = {
    "ranges": ranges,
    "overflow": overflow,
    "division": division,
    "overlap": overlap,
    "absence": absence,
    "reachable": reached,
    "assumption": assumption_kept,
}
CASES = "cases"
SEARCHES = 4  # searches of one check, each with the full time limit; and one more for each machine


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
        obliging.begin(queue)
        cases.begin(queue)

    with_base(queue, system, limits, begin)
    queue.run()
    return obliging.findings


class Obliging:
    """The checks of a system's free obligations, as tasks of a queue."""

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
        self._checks = _checks(recordings, witnesses)
        self._found: dict[str, list[Finding]] = {}
        cases.when_known(self._occurring)

    @property
    def findings(self) -> list[Finding]:
        """The findings so far, check by check, and then those about the cases of properties."""
        return [finding for name in (*CHECKS, CASES) for finding in self._found.get(name, ())]

    def begin(self, queue: Queue, checks: Sequence[str] = tuple(CHECKS)) -> None:
        """Add these checks, by name."""
        most = CLOCK * (SEARCHES + len(self._system.parts)) * self._limits.seconds + GRACE_SECONDS
        for name in checks:
            work = partial(_packed, self._checks[name], self._system, self._limits)
            queue.add(Task(f"{self._system.name}: {name}", work, most), partial(self._receive, name))

    def _receive(self, name: str, packed: list[Packed] | Lost, seconds: float) -> None:
        self._keep(name, _findings(self._system, name, packed, seconds))

    def _occurring(self, seconds: float) -> None:
        self._keep(CASES, [_finding(self._system, one, seconds) for one in self._cases.obligations()])

    def _keep(self, name: str, findings: list[Finding]) -> None:
        self._found[name] = findings
        for finding in findings:
            self._tell(finding)


def _checks(recordings: Sequence[Recording], witnesses: Witnesses) -> dict[str, Check]:
    searches: dict[str, Check] = {
        "reachable": partial(reached, recordings=recordings, witnesses=witnesses),
        "assumption": partial(assumption_kept, recordings=recordings),
    }
    return {**CHECKS, **searches}


def _packed(check: Check, system: TransitionSystem, limits: Limits) -> list[Packed]:
    return [(one.name, one.statement, pack(one.verdict), one.method) for one in check(system, limits)]


def _findings(system: TransitionSystem, check: str, packed: list[Packed] | Lost, seconds: float) -> list[Finding]:
    if isinstance(packed, Lost):
        made = [Obligation(check, f"obligations of kind {check!r}", Unknown(packed.reason), "ended by the clock")]
    else:
        ran = replace(
            system, assume=TRUE, init=first_without_the_world(system)
        )  # a run may have been found without the assumption
        made = [Obligation(name, text, unpack(data, ran, ran), method) for name, text, data, method in packed]
    share = seconds / max(1, len(made))
    return [_finding(system, one, share) for one in _distinct(made)]


def _distinct(made: Sequence[Obligation]) -> Iterator[Obligation]:
    """Give each obligation a unique name: a mode or row of one machine may read like one of another."""
    seen: Counter[str] = Counter()
    for one in made:
        seen[one.name] += 1
        yield one if seen[one.name] == 1 else replace(one, name=f"{one.name} ({seen[one.name]})")


def _finding(system: TransitionSystem, one: Obligation, seconds: float) -> Finding:
    name = f"{system.name}/obligation/{one.name}"
    return Finding(name, system.name, "obligation", one.statement, one.verdict, one.method, seconds)
