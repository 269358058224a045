"""Turns: of several processes that would solve the same query, one solves it and the others wait.

Each query has one byte of one file in the store's folder, which the solving process locks. The operating system releases the
lock when that process ends, however it ends. If the system or the folder has no locks, every process solves the query.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

_NAME = "turns"
_DIGITS = 15
"""Number of hexadecimal digits of a key that give the byte's place; two queries with one place merely wait for each other."""


class Turn:
    """The lock of one query."""

    def __init__(self, file: int, place: int) -> None:
        self._file, self._place = file, place

    def taken(self) -> bool:
        """Try to take the lock, and return whether this process has it; True also if there are no locks."""
        import fcntl  # not on every system; without it no process is forked either

        try:
            fcntl.lockf(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB, 1, self._place)
        except (BlockingIOError, PermissionError):
            return False
        except OSError:  # a folder without locks: the query may be solved twice
            return True
        return True


@contextmanager
def turn(folder: Path, key: str) -> Iterator[Turn | None]:
    """Provide the lock of the query with this key, and release it at the end; None if the folder cannot be written."""
    file = _opened(folder / _NAME)
    if file is None:
        yield None
        return
    try:
        yield Turn(file, int(key[:_DIGITS], 16))
    finally:
        os.close(file)


def _opened(path: Path) -> int | None:
    with suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        return os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
    return None
