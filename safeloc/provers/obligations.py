"""What every machine owes, without anybody writing a property.

ranges       every state variable stays in its declared range, for ALL inputs in range
overflow     no intermediate term leaves 64 bits
division     every divisor is a positive constant
overlap      two transitions of one rank are never enabled together
absence      the value of an absent optional input is never read
reachable    every mode and every transition occurs in some run (witness kept), with the assumption and without
assumption   the environment's assumption can be kept, step after step (witness kept)
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial

from safeloc.provers.limits import Limits
from safeloc.provers.obligation import Obligation
from safeloc.provers.one_step import absence, division, overflow, overlap, ranges
from safeloc.provers.portfolio import GRACE_SECONDS, OnFinding, proved_base
from safeloc.provers.reachability import assumption_kept, reached
from safeloc.provers.recorded import Recording
from safeloc.provers.transfer import Packed, pack, unpack
from safeloc.provers.workers import Lost, Task, in_processes
from safeloc.results import Finding
from safeloc.system import TransitionSystem
from safeloc.verdict import Unknown

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
SEARCHES = 4  # how often a check may use up its time limit, one search after the other; and once more for each machine


def obligations(
    system: TransitionSystem,
    limits: Limits,
    *,
    jobs: int = 1,
    on_finding: OnFinding | None = None,
    recordings: Sequence[Recording] = (),
) -> list[Finding]:
    """All free obligations of a system, one Finding each; checks run in `jobs` processes that the clock ends.

    What `recordings` show to happen need not be found by search.
    """
    proved_base(system, limits)
    most = (SEARCHES + len(system.parts)) * limits.seconds + GRACE_SECONDS
    tasks = [
        Task(f"{system.name}: {name}", partial(_packed, check, system, limits), most)
        for name, check in _checks(recordings).items()
    ]
    found: dict[int, list[Finding]] = {}
    for number, packed, seconds in in_processes(tasks, jobs):
        found[number] = _findings(system, list(CHECKS)[number], packed, seconds)
        for finding in found[number]:
            if on_finding is not None:
                on_finding(finding)
    return [finding for number in range(len(tasks)) for finding in found[number]]


def _checks(recordings: Sequence[Recording]) -> dict[str, Check]:
    searches: dict[str, Check] = {
        "reachable": partial(reached, recordings=recordings),
        "assumption": partial(assumption_kept, recordings=recordings),
    }
    return {**CHECKS, **searches}


def _packed(check: Check, system: TransitionSystem, limits: Limits) -> list[Packed]:
    return [(one.name, one.statement, pack(one.verdict), one.method) for one in check(system, limits)]


def _findings(system: TransitionSystem, check: str, packed: list[Packed] | Lost, seconds: float) -> list[Finding]:
    if isinstance(packed, Lost):
        made = [Obligation(check, f"obligations of kind {check!r}", Unknown(packed.reason), "ended by the clock")]
    else:
        made = [Obligation(name, text, unpack(data, system, system), method) for name, text, data, method in packed]
    share = seconds / max(1, len(made))
    return [_finding(system, one, share) for one in made]


def _finding(system: TransitionSystem, one: Obligation, seconds: float) -> Finding:
    name = f"{system.name}/obligation/{one.name}"
    return Finding(name, system.name, "obligation", one.statement, one.verdict, one.method, seconds)
