"""Avoid asking a solver the same question in two processes: the second one waits, and finds the answer in the cache."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager

from safeloc.proof.cache.answers import Solver, turn_of
from safeloc.proof.provers.limits import clock_stopped
from safeloc.proof.provers.slots import resting

_LOOKS_AGAIN_S = 0.1


@contextmanager
def alone_in_asking(solver: Solver, text: str) -> Iterator[None]:
    """Ensure that no other process with the same cache asks this solver the same question inside the block.

    While it waits, this process gives its slot at the processors back, and the clock of its deadlines stands still. It
    holds a slot again when it takes its turn, so that no process with a turn waits for anything. After it has waited,
    it first looks in the cache for a proof of the other process. Without a cache no process waits.
    """
    with turn_of(solver, text) as turn:
        while turn is not None and not turn.taken():
            with clock_stopped(), resting():
                time.sleep(_LOOKS_AGAIN_S)
        yield
