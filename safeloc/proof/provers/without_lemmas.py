"""Claims of a composition of which some lemmas are not proved: each is tried by induction, and what is left is searched together.

One wrong term of one machine loses lemmas, and with them the proofs of many claims of every composition that holds the machine. All engines in
turn took the whole limit for each claim: many minutes, while the machine's own report shows the run that breaks it in seconds.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from safeloc.language.expr import TRUE
from safeloc.language.spec import Goal, Property
from safeloc.language.system import TransitionSystem
from safeloc.language.verdict import Proved, Verdict
from safeloc.proof.provers.by_its_machine import by_its_machine
from safeloc.proof.provers.kinduction import kinduction
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.proved_base import base

_SHARE = 0.1
"""Share of a limit: for a proof by induction, since those that need no lost lemma are quick, and for the searches beside that for the lemmas."""


def searched_together(system: TransitionSystem, properties: Iterable[Property]) -> frozenset[Property]:
    """Return the claims that are decided in this way, if lemmas of the system are not proved: none of a machine by itself."""
    if not system.parts:
        return frozenset()
    return frozenset(one for one in properties if one.kind != "reachable" and one.further_assumption is TRUE)


def search_limits(system: TransitionSystem, limits: Limits) -> Limits:
    """Return the limits of the searches that a composition makes beside that for its lost lemmas: a share of them if it has lost some.

    What is lost is searched for within the whole limit; ranges, claims and dead ends mostly follow from it.
    """
    if not system.parts or not base(system, seconds=limits.seconds).refuted:
        return limits
    return replace(limits, seconds=limits.seconds * _SHARE, confirming=limits.recheck_seconds)


def by_induction(goal: Goal, limits: Limits) -> Verdict:
    """Return Proved, on the machine alone or on the composition; else Unknown, or Vacuous."""
    short = replace(limits, seconds=limits.seconds * _SHARE, confirming=limits.seconds)
    alone = by_its_machine(goal, short, lambda of_machine: kinduction(of_machine, short))
    return alone if isinstance(alone, Proved) else kinduction(goal, short)
