"""Slots at the processors: there are never more tasks at a time than slots, whichever process starts them."""

from __future__ import annotations

import multiprocessing
import time
from functools import partial
from multiprocessing.synchronize import Barrier

from safeloc.proof.provers.slots import Slots, shared, sharing
from safeloc.proof.provers.workers import Task, in_processes

PATIENCE_S = 90.0


def test_places_are_taken_and_given_back() -> None:
    """Of two slots a third one cannot be had until one is given back."""
    places = Slots(2)
    assert [True, True, False] == [places.try_take() for _ in range(3)]
    places.give()
    assert places.try_take()
    places.close()


def timed(seconds: float, met: Barrier) -> tuple[float, float]:
    """The times at which a task began and ended; it ends only after another one was there at the same time."""
    began = time.monotonic()
    met.wait(PATIENCE_S)
    time.sleep(seconds)
    return began, time.monotonic()


def test_tasks_wait_for_a_place() -> None:
    """Four tasks may run four at a time, but two slots, one of them this process's own, allow two at a time."""
    places = Slots(2)
    places.take()
    met = multiprocessing.get_context("fork").Barrier(2)
    tasks = [Task(f"task {number}", partial(timed, 0.2, met), 2 * PATIENCE_S) for number in range(4)]
    with sharing(places):
        assert shared() is places
        spans = [data for _, data, _ in in_processes(tasks, 4)]
    assert shared() is None
    moments = sorted([(began, 1) for began, _ in spans] + [(ended, -1) for _, ended in spans])
    running = [sum(step for _, step in moments[: place + 1]) for place in range(len(moments))]
    assert 2 == max(running)
    assert [True, False] == [places.try_take() for _ in range(2)]  # this process has its own again
    places.close()
