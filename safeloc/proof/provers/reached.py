"""A claim that something can happen: a run that shows it, or a proof that there is none."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from safeloc.language.spec import Goal
from safeloc.language.trace import Trace
from safeloc.language.verdict import Proved, Unknown, Vacuous, Verdict, Violated
from safeloc.proof.provers.beyond_depth import deeper
from safeloc.proof.provers.bmc import Exhausted, search
from safeloc.proof.provers.kinduction import kinduction
from safeloc.proof.provers.limits import Limits, deadline
from safeloc.proof.provers.recheck import rechecked_in_words
from safeloc.proof.provers.recorded_witnesses import Recording, shown


def reached(goal: Goal, limits: Limits, recordings: Sequence[Recording] = ()) -> Verdict:
    """Return a witness, or a proof that there is none: of a short run, then of a recorded one, then of longer ones.

    In a composition a recorded run comes first: to search a short one takes longer than all its recordings. What is left of the time
    goes into longer runs than the depth limit.
    """
    ends = deadline(limits.seconds)
    if goal.system.parts and (known := _recorded(goal, recordings)) is not None:
        return known
    found = search(goal, replace(limits, seconds=limits.seconds / 2))
    if not isinstance(found, Exhausted):
        return _witnessed(found)
    if (known := _recorded(goal, recordings)) is not None:
        return known
    never = kinduction(goal, replace(limits, seconds=limits.seconds / 2))
    if isinstance(never, Proved):
        how = rechecked_in_words(never.engine, never.rechecked)
        return Violated(None, how, f"no run reaches it: proved by {never.engine}")
    if isinstance(never, Vacuous):
        return never
    if found.depth == limits.depth and ends.left > 0:
        found = search(goal, deeper(limits, ends.left))
    if not isinstance(found, Exhausted):
        return _witnessed(found)
    return Unknown(f"not reached, and not shown to be unreachable: {found.reason}; try more --seconds", found.depth)


def _recorded(goal: Goal, recordings: Sequence[Recording]) -> Proved | None:
    runs = shown([goal], recordings)
    return replace(_witnessed(runs[goal]), engine="recorded") if goal in runs else None


def _witnessed(run: Trace) -> Proved:
    return Proved(None, "bmc", len(run.steps), ("interpreter",), witness=run)
