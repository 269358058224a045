"""Turns: of several processes that would ask a solver the same question, one asks and the others wait.

A question is one byte of one file in the store's folder, locked by the process that asks. The operating system takes the lock
back when that process ends, however it ends. Where the system or the folder has no locks, everybody asks.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

NAME = "turns"
DIGITS = 15
"""So many hexadecimal digits of a key are the byte's place; two questions of one place only wait for each other."""


class Turn:
    """The lock of one question."""

    def __init__(self, file: int, place: int) -> None:
        self._file, self._place = file, place

    def taken(self) -> bool:
        """Take the turn; False if another process has it."""
        import fcntl  # not on every system; where it is missing no process is forked either

        try:
            fcntl.lockf(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB, 1, self._place)
        except (BlockingIOError, PermissionError):
            return False
        except OSError:  # a folder without locks: the question is asked, perhaps twice
            return True
        return True


@contextmanager
def turn(folder: Path, key: str) -> Iterator[Turn | None]:
    """Return the lock of the question with that key, given back at the end; None where the folder cannot be written."""
    file = _opened(folder / NAME)
    if file is None:
        yield None
        return
    try:
        yield Turn(file, int(key[:DIGITS], 16))
    finally:
        os.close(file)


def _opened(path: Path) -> int | None:
    with suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        return os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
    return None
