"""Tasks in processes of their own: several at a time, each with a time limit in case its solver hangs.

Processes are forked, so that nothing has to be sent to them; they send plain data back.
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
    """A piece of work: `work` returns plain data; its process is ended after `seconds`."""

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
    """Run tasks, at most `jobs` at a time; yield (number of the task, its data or Lost, its seconds) as they end.

    If slots are shared (safeloc.proof.provers.slots), each task needs one, and this process gives its own back while it waits.
    EngineError if a task raised an exception; the others are then ended.
    """
    context = _forking()
    waiting, running = list(range(len(tasks))), list[_Worker]()
    slots = shared()
    if slots is not None:
        slots.give()
    try:
        while waiting or running:
            while waiting and len(running) < max(1, jobs) and (slots is None or slots.try_take()):
                running.append(_start(context, waiting[0], tasks[waiting.pop(0)]))
            asked = slots is not None and waiting and len(running) < max(1, jobs)
            free = [slots.free] if slots is not None and asked else []
            wait([*free, *(worker.pipe for worker in running)], timeout=_patience(running, tasks))
            for worker in list(running):
                answer = _answer(worker, tasks[worker.index])
                if answer is not None:
                    running.remove(worker)
                    if slots is not None:
                        slots.give()
                    yield worker.index, answer[0], time.monotonic() - worker.started
    finally:
        for worker in running:
            _end(worker)
            if slots is not None:
                slots.give()
        if slots is not None:
            slots.take()


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
    """Run the task in the new process; an exception is sent as text, and the parent raises it."""
    gc.freeze()  # keeps the collector away from inherited objects, since visiting them would copy every page
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
    """Return the task's data if it has arrived, Lost if its process died or its time is up, None to go on waiting."""
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
