"""Tasks in processes: several at a time, each with a time limit in case its solver hangs.

Processes are forked, so that nothing has to be sent to them; they send plain data back. A task has a process of its own, or follows
others in one: starting a process takes longer than many a small task.
"""

from __future__ import annotations

import multiprocessing
import sys
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from multiprocessing.context import ForkContext, ForkProcess
from typing import Any

from safeloc.errors import EngineError
from safeloc.proof.provers.collection import collect_rarely
from safeloc.proof.provers.slots import Slots, shared

_MOST_IN_A_PROCESS = 16
"""Tasks after which a process ends, with the memory that they have left in it."""
_LONGEST_WAIT_S = 86_400.0
"""Time after which the queue looks at its processes again. Longer waits than 24 days are more than the operating system's call takes."""


@dataclass(frozen=True)
class Task:
    """A piece of work: `work` returns plain data; its process is ended after `seconds`.

    follows  it may run in a process in which other such tasks have ended; solvers begin anew for it (before_forking.renew)
    """

    name: str
    work: Callable[[], Any]
    seconds: float
    follows: bool = False


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
    """A process with the task that it runs, or has ended.

    known  number of the tasks that were there when it was forked, which it can run
    begun  number of the tasks that it has begun
    """

    index: int
    process: ForkProcess
    pipe: Connection
    started: float
    known: int
    begun: int = 1


Then = Callable[[Any | Lost, float], None]
"""What follows on the end of a task; it gets the task's data, or Lost, and its seconds."""


class Queue:
    """Tasks that wait, and those that run in processes of their own, at most `jobs` at a time; the first added begins first, unless one is to be the next.

    If slots are shared (safeloc.proof.provers.slots), each task needs one, and this process gives its own back while it waits.

    What this process can do itself (`do_meanwhile`) is done piece by piece while no task waits and fewer than `jobs` run, and
    the rest of it when all have ended.
    """

    def __init__(self, jobs: int) -> None:
        self._jobs, self._tasks = max(1, jobs), list[Task]()
        self._waiting, self._running, self._then = list[int](), list[_Worker](), dict[int, Then]()
        self._idle = list[_Worker]()
        self._own: deque[Callable[[], None]] = deque()

    def do_meanwhile(self, pieces: Iterable[Callable[[], None]]) -> None:
        """Do these pieces of work in this process, one after the other; each holds up what the tasks' ends bring about."""
        self._own.extend(pieces)

    def add(self, task: Task, then: Then | None = None, *, next_: bool = False) -> None:
        """Add a task; also from the `then` of another one.

        next_  it begins before all others that wait: a long one, which would end last
        """
        number = len(self._tasks)
        self._tasks.append(task)
        self._waiting.insert(0 if next_ else len(self._waiting), number)
        if then is not None:
            self._then[number] = then

    def run(self) -> None:
        """Run all tasks, and those that are added meanwhile. EngineError if one raised an exception; the others are then ended."""
        for number, data, seconds in self.ended():
            self._then.pop(number)(data, seconds)
        while self._own:
            self._own.popleft()()

    def ended(self) -> Iterator[tuple[int, Any | Lost, float]]:
        """Run all tasks; yield (number of the task, its data or Lost, its seconds) as they end. EngineError as `run` raises it."""
        context, slots = _forking(), shared()
        if slots is not None:
            slots.give()
        try:
            while self._waiting or self._running:
                while self._may_start() and (slots is None or slots.try_take()):
                    self._running.append(self._begun(context, self._waiting.pop(0)))
                if not any(self._tasks[number].follows for number in self._waiting):
                    self._dismiss_idle()
                busy = self._did_a_piece(slots)
                free = [slots.free] if slots is not None and self._may_start() else []
                patience_s = 0.0 if busy else _patience(self._running, self._tasks)
                wait([*free, *(worker.pipe for worker in self._running)], timeout=patience_s)
                for worker in list(self._running):
                    answer = _answer(worker, self._tasks[worker.index])
                    if answer is not None:
                        self._running.remove(worker)
                        self._leave(worker, answer[0])
                        if slots is not None:
                            slots.give()
                        yield worker.index, answer[0], time.monotonic() - worker.started
        finally:
            self._dismiss_idle()
            for worker in self._running:
                _end(worker)
                if slots is not None:
                    slots.give()
            if slots is not None:
                slots.take()

    def _did_a_piece(self, slots: Slots | None) -> bool:
        """Do a piece of this process's own work, if a processor is free and no task wants it; return whether there was one."""
        wanted = self._waiting or len(self._running) >= self._jobs
        if not self._own or wanted or (slots is not None and not slots.try_take()):
            return False
        try:
            self._own.popleft()()
        finally:
            if slots is not None:
                slots.give()
        return True

    def _may_start(self) -> bool:
        return bool(self._waiting) and len(self._running) < self._jobs

    def _begun(self, context: ForkContext, number: int) -> _Worker:
        """Begin a task: in a process that waits for another one, if it follows and was known to that process; else in a new one."""
        if self._tasks[number].follows:
            for worker in [one for one in self._idle if number < one.known]:
                self._idle.remove(worker)
                if _goes_on(worker, number):
                    return worker
            self._dismiss_idle()
        return _start(context, number, self._tasks)

    def _leave(self, worker: _Worker, answer: Any | Lost) -> None:
        """Keep the process of a task that has ended for another task, or let it end."""
        if isinstance(answer, Lost):
            return
        if self._tasks[worker.index].follows and worker.begun < _MOST_IN_A_PROCESS:
            self._idle.append(worker)
        else:
            _dismiss(worker)

    def _dismiss_idle(self) -> None:
        while self._idle:
            _dismiss(self._idle.pop())


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


