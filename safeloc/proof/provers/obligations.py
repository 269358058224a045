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
from safeloc.proof.provers import antecedents
from safeloc.proof.provers.absence import absence
from safeloc.proof.provers.arithmetic import division, overflow, ranges
from safeloc.proof.provers.assumption import assumption_kept
from safeloc.proof.provers.limits import CLOCK, Limits
from safeloc.proof.provers.obligation import Obligation
from safeloc.proof.provers.overlap import overlap
from safeloc.proof.provers.portfolio import GRACE_SECONDS, OnFinding, proved_base
from safeloc.proof.provers.reachability import reached
from safeloc.proof.provers.recorded_witnesses import NO_WITNESSES, Recording, Witnesses
from safeloc.proof.provers.verdicts_as_data import Packed, pack, unpack
from safeloc.proof.provers.workers import Lost, Task, in_processes
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
    proved_base(system, limits)
    most = CLOCK * (SEARCHES + len(system.parts)) * limits.seconds + GRACE_SECONDS
    tasks = [
        Task(f"{system.name}: {name}", partial(_packed, check, system, limits), most)
        for name, check in _checks(recordings, witnesses).items()
    ]
    search = antecedents.search_task(system, properties, limits, recordings, witnesses)
    found: dict[int, list[Finding]] = {}
    if search is None:
        found[len(tasks)] = _occurring(system, properties, 0.0)
    tell = on_finding or (lambda _: None)
    for finding in (one for known in found.values() for one in known):
        tell(finding)
    for number, packed, seconds in in_processes([*tasks, *([] if search is None else [search])], jobs):
        if number == len(tasks):
            antecedents.remember(system, properties, limits, len(recordings), packed)
            found[number] = _occurring(system, properties, seconds)
        else:
            found[number] = _findings(system, list(CHECKS)[number], packed, seconds)
        for finding in found[number]:
            tell(finding)
    return [finding for number in sorted(found) for finding in found[number]]


def _occurring(system: TransitionSystem, properties: Sequence[Property], seconds: float) -> list[Finding]:
    return [_finding(system, one, seconds) for one in antecedents.found(system, properties).obligation()]


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
