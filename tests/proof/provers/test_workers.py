"""Tasks in processes: answers arrive, and no process hangs or dies unnoticed."""

from __future__ import annotations

import multiprocessing
import os
import time
from contextlib import nullcontext
from functools import partial

import pytest
import z3

from safeloc.errors import EngineError
from safeloc.proof.provers.before_forking import renew
from safeloc.proof.provers.slots import Slots, sharing
from safeloc.proof.provers.workers import Lost, Queue, Task, in_processes


def _fail() -> None:
    raise ValueError("no such solver")


def test_answers_come_with_their_number() -> None:
    """Every task is answered once, whatever the order."""
    tasks = [Task(str(number), partial(pow, number, 2), 30.0) for number in range(7)]
    answers = {index: data for index, data, _ in in_processes(tasks, 2)}
    assert answers == {number: number * number for number in range(7)}


def test_a_hanging_task_is_ended_by_the_clock() -> None:
    """A task that never returns is lost at its time limit; the others are answered."""
    tasks = [Task("hangs", lambda: time.sleep(600), 0.3), Task("works", lambda: "done", 30.0)]
    started = time.monotonic()
    answers = {index: data for index, data, _ in in_processes(tasks, 2)}
    assert time.monotonic() - started < 10.0
    assert answers == {0: Lost("ended by the clock after 0.3 s"), 1: "done"}


def test_a_limit_may_be_longer_than_a_month() -> None:
    """The operating system's call waits some weeks at most: a base of hundreds of machines with hours for each has a longer limit."""
    [(_, answer, _)] = in_processes([Task("works", lambda: "done", 1e8)], 1)
    assert answer == "done"


def test_a_process_that_dies_is_noticed() -> None:
    """A solver that crashes its process leaves the task lost, with the exit code."""
    [(_, answer, _)] = in_processes([Task("dies", lambda: os._exit(7), 30.0)], 1)
    assert answer == Lost("its process ended with code 7")


def test_an_exception_is_raised_and_the_rest_is_ended() -> None:
    """An exception in a task is raised here, and is no missing answer."""
    tasks = [Task("fails", _fail, 30.0), Task("sleeps", lambda: time.sleep(600), 600.0)]
    started = time.monotonic()
    with pytest.raises(EngineError, match=r"^fails: ValueError: no such solver$"):
        list(in_processes(tasks, 2))
    assert time.monotonic() - started < 10.0


def test_what_follows_a_task_may_add_others() -> None:
    """Each squares what the one before found; what follows runs in this process."""
    queue, found = Queue(2), list[int]()

    def follow(number: int, _seconds: float) -> None:
        found.append(number)
        if number < 200:
            queue.add(Task("square", partial(pow, number, 2), 30.0), follow)

    queue.add(Task("two", lambda: 2, 30.0), follow)
    queue.run()
    assert [2, 4, 16, 256] == found


def test_an_error_of_what_follows_ends_the_others() -> None:
    """It is raised as it is, and no process is left."""
    queue = Queue(2)
    queue.add(Task("works", lambda: 1, 30.0), lambda *_: _fail())
    queue.add(Task("sleeps", lambda: time.sleep(600), 600.0), lambda *_: None)
    started = time.monotonic()
    with pytest.raises(ValueError, match="no such solver"):
        queue.run()
    assert time.monotonic() - started < 10.0
    assert [] == multiprocessing.active_children()


def _processes(queue: Queue) -> list[object]:
    """What the tasks of a queue return, in the order in which they end."""
    return [data for _, data, _ in queue.ended()]


def test_small_tasks_follow_each_other_in_a_process() -> None:
    """One process has several of them, but not without end; a task that follows nobody has its own."""
    queue = Queue(1)
    for number in range(40):
        queue.add(Task(str(number), os.getpid, 30.0, follows=True))
    queue.add(Task("alone", os.getpid, 30.0))
    *following, alone = _processes(queue)
    assert 1 < len(set(following)) < 10
    assert alone not in following
    assert [] == multiprocessing.active_children()


