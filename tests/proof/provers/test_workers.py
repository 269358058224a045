"""Tasks in processes: answers arrive, and no process hangs or dies unnoticed."""

from __future__ import annotations

import os
import time
from functools import partial

import pytest

from safeloc.errors import EngineError
from safeloc.proof.provers.workers import Lost, Task, in_processes


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
