"""Work in processes of its own: several at a time, each ended by the clock if its solver hangs.

Processes are forked, so that nothing has to be sent to them; what they send back is plain data.
"""

from __future__ import annotations

import gc
import multiprocessing
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from multiprocessing.context import ForkContext, ForkProcess
from typing import Any

from safeloc.errors import EngineError
from safeloc.proof.provers.slots import shared


@dataclass(frozen=True)
class Task:
    """A piece of work: `work` returns plain data; it is ended after `seconds`."""

    name: str
    work: Callable[[], Any]
    seconds: float


@dataclass(frozen=True)
class Lost:
    """The process ended without an answer."""

    reason: str


@dataclass(frozen=True)
class _Failed:
    """An exception, as text."""

    text: str


@dataclass
class _Worker:
    index: int
    process: ForkProcess
    pipe: Connection
    started: float


def in_processes(tasks: Sequence[Task], jobs: int) -> Iterator[tuple[int, Any | Lost, float]]:
    """(number of the task, its data or Lost, seconds it took), as they come; at most `jobs` at a time.

    Where places are shared (safeloc.proof.provers.slots), each task needs one, and this process puts its own back while it
    waits. EngineError if a task raised an exception: the rest is ended.
    """
    context = _forking()
    waiting, running = list(range(len(tasks))), list[_Worker]()
    places = shared()
    if places is not None:
        places.give()
    try:
        while waiting or running:
            while waiting and len(running) < max(1, jobs) and (places is None or places.try_take()):
                running.append(_start(context, waiting[0], tasks[waiting.pop(0)]))
            asked = places is not None and waiting and len(running) < max(1, jobs)
            free = [places.free] if places is not None and asked else []
            wait([*free, *(worker.pipe for worker in running)], timeout=_patience(running, tasks))
            for worker in list(running):
                answer = _answer(worker, tasks[worker.index])
                if answer is not None:
                    running.remove(worker)
                    if places is not None:
                        places.give()
                    yield worker.index, answer[0], time.monotonic() - worker.started
    finally:
        for worker in running:
            _end(worker)
            if places is not None:
                places.give()
        if places is not None:
            places.take()


def _forking() -> ForkContext:
    if "fork" not in multiprocessing.get_all_start_methods():
        raise EngineError("proving needs an operating system that can fork processes (Linux or macOS).")
    return multiprocessing.get_context("fork")


def _start(context: ForkContext, index: int, task: Task) -> _Worker:
    here, there = context.Pipe(duplex=False)
    process = context.Process(target=_run, args=(task, there), daemon=True)
    process.start()
    there.close()
    return _Worker(index, process, here, time.monotonic())


def _run(task: Task, pipe: Connection) -> None:
    """In the new process: whatever goes wrong is handed over as text, and raised by the parent."""
    gc.freeze()  # the collector never walks through what is inherited, which would copy every page of it
    try:
        pipe.send((task.work(),))
    except Exception as error:  # not swallowed: the parent raises it
        pipe.send(_Failed(f"{type(error).__name__}: {error}"))
    finally:
        pipe.close()


def _patience(running: Sequence[_Worker], tasks: Sequence[Task]) -> float | None:
    now = time.monotonic()
    return max(0.0, min(worker.started + tasks[worker.index].seconds - now for worker in running)) if running else None


def _answer(worker: _Worker, task: Task) -> tuple[Any | Lost] | None:
    """The task's data, if it has come; Lost if its process died or its time is up; None to go on waiting."""
    if worker.pipe.poll():
        return (_received(worker, task),)
    if time.monotonic() - worker.started >= task.seconds:
        _end(worker)
        return (Lost(f"ended by the clock after {task.seconds:g} s"),)
    return None


def _received(worker: _Worker, task: Task) -> Any | Lost:
    try:
        data = worker.pipe.recv()
    except EOFError:
        worker.process.join()
        return Lost(f"its process ended with code {worker.process.exitcode}")
    worker.process.join()
    worker.pipe.close()
    if isinstance(data, _Failed):
        raise EngineError(f"{task.name}: {data.text}")
    return data[0]


def _end(worker: _Worker) -> None:
    worker.process.kill()
    worker.process.join()
    with suppress(OSError):
        worker.pipe.close()
