"""Decide if an event can occur in any run, after a query on a single step could not exclude it: a run, a proof, or
neither.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from safeloc.language.spec import Goal
from safeloc.language.verdict import Proved, Unknown, Verdict, Violated
from safeloc.proof.provers.implication import Failure
from safeloc.proof.provers.kinduction import kinduction
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.searches import first_runs
from safeloc.proof.provers.spacer import spacer


def never(goal: Goal, why: str | Failure, limits: Limits) -> Verdict:
    """Return Violated with a run that reaches the goal (of kind `reachable`), Proved if no run does, else Unknown.

    why  the reason why a single step did not exclude it; a failed question gives a state of its own, which a run that is found replaces
    """
    [verdict] = none_happens({goal: why}, limits).values()
    return verdict


def none_happens(goals: Mapping[Goal, str | Failure], limits: Limits) -> dict[Goal, Verdict]:
    """Return this verdict for several goals of one system and one assumption.

    Their runs are searched together, and those of which none is found share the limit of one: a wrong term of one machine can lose the ranges
    of many variables of a composition.
    """
    runs = first_runs(list(goals), limits)
    share = replace(limits, seconds=limits.seconds / max(1, len(goals) - len(runs.found)))
    return {
        goal: Violated(runs.found[goal], "bmc", why if isinstance(why, str) else "")
        if goal in runs.found
        else _excluded(goal, str(why), runs.depth, share)
        for goal, why in goals.items()
    }


def _excluded(goal: Goal, why: str, depth: int, limits: Limits) -> Verdict:
    for engine in (kinduction, spacer):
        verdict = engine(goal, replace(limits, seconds=limits.seconds / 2))
        if isinstance(verdict, Proved):
            return replace(verdict, invariant=None)  # it reads observers that only this goal has
    return Unknown(
        f"not shown for every state ({why}), and no run was found that reaches it; a lemma may be missing", depth
    )
