"""Snapshots of the process on disk: written to another name, flushed, renamed. So the file is always complete, old or new.

One thread writes all snapshots in order; if several wait, only the newest is written.
"""

from __future__ import annotations

import errno
import fcntl
import os
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from safeloc.errors import InputError, SnapshotError
from safeloc.runtime.embedding.snapshot import opened, sealed

KIND, VERSION = "safeloc-process", 1
LONGEST = 268_435_456
"""Most bytes of a snapshot; a thousand vehicles with full cycles take less."""

_Content = Callable[[], Mapping[str, Any]]


def write_atomically(path: Path, data: bytes) -> None:
    """Write a file so that content and name are on disk when this returns. OSError if that is impossible."""
    if len(data) > LONGEST:
        raise OSError(errno.EFBIG, f"{len(data)} bytes, but only {LONGEST} could be read back")
    beside = path.with_name(f"{path.name}.new")
    with beside.open("wb") as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())
    beside.replace(path)
    folder = os.open(path.parent, os.O_RDONLY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)


def read_saved(path: Path) -> dict[str, Any] | None:
    """Read the saved snapshot; None if there is none. SnapshotError if it is damaged, newer, too large or no snapshot."""
    try:
        with path.open("rb") as file:
            data = file.read(LONGEST + 1)
    except FileNotFoundError:
        return None
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}.") from error
    if len(data) > LONGEST:
        raise SnapshotError(f"{path}: over {LONGEST} bytes; no safeloc process wrote this file.")
    try:
        return opened(data, KIND, VERSION)
    except SnapshotError as error:
        raise SnapshotError(f"{path}: {error}") from error


def next_turn(now: float, every_s: float, turn: float) -> float:
    """Return when a snapshot is due next, later than `now` and within `every_s`.

    turn  which part of each period of the monotonic clock is its own, from 0 up to 1. All processes of a computer have
          the same clock, so those with different turns never save at the same time.
    """
    return now + every_s - (now - turn * every_s) % every_s


@contextmanager
def claimed(path: Path | None) -> Iterator[None]:
    """Lock the snapshot file for this process; InputError if another process has it, or if it is no file."""
    if path is None:
        yield
        return
    if path.is_dir():
        raise InputError(f"{path}: a folder; name a file for the snapshots.")
    if path.exists() and not path.is_file():
        raise InputError(f"{path}: a device or a pipe; name a file for the snapshots.")
    lock = path.with_name(f"{path.name}.lock")
    try:
        file = lock.open("wb")
    except OSError as error:
        raise InputError(f"{path}: snapshots cannot be written there: {error.strerror}.") from error
    with file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            raise InputError(f"{path}: another process saves its snapshots there; give each its own file.") from error
        yield


class Saver:
    """A writer of snapshots to one file.

    failed   the error of the last write; None if it succeeded
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.failed: Exception | None = None
        self._wanted: _Content | None = None
        self._asked = self._done = self._written_last = 0
        self._ending = False
        self._changed = threading.Condition()
        self._thread = threading.Thread(target=self._write, name="safeloc-saver", daemon=True)
        self._thread.start()

    def ask(self, content: _Content) -> int:
        """Request a snapshot; return the number of the request. `content` is called in the saver's thread."""
        with self._changed:
            self._wanted = content
            self._asked += 1
            self._changed.notify_all()
            return self._asked

    def save(self, content: _Content) -> None:
        """Write a snapshot before returning; InputError if the disk does not take it."""
        ticket = self.ask(content)
        with self._changed:
            self._changed.wait_for(lambda: self._done >= ticket)
        if isinstance(self.failed, OSError):
            raise InputError(f"{self.path}: the snapshot cannot be written: {self.failed.strerror}.") from self.failed
        if self.failed is not None:
            raise self.failed

    @property
    def written(self) -> int:
        """Return the number of the last request whose snapshot, or a newer one, is on disk."""
        with self._changed:
            return self._written_last

    @property
    def busy(self) -> bool:
        """Return whether a requested snapshot is not yet written."""
        with self._changed:
            return self._done < self._asked

    def end(self) -> None:
        """Write the requested snapshots, then stop."""
        with self._changed:
            self._ending = True
            self._changed.notify_all()
        self._thread.join()

    def _write(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._wanted is not None or self._ending)
                content, self._wanted, ticket = self._wanted, None, self._asked
            if content is None:
                return
            failed = self._written(content)
            with self._changed:
                self.failed, self._done = failed, ticket
                if failed is None:
                    self._written_last = ticket
                self._changed.notify_all()

    def _written(self, content: _Content) -> Exception | None:
        try:
            write_atomically(self.path, sealed(content(), KIND, VERSION))
        except Exception as error:  # passed to the caller of `save`: this thread must not end
            return error
        return None
