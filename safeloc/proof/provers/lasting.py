"""On-board invariants: they hold in the first state, and after each step from ANY state in which they hold."""

from __future__ import annotations

from collections.abc import Mapping

from safeloc.language.expr import Bool, NumVar
from safeloc.language.system import TransitionSystem
from safeloc.proof.provers.facts import range_of
from safeloc.proof.provers.proved_base import proved_always

SECONDS = 120.0
"""Limit for the system, and for each machine of a composition; the largest shipped system takes about a minute."""


def lasting(system: TransitionSystem, *, seconds: float = SECONDS) -> Mapping[str, Bool] | None:
    """Return the lemmas that are inductive together with the ranges of all state variables, for all inputs in range.

    None of them reads a ghost. Return None if some range is not proved, since no lemma helps then.
    """
    known = proved_always(system, seconds=seconds)
    numbers = [var for var in system.state if isinstance(var, NumVar) and var not in system.ghosts]
    if any(range_of(var) not in known for var in numbers):
        return None
    return {fact.of: term for fact, term in known.items() if fact.kind == "lemma"}
