"""One search for runs that break what was not proved of a system: lemmas that were dropped, contracts that are not shown.

They are asked for together, length by length, in one solver: a machine with one wrong term loses many lemmas, and a search for
each took as many times the limit, in every composition that holds the machine.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from safeloc.language.spec import Goal
from safeloc.language.trace import Trace
from safeloc.language.verdict import Unknown, Verdict, Violated
from safeloc.proof.provers.from_known_runs import ENGINE, broken_onward
from safeloc.proof.provers.limits import Limits, deadline
from safeloc.proof.provers.recorded_witnesses import Recording
from safeloc.proof.provers.searches import Runs, sparing_runs

_LEAST_S = 0.001
"""Seconds of effort for a search before which the other one has used up the limit."""


@dataclass(frozen=True, eq=False)
class Dropped:
    """A fact that was not proved, as a goal; `why` is the reason, in words for the reader."""

    goal: Goal
    why: str


def broken(facts: Sequence[Dropped], limits: Limits, known_runs: Sequence[Recording] = ()) -> list[Verdict]:
    """Return Violated with a run for each fact that a run was found to break, else Unknown; `limits` are those of all together.

    A run a few steps from a known one is looked for first, in half of the time; then the shortest one of all.
    """
    if not facts:
        return []
    ends = deadline(limits.seconds)
    known = broken_onward([fact.goal for fact in facts], known_runs, replace(limits, seconds=limits.seconds / 2))
    left = [fact.goal for fact in facts if fact.goal not in known]
    runs = sparing_runs(left, replace(limits, seconds=max(ends.left, _LEAST_S))) if left else Runs({}, limits.depth)
    return [_verdict(fact, known, runs) for fact in facts]


def _verdict(fact: Dropped, known: Mapping[Goal, Trace], runs: Runs) -> Verdict:
    if fact.goal in known:
        return Violated(known[fact.goal], ENGINE)
    if fact.goal in runs.found:
        return Violated(runs.found[fact.goal], "bmc")
    searched = f"no run of up to {runs.depth} steps breaks it" if runs.depth >= 0 else "no run was searched in time"
    return Unknown(f"{fact.why}; {searched}", runs.depth)
