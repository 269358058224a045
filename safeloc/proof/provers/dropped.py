"""One search for runs that break what was not proved of a system: lemmas that were dropped, contracts that are not shown.

They are asked for together, length by length, in one solver: a machine with one wrong term loses many lemmas, and a search for
each took as many times the limit, in every composition that holds the machine.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from safeloc.language.spec import Goal
from safeloc.language.verdict import Unknown, Verdict, Violated
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.searches import sparing_runs


@dataclass(frozen=True, eq=False)
class Dropped:
    """A fact that was not proved, as a goal; `why` is the reason, in words for the reader."""

    goal: Goal
    why: str


def broken(facts: Sequence[Dropped], limits: Limits) -> list[Verdict]:
    """Return Violated with a shortest run for each fact that a run was found to break, else Unknown; `limits` are those of all together."""
    if not facts:
        return []
    runs = sparing_runs([fact.goal for fact in facts], limits)
    searched = f"no run of up to {runs.depth} steps breaks it" if runs.depth >= 0 else "no run was searched in time"
    return [
        Violated(runs.found[fact.goal], "bmc")
        if fact.goal in runs.found
        else Unknown(f"{fact.why}; {searched}", runs.depth)
        for fact in facts
    ]
