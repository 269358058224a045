"""Runs that are longer than the depth limit: to an event, or to a violation of what no engine decides."""

from __future__ import annotations

from dataclasses import replace

from safeloc.language.spec import Goal
from safeloc.language.verdict import Verdict
from safeloc.proof.provers.bmc import bmc
from safeloc.proof.provers.limits import Limits

DEEPEST = 1_000
"""Steps of the longest runs that are searched while there is time."""
LONGER_SHARE, CLAIMED_SHARE = 0.2, 0.8
"""Shares of the time that is left for a violation beyond the depth limit; more where Spacer claims that there is one."""


def deeper(limits: Limits, seconds: float) -> Limits:
    """Return limits for runs that are longer than the depth limit."""
    return replace(limits, depth=max(limits.depth, DEEPEST), seconds=max(0.001, seconds))


def longer(goal: Goal, limits: Limits, left: float, *, claimed: bool) -> Verdict:
    """Search a violation by longer runs, in a share of the seconds that are left; `claimed`: Spacer is sure that there is one."""
    return bmc(goal, deeper(limits, left * (CLAIMED_SHARE if claimed else LONGER_SHARE)))
