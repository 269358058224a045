"""On-board invariants: they hold in the first state, and after each step from ANY state in which they hold."""

from __future__ import annotations

from collections.abc import Mapping

from safeloc.language.expr import Bool, NumVar
from safeloc.language.system import TransitionSystem
from safeloc.proof.provers.facts import range_of
from safeloc.proof.provers.proved_base import base

SECONDS = 120.0
"""For the system, and of a composition for each of its machines; the largest shipped one takes about a minute."""


def lasting(system: TransitionSystem, *, seconds: float = SECONDS) -> Mapping[str, Bool] | None:
    """Return lemmas that last together with the ranges of all state variables, for all inputs in range. They read no ghost.

    None where that is not proved of a range, for then no lemma helps.
    """
    known = base(system, seconds=seconds).always
    own = [var for var in system.state if isinstance(var, NumVar) and var not in system.ghosts]
    if any(range_of(var) not in known for var in own):
        return None
    return {fact.of: term for fact, term in known.items() if fact.kind == "lemma"}
