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


Then = Callable[[Any | Lost, float], None]
"""What follows on the end of a task; it gets the task's data, or Lost, and its seconds."""


class Queue:
    """Tasks that wait, and those that run in processes of their own, at most `jobs` at a time; the first added begins first.

    If slots are shared (safeloc.proof.provers.slots), each task needs one, and this process gives its own back while it waits.
    """

    def __init__(self, jobs: int) -> None:
        self._jobs, self._tasks = max(1, jobs), list[Task]()
        self._waiting, self._running, self._then = list[int](), list[_Worker](), dict[int, Then]()

    def add(self, task: Task, then: Then | None = None) -> None:
        """Add a task; also from the `then` of another one."""
        number = len(self._tasks)
        self._tasks.append(task)
        self._waiting.append(number)
        if then is not None:
            self._then[number] = then

    def run(self) -> None:
        """Run all tasks, and those that are added meanwhile. EngineError if one raised an exception; the others are then ended."""
        for number, data, seconds in self.ended():
            self._then.pop(number)(data, seconds)

    def ended(self) -> Iterator[tuple[int, Any | Lost, float]]:
        """Run all tasks; yield (number of the task, its data or Lost, its seconds) as they end. EngineError as `run` raises it."""
        context, slots = _forking(), shared()
        if slots is not None:
            slots.give()
        try:
            while self._waiting or self._running:
                while self._may_start() and (slots is None or slots.try_take()):
                    number = self._waiting.pop(0)
                    self._running.append(_start(context, number, self._tasks[number]))
                free = [slots.free] if slots is not None and self._may_start() else []
                wait([*free, *(worker.pipe for worker in self._running)], timeout=_patience(self._running, self._tasks))
                for worker in list(self._running):
                    answer = _answer(worker, self._tasks[worker.index])
                    if answer is not None:
                        self._running.remove(worker)
                        if slots is not None:
                            slots.give()
                        yield worker.index, answer[0], time.monotonic() - worker.started
        finally:
            for worker in self._running:
                _end(worker)
                if slots is not None:
                    slots.give()
            if slots is not None:
                slots.take()

    def _may_start(self) -> bool:
        return bool(self._waiting) and len(self._running) < self._jobs


def in_processes(tasks: Sequence[Task], jobs: int) -> Iterator[tuple[int, Any | Lost, float]]:
    """Run tasks, at most `jobs` at a time; yield (number of the task, its data or Lost, its seconds) as they end.

    EngineError if a task raised an exception; the others are then ended.
    """
    queue = Queue(jobs)
    for task in tasks:
        queue.add(task)
    yield from queue.ended()


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
