"""Destinations of reports: standard output or a file. Peers get reports over their socket (safeloc.runtime.service.tcp)."""

from __future__ import annotations

import json
import os
import select
import selectors
from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from safeloc.errors import InputError
from safeloc.runtime.service.feeds import Event

FULL = 1_048_576
"""Bytes of waiting reports; with more, the process stops reading until the reader has caught up."""

_LAST_LINE = 1_048_576
"""Bytes at the end of a file in which the last line end is searched."""


class Outlet(ABC):
    """A destination of reports; they wait in it until `flush`."""

    def text(self, one: Mapping[str, Any]) -> bytes:
        """Return a report or an event as the line that `put` takes."""
        return json.dumps(one).encode() + b"\n"

    @abstractmethod
    def put(self, origin: str, data: bytes, *, event: bool = False) -> None:
        """Add one line for the reader of this origin's reports. `event`: it is no report, but tells of one event."""

    @abstractmethod
    def flush(self) -> None:
        """Write as much as is possible without waiting; BrokenPipeError if the reader has closed the pipe."""

    @property
    @abstractmethod
    def full(self) -> bool:
        """Return whether too many reports wait to make further ones."""

    @property
    @abstractmethod
    def waiting(self) -> bool:
        """True if reports wait."""

    def sync(self) -> None:  # noqa: B027 # nothing to do for a pipe or socket
        """Make sure that written reports are on disk."""

    def position(self) -> Mapping[str, Any]:
        """Return the position in the output, for a snapshot."""
        return {}

    def trim(self, position: Mapping[str, Any], replays: bool) -> None:  # noqa: B027 # sent reports stay sent
        """Continue at a position. `replays`: reports after it will be made again, so remove them."""

    def close(self) -> None:  # noqa: B027 # a descriptor of the caller stays open
        """Stop writing for good."""


class Stdout(Outlet):
    """A file descriptor; to a pipe, no more is written at once than it takes without waiting."""

    def __init__(self, selector: selectors.BaseSelector, fd: int = 1) -> None:
        self._selector, self._fd = selector, fd
        self._buffer = bytearray()
        self._poll = select.poll()
        self._poll.register(fd, select.POLLOUT)
        self._registered = False

    def put(self, origin: str, data: bytes, *, event: bool = False) -> None:
        """Write one line."""
        del origin, event
        self._buffer += data

    def flush(self) -> None:
        """Write as much as the reader takes now; the selector reports when there is room again."""
        while self._buffer and self._poll.poll(0):
            written = self._written()
            del self._buffer[:written]
            if not written:
                break
        if bool(self._buffer) is not self._registered:
            self._registered = not self._registered
            if self._registered:
                self._selector.register(self._fd, selectors.EVENT_WRITE, self._ready)
            else:
                self._selector.unregister(self._fd)

    def _written(self) -> int:
        try:
            return os.write(self._fd, self._buffer[: select.PIPE_BUF])
        except BlockingIOError:
            return 0
        except BrokenPipeError:
            raise
        except OSError as error:
            raise InputError(f"standard output cannot be written: {error.strerror}.") from error

    def _ready(self, _mask: int) -> Iterator[Event]:
        """Do nothing: the loop flushes, after it has saved whatever must be saved before."""
        yield from ()

    @property
    def full(self) -> bool:
        """Return whether the reader is too slow."""
        return len(self._buffer) > FULL

    @property
    def waiting(self) -> bool:
        """True if reports wait."""
        return bool(self._buffer)


class ToFile(Outlet):
    """A file to which lines are appended. An incomplete line of a killed process is removed first."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._buffer = bytearray()
        if path.exists() and not (path.is_file() or path.is_dir()):
            raise InputError(f"{path}: a device or a pipe; reports go to a file, or to standard output.")
        with self._in_words():
            self._fd = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o644)
            os.ftruncate(self._fd, self._last_end())
            self._size = os.lseek(self._fd, 0, os.SEEK_END)

    @contextmanager
    def _in_words(self) -> Iterator[None]:
        """Turn an error of the system into an InputError that names the file."""
        try:
            yield
        except OSError as error:
            raise InputError(f"{self._path}: cannot be written: {error.strerror}.") from error

    def put(self, origin: str, data: bytes, *, event: bool = False) -> None:
        """Write one line."""
        del origin, event
        self._buffer += data

    def flush(self) -> None:
        """Write all reports; InputError if the disk does not take them."""
        while self._buffer:
            with self._in_words():
                written = os.write(self._fd, self._buffer)
            self._size += written
            del self._buffer[:written]

    @property
    def full(self) -> bool:
        """Return False: a file takes everything."""
        return False

    @property
    def waiting(self) -> bool:
        """True if reports wait."""
        return bool(self._buffer)

    def sync(self) -> None:
        """Make sure that written reports are on disk."""
        with self._in_words():
            os.fsync(self._fd)

    def position(self) -> Mapping[str, Any]:
        """Return the number of bytes that were written."""
        return {"file": str(self._path), "size": self._size}

    def trim(self, position: Mapping[str, Any], replays: bool) -> None:
        """If the input is replayed, remove reports written after the snapshot; InputError if earlier ones are missing."""
        size = position.get("size")
        if not replays or position.get("file") != str(self._path) or type(size) is not int:
            return
        if self._size < size:
            raise InputError(
                f"{self._path}: shorter than when the snapshot was taken ({self._size} bytes, then {size}); restore it, "
                "name another file, or start without the snapshot (--fresh)."
            )
        with self._in_words():
            os.ftruncate(self._fd, size)
            self._size = os.lseek(self._fd, 0, os.SEEK_END)

    def close(self) -> None:
        """Close the file."""
        os.close(self._fd)

    def _last_end(self) -> int:
        """Return the end of the last complete line."""
        size = os.lseek(self._fd, 0, os.SEEK_END)
        begin = max(0, size - _LAST_LINE)
        found = os.pread(self._fd, size - begin, begin).rfind(b"\n")
        if found < 0 and begin > 0:
            raise InputError(f"{self._path}: no line end in its last {_LAST_LINE} bytes; this is no file of reports.")
        return begin + found + 1
