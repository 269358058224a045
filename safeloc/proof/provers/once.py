"""The same question of two processes is asked once: the second one waits, and then finds the answer in the cache."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager

from safeloc.proof.cache.answers import Solver, turn_of
from safeloc.proof.provers.limits import clock_stopped
from safeloc.proof.provers.slots import resting

LOOKS_AGAIN_S = 0.1


@contextmanager
def alone_in_asking(solver: Solver, text: str) -> Iterator[None]:
    """Within, no other process that uses the same cache asks this solver the same question.

    While it waits, this process has put its place at the processors back, and its clock stands. It has a place when it takes
    the turn, so that nobody who has a turn waits for anything. Whoever has waited looks first whether the other one has
    proved it. Without a cache nobody waits.
    """
    with turn_of(solver, text) as turn:
        while turn is not None and not turn.taken():
            with clock_stopped(), resting():
                time.sleep(LOOKS_AGAIN_S)
        yield
