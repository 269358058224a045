"""Sources of lines: standard input, and a growing file."""

from __future__ import annotations

import hashlib
import os
import selectors
import stat
from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from io import FileIO
from pathlib import Path
from typing import Any, NamedTuple

from safeloc.errors import InputError
from safeloc.runtime.service.lines import Line, LineCutter
from safeloc.runtime.service.saved_fields import SavedPlace, checked_fields

_AT_ONCE = 16_384
"""Most bytes read in one turn: at most some thousand lines."""

_AGAIN_S = 0.01
"""Seconds until a file is checked again after its end was reached."""

_MARK = 4_096
"""Number of bytes before a position whose digest identifies the file."""


class Arrived(NamedTuple):
    """A line that arrived. `vehicle`: the only one for which its sender may send; None: any."""

    origin: str
    line: Line
    vehicle: str | None = None


@dataclass(frozen=True)
class Left:
    """The end of an origin: a peer disconnected, or a file was replaced."""

    origin: str
    why: str


@dataclass(frozen=True)
class Over:
    """The end of all input."""


class Told(NamedTuple):
    """A message of somebody else, beside the lines: what a station's vehicles may want to know of `about`."""

    about: str
    payload: bytes


Event = Arrived | Left | Over | Told


class Feed(ABC):
    """A source of lines.

    from_start  the first line read is the first line sent
    replays    the same lines can be read again after a restart
    repeated   lines that came again and were left out; None where none can
    save_turn  its part of a period in which a snapshot is due, from 0 up to 1 (`saving.next_turn`): feeds that share processors
               are saved one after another, so that no line waits for the snapshots of all
    """

    from_start = False
    replays = False
    repeated: int | None = None
    save_turn = 0.0

    @abstractmethod
    def open(self, selector: selectors.BaseSelector) -> None:
        """Begin to read; InputError if that is impossible."""

    @abstractmethod
    def hold(self, held: bool) -> None:
        """Stop reading, so that the sender has to wait, or continue."""

    def look(self) -> Iterator[Event]:
        """Return the events that a selector does not report."""
        yield from ()

    @property
    def again_s(self) -> float | None:
        """Return the time until the next `look`; None if none is needed."""
        return None

    @property
    def live(self) -> bool:
        """Return whether silence counts. It does not while a file is read whose later lines may be of any vehicle."""
        return True

    def position(self) -> Mapping[str, Any]:
        """Return the position of the next line, for a snapshot."""
        return {}

    def resume(self, position: Mapping[str, Any]) -> str:
        """Continue at a position; call it before `open`. Return why lines may be missing since; "" if none can be."""
        del position
        return "the process was not running"

    def mark(self) -> int:
        """Return how far lines were handled, for `kept`."""
        return 0

    def kept(self, mark: int) -> None:  # noqa: B027 # nobody waits for it
        """Note that a snapshot with everything up to a mark is on disk."""

    @abstractmethod
    def close(self) -> None:
        """Stop reading for good."""


class Stdin(Feed):
    """A file descriptor that is read to its end."""

    from_start = True
    ORIGIN = "stdin"

    def __init__(self, fd: int = 0) -> None:
        self._fd = fd
        self._cutter = LineCutter()
        self._selector: selectors.BaseSelector | None = None
        self._reading = False
        self._is_file = _is_file(fd)

    @property
    def live(self) -> bool:
        """Return whether silence counts: not if standard input is a file."""
        return not self._is_file

    def open(self, selector: selectors.BaseSelector) -> None:
        """Begin to read."""
        self._selector = selector
        self.hold(False)

    def hold(self, held: bool) -> None:
        """Stop reading or continue: a pipe that is not read fills up, and its writer waits."""
        if self._selector is None or self._reading is not held:
            return
        self._reading = not held
        if held:
            self._selector.unregister(self._fd)
        else:
            self._selector.register(self._fd, selectors.EVENT_READ, self._ready)

    def _ready(self, _mask: int) -> Iterator[Event]:
        try:
            data = os.read(self._fd, _AT_ONCE)
        except BlockingIOError:
            return
        except OSError as error:
            raise InputError(f"standard input cannot be read: {error.strerror}.") from error
        for line in self._cutter.feed(data) if data else ():
            yield Arrived(self.ORIGIN, line)
        if not data:
            self.hold(True)
            self._selector = None
            tail = self._cutter.tail()
            if tail is not None:
                yield Arrived(self.ORIGIN, tail)
            yield Over()

    def close(self) -> None:
        """Stop reading; the descriptor belongs to the caller and stays open."""
        self.hold(True)