def test_solvers_begin_anew_for_a_task_that_follows() -> None:
    """It finds an empty context of z3, as a task in a new process does: what another task did changes no answer."""

    def numbers() -> tuple[int, int]:
        return os.getpid(), z3.Int("x").get_id() + z3.Solver().num_scopes()

    def first_numbers() -> tuple[int, int]:
        renew()  # as in a process that has proved nothing yet; this one is a fork of the tests
        return numbers()

    queue = Queue(1)
    for number, work in enumerate((first_numbers, numbers, numbers)):
        queue.add(Task(str(number), work, 30.0, follows=True))
    [(process, first), *others] = _processes(queue)
    assert [(process, first)] * 2 == others


def test_a_process_that_is_lost_takes_no_other_task_with_it() -> None:
    """Of tasks that follow each other, one that dies and one that hangs are lost alone; each task has its whole time."""
    works = [lambda: 1, lambda: os._exit(7), lambda: 2, lambda: time.sleep(600), lambda: 3]
    queue = Queue(1)
    for number, work in enumerate(works):
        queue.add(Task(str(number), work, 1.0 if number == 3 else 30.0, follows=True))
    died, hung = Lost("its process ended with code 7"), Lost("ended by the clock after 1 s")
    assert [1, died, 2, hung, 3] == _processes(queue)


def test_a_task_that_was_added_later_follows_as_well() -> None:
    """A process that was forked before the task was there does not run it."""
    queue, found = Queue(1), list[int]()

    def follow(number: int, _seconds: float) -> None:
        found.append(number)
        if number < 200:
            queue.add(Task("square", partial(pow, number, 2), 30.0, follows=True), follow)

    queue.add(Task("two", lambda: 2, 30.0, follows=True), follow)
    queue.run()
    assert [2, 4, 16, 256] == found


def test_a_task_may_be_the_next_one() -> None:
    """It begins before those that have waited longer."""
    queue, began = Queue(1), list[str]()

    def add(name: str, *, next_: bool = False, then: str = "") -> None:
        def ended(*_: object) -> None:
            began.append(name)
            if then:
                add(then, next_=True)

        queue.add(Task(name, lambda: None, 30.0), ended, next_=next_)

    add("first", then="long")
    add("second")
    add("third", next_=True)
    queue.run()
    assert ["third", "first", "long", "second"] == began


def _done_meanwhile(jobs: int, slots: Slots | None = None) -> list[str]:
    """What happened in this process, in order: two tasks, of which one waits for a pipe, and two pieces of its own work."""
    queue, happened = Queue(jobs), list[str]()
    reading, writing = os.pipe()
    queue.add(Task("waits", lambda: os.read(reading, 1), 30.0), lambda data, _: happened.append("waited"))
    queue.add(Task("works", lambda: b"", 30.0), lambda data, _: happened.append("worked"))

    def last() -> None:
        happened.append("last piece")
        os.write(writing, b".")

    queue.do_meanwhile([lambda: happened.append("piece"), last])
    if jobs == 1 or slots is not None:
        os.write(writing, b".")  # nothing else lets the task go on
    with nullcontext() if slots is None else sharing(slots):
        queue.run()
    os.close(reading)
    os.close(writing)
    return happened


def test_own_work_is_done_while_a_processor_is_free() -> None:
    """After all tasks have begun, and before the last one ends."""
    assert _done_meanwhile(2) == ["worked", "piece", "last piece", "waited"]


def test_own_work_is_left_to_the_end_where_no_processor_is_free() -> None:
    """One task at a time may run, or one slot is all there is."""
    assert _done_meanwhile(1) == ["waited", "worked", "piece", "last piece"]
    slots = Slots(1)
    slots.take()
    assert _done_meanwhile(2, slots) == ["waited", "worked", "piece", "last piece"]
    assert not slots.try_take()
    slots.close()


def test_an_error_of_own_work_ends_the_tasks() -> None:
    """As one of a task does."""
    queue = Queue(2)
    queue.add(Task("sleeps", lambda: time.sleep(600), 600.0), lambda data, _: None)
    queue.do_meanwhile([_fail])
    started = time.monotonic()
    with pytest.raises(ValueError, match="no such solver"):
        queue.run()
    assert time.monotonic() - started < 10.0
    assert not multiprocessing.active_children()