def _start(context: ForkContext, index: int, tasks: Sequence[Task]) -> _Worker:
    here, there = context.Pipe(duplex=True)
    process = context.Process(target=_run, args=(tasks, index, there, here), daemon=True)
    process.start()
    there.close()
    return _Worker(index, process, here, time.monotonic(), len(tasks))


def _goes_on(worker: _Worker, index: int) -> bool:
    """Give a process that waits its next task; False if it has died meanwhile."""
    try:
        worker.pipe.send(index)
    except OSError:
        _end(worker)
        return False
    worker.index, worker.started, worker.begun = index, time.monotonic(), worker.begun + 1
    return True


def _dismiss(worker: _Worker) -> None:
    """Let a process end that has ended its task."""
    with suppress(OSError):
        worker.pipe.send(None)
    worker.process.join()
    worker.pipe.close()


def _run(tasks: Sequence[Task], index: int, pipe: Connection, parents: Connection) -> None:
    """Run the task in the new process, and those that the parent asks for then; an exception is sent as text, and the parent raises it.

    parents  the parent's end of the pipe: closed here, so that this process notices when the parent is gone
    """
    collect_rarely()
    parents.close()
    following: int | None = index
    with pipe:
        while following is not None:
            try:
                pipe.send((tasks[following].work(),))
            except Exception as error:  # not swallowed: the parent raises it
                pipe.send(_Failed(f"{type(error).__name__}: {error}"))
            following = _following(pipe)


def _following(pipe: Connection) -> int | None:
    """Wait for the next task, and prepare for it; None if there is none, or nobody who could ask."""
    try:
        index: int | None = pipe.recv()
    except (EOFError, OSError):
        return None
    if index is not None and "z3" in sys.modules:  # it is loaded by who proves, and not by who lists what there is
        from safeloc.proof.provers.before_forking import renew

        renew()
    return index


def _patience(running: Sequence[_Worker], tasks: Sequence[Task]) -> float | None:
    if not running:
        return None
    now = time.monotonic()
    left = min(worker.started + tasks[worker.index].seconds - now for worker in running)
    return min(max(0.0, left), _LONGEST_WAIT_S)


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
        worker.pipe.close()
        return Lost(f"its process ended with code {worker.process.exitcode}")
    if isinstance(data, _Failed):
        raise EngineError(f"{task.name}: {data.text}")
    return data[0]


def _end(worker: _Worker) -> None:
    worker.process.kill()
    worker.process.join()
    with suppress(OSError):
        worker.pipe.close()
