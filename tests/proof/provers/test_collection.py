"""The collector of garbage looks rarely in a process that was forked to prove, and as before in its parent."""

from __future__ import annotations

import gc
import multiprocessing
from multiprocessing.connection import Connection

from safeloc.proof.provers.collection import collect_rarely

PYTHONS_OWN = (700, 10, 10)


def _thresholds(pipe: Connection) -> None:
    gc.set_threshold(*PYTHONS_OWN)
    collect_rarely()
    pipe.send((gc.get_threshold(), gc.get_freeze_count()))


def test_only_a_forked_process_collects_rarely() -> None:
    """It leaves alone what it inherits, and waits for many more new objects than Python's own thresholds say; its parent goes on as before."""
    before, context = gc.get_threshold(), multiprocessing.get_context("fork")
    here, there = context.Pipe()
    process = context.Process(target=_thresholds, args=(there,))
    process.start()
    thresholds, frozen = here.recv()
    process.join()
    assert gc.get_threshold() == before
    assert thresholds[0] > 10 * PYTHONS_OWN[0]
    assert frozen > gc.get_freeze_count()
