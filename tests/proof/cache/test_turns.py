"""Turns: one process has a question's lock at a time, and gives it back however it ends."""

from __future__ import annotations

import multiprocessing
import os
from multiprocessing.connection import Connection
from pathlib import Path

import pytest

from safeloc.proof.cache.turns import turn

FORK = multiprocessing.get_context("fork")
KEY, OTHER = "0" * 63 + "1", "1" + "0" * 63


def hold(folder: Path, pipe: Connection) -> None:
    """Take the turn, tell so, and keep it until told."""
    with turn(folder, KEY) as mine:
        assert mine is not None
        pipe.send(mine.taken())
        pipe.recv()


@pytest.mark.parametrize("killed", [False, True])
def test_another_process_has_it_until_it_ends(tmp_path: Path, killed: bool) -> None:
    """Of another question it has nothing; a killed process has nothing any more."""
    here, there = FORK.Pipe()
    other = FORK.Process(target=hold, args=(tmp_path, there))
    other.start()
    assert here.recv() is True
    with turn(tmp_path, KEY) as mine, turn(tmp_path / "elsewhere", KEY) as elsewhere:
        assert mine is not None and elsewhere is not None
        assert not mine.taken()
        assert elsewhere.taken()
        if killed:
            other.kill()
        else:
            here.send("end")
        other.join()
        assert mine.taken()


def test_two_questions_do_not_wait_for_each_other(tmp_path: Path) -> None:
    """The lock is the question's, not the folder's."""
    here, there = FORK.Pipe()
    other = FORK.Process(target=hold, args=(tmp_path, there))
    other.start()
    assert here.recv() is True
    with turn(tmp_path, OTHER) as mine:
        assert mine is not None and mine.taken()
    here.send("end")
    other.join()


def test_where_nothing_can_be_written_nobody_waits(tmp_path: Path) -> None:
    """A folder that is a file: there is no turn."""
    (tmp_path / "file").write_text("")
    with turn(tmp_path / "file", KEY) as mine:
        assert mine is None


def test_without_locks_everybody_asks(tmp_path: Path) -> None:
    """If the system refuses a lock, here on a closed file, the query is solved without one."""
    with turn(tmp_path, KEY) as mine:
        assert mine is not None
        os.close(mine._file)
        assert mine.taken()
        mine._file = os.open(tmp_path / "again", os.O_RDWR | os.O_CREAT)