class GrowingFile(Feed):
    """A file to which another process writes. It may be created later, truncated, or replaced.

    to_its_end   stop at the end of the file
    """

    from_start = True
    replays = True

    def __init__(self, path: Path, *, to_its_end: bool) -> None:
        self.origin = str(path)
        self._path, self._to_its_end = path, to_its_end
        self._cutter = LineCutter()
        self._file: FileIO | None = None
        self._held = self._at_end = self._over = False

    def open(self, selector: selectors.BaseSelector) -> None:
        """Begin to read; wait for a file that does not exist yet."""
        del selector
        if self._file is None:
            self._open(0)
        if self._file is None and self._to_its_end:
            raise InputError(f"{self._path}: no such file.")

    def hold(self, held: bool) -> None:
        """Stop reading or continue: the file keeps its content."""
        self._held = held

    @property
    def again_s(self) -> float | None:
        """Return the time until the next `look`: 0 until the end of the file is reached."""
        if self._held or self._over:
            return None
        return _AGAIN_S if self._at_end else 0.0

    @property
    def live(self) -> bool:
        """Return whether silence counts: only at the end of the file. Before, lines are read without regard to time."""
        return self._at_end and not self._to_its_end

    def look(self) -> Iterator[Event]:
        """Return the next part of the file; InputError if it cannot be read."""
        if self._held or self._over or not self._opened():
            return
        assert self._file is not None
        with self._in_words():
            data = self._file.read(_AT_ONCE)
        self._at_end = not data
        for line in self._cutter.feed(data):
            yield Arrived(self.origin, line)
        if not data and self._to_its_end:
            self._over = True
            tail = self._cutter.tail()
            if tail is not None:
                yield Arrived(self.origin, tail)
            yield Over()
        elif not data and self._replaced():
            yield from self._begin_other()

    def position(self) -> Mapping[str, Any]:
        """Return the start of the next complete line, and a digest of the text before it."""
        consumed = self._cutter.consumed
        return {"file": self.origin, "consumed": consumed, "line": self._cutter.number, "mark": self._mark(consumed)}

    def resume(self, position: Mapping[str, Any]) -> str:
        """Continue after the last line that was used, if the text before it is unchanged."""
        if position.get("file") != self.origin:
            return f"lines came from another source before, {position.get('file', 'no file')}"
        place = checked_fields(SavedPlace, position)
        self._open(place.consumed)
        if self._mark(place.consumed) != place.mark:
            self._close()
            return f"{self._path} is another file than before"
        self._cutter = LineCutter(place.line, place.consumed)
        return ""

    def close(self) -> None:
        """Stop reading for good."""
        self._over = True
        self._close()

    def _opened(self) -> bool:
        if self._file is None:
            self._open(0)
            self._at_end = self._file is None
        return self._file is not None

    def _open(self, at: int) -> None:
        if self._path.exists() and not (self._path.is_file() or self._path.is_dir()):
            raise InputError(f"{self._path}: a device or a pipe; give it as standard input.")
        with self._in_words():
            try:
                self._file = FileIO(self._path)
            except FileNotFoundError:
                self._file = None
            else:
                self._file.seek(at)

    @contextmanager
    def _in_words(self) -> Iterator[None]:
        """Turn an error of the system into an InputError that names the file."""
        try:
            yield
        except (OSError, OverflowError) as error:
            why = error.strerror if isinstance(error, OSError) else str(error)
            raise InputError(f"{self._path}: cannot be read: {why}.") from error

    def _mark(self, consumed: int) -> str | None:
        """Return a digest of the text before a position; None if the file is shorter."""
        if self._file is None:
            return None
        begin = max(0, consumed - _MARK)
        with self._in_words():
            before = os.pread(self._file.fileno(), consumed - begin, begin)
        return hashlib.sha256(before).hexdigest() if len(before) == consumed - begin else None

    def _replaced(self) -> bool:
        """Return whether the path is another file now, or this file was truncated."""
        assert self._file is not None
        with self._in_words():
            opened = os.fstat(self._file.fileno())
            try:
                named = self._path.stat()
            except FileNotFoundError:
                return False
        return (named.st_dev, named.st_ino) != (opened.st_dev, opened.st_ino) or opened.st_size < self._file.tell()

    def _begin_other(self) -> Iterator[Event]:
        tail = self._cutter.tail()
        if tail is not None:
            yield Arrived(self.origin, tail)
        yield Left(self.origin, f"{self._path} was replaced or truncated")
        self._close()
        self._cutter = LineCutter()
        self._at_end = False

    def _close(self) -> None:
        if self._file is not None:
            self._file.close()
            self._file = None


def _is_file(fd: int) -> bool:
    try:
        return stat.S_ISREG(os.fstat(fd).st_mode)
    except OSError:
        return False  # a closed descriptor: reading from it will raise the error
