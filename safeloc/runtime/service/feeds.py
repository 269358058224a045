"""Sources of lines: standard input, and a growing file."""

from __future__ import annotations

import hashlib
import os
import selectors
import stat
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from io import FileIO
from pathlib import Path
from typing import Any, NamedTuple

from safeloc.errors import InputError
from safeloc.runtime.service.kept import KeptPlace, kept_as
from safeloc.runtime.service.lines import Line, LineCutter

AT_ONCE = 16_384
"""Bytes read before others have their turn: some thousand lines at the most."""

AGAIN_S = 0.01
"""How soon a file that has ended is looked at again."""

MARK = 4_096
"""Bytes before a position that identify the file."""


class Arrived(NamedTuple):
    """A line. `vehicle`: the only one its sender may speak of; None: any."""

    origin: str
    line: Line
    vehicle: str | None = None


@dataclass(frozen=True)
class Left:
    """A peer went away, or what came from it is no longer the same."""

    origin: str
    why: str


@dataclass(frozen=True)
class Over:
    """Nothing more will come."""


Event = Arrived | Left | Over
Ready = Callable[[int], Iterator[Event]]
"""What a selector's key carries: mask -> what came."""


class Feed(ABC):
    """whole: the first line is the first there was. replays: after a restart, the same lines can be read again."""

    whole = False
    replays = False

    @abstractmethod
    def open(self, selector: selectors.BaseSelector) -> None:
        """Begin; InputError where that cannot be done."""

    @abstractmethod
    def hold(self, held: bool) -> None:
        """Stop reading, or go on: the sender is to wait."""

    def look(self) -> Iterator[Event]:
        """Return the events that a selector does not report."""
        yield from ()

    @property
    def again_s(self) -> float | None:
        """Return the time until the next `look`; None if none is needed."""
        return None

    @property
    def live(self) -> bool:
        """True if silence counts: a vehicle without lines now is silent, and not only later in the file being read."""
        return True

    def position(self) -> Mapping[str, Any]:
        """Return the position of the next line, for a snapshot."""
        return {}

    def go_on(self, position: Mapping[str, Any]) -> str:
        """Before `open`: go on there. Why lines may be missing since, "" if none can be."""
        del position
        return "the process was not running"

    @abstractmethod
    def close(self) -> None:
        """No more reading."""


class Stdin(Feed):
    """A descriptor that is read to its end."""

    whole = True
    ORIGIN = "stdin"

    def __init__(self, fd: int = 0) -> None:
        self._fd = fd
        self._cutter = LineCutter()
        self._selector: selectors.BaseSelector | None = None
        self._reading = False
        self._is_file = _is_file(fd)

    @property
    def live(self) -> bool:
        """Not of a file that is redirected here."""
        return not self._is_file

    def open(self, selector: selectors.BaseSelector) -> None:
        """Begin."""
        self._selector = selector
        self.hold(False)

    def hold(self, held: bool) -> None:
        """A pipe that is not read fills, and its writer waits."""
        if self._selector is None or self._reading is not held:
            return
        self._reading = not held
        if held:
            self._selector.unregister(self._fd)
        else:
            self._selector.register(self._fd, selectors.EVENT_READ, self._ready)

    def _ready(self, _mask: int) -> Iterator[Event]:
        try:
            data = os.read(self._fd, AT_ONCE)
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
        """The descriptor is the caller's."""
        self.hold(True)


class GrowingFile(Feed):
    """A file that another process writes to. It may be there later, be cut, or be replaced by another one.

    to_its_end   do not wait for more
    """

    whole = True
    replays = True

    def __init__(self, path: Path, *, to_its_end: bool) -> None:
        self.origin = str(path)
        self._path, self._to_its_end = path, to_its_end
        self._cutter = LineCutter()
        self._file: FileIO | None = None
        self._held = self._at_end = self._over = False

    def open(self, selector: selectors.BaseSelector) -> None:
        """Begin; a file that is not there yet is waited for."""
        del selector
        if self._file is None:
            self._open(0)
        if self._file is None and self._to_its_end:
            raise InputError(f"{self._path}: no such file.")

    def hold(self, held: bool) -> None:
        """The file keeps what is not read."""
        self._held = held

    @property
    def again_s(self) -> float | None:
        """At once while there is more."""
        if self._held or self._over:
            return None
        return AGAIN_S if self._at_end else 0.0

    @property
    def live(self) -> bool:
        """Only while more is waited for: before, lines are read as fast as can be, whenever they were said."""
        return self._at_end and not self._to_its_end

    def look(self) -> Iterator[Event]:
        """Return the next part of the file; InputError where it cannot be read."""
        if self._held or self._over or not self._opened():
            return
        assert self._file is not None
        with self._in_words():
            data = self._file.read(AT_ONCE)
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
        """Return the start of the next complete line, and a mark of the text before it."""
        consumed = self._cutter.consumed
        return {"file": self.origin, "consumed": consumed, "line": self._cutter.number, "mark": self._mark(consumed)}

    def go_on(self, position: Mapping[str, Any]) -> str:
        """Go on behind the last line that was used, if it still stands there."""
        if position.get("file") != self.origin:
            return f"lines came from elsewhere before, {position.get('file', 'no file')}"
        place = kept_as(KeptPlace, position)
        self._open(place.consumed)
        if self._mark(place.consumed) != place.mark:
            self._close()
            return f"{self._path} is another file than before"
        self._cutter = LineCutter(place.line, place.consumed)
        return ""

    def close(self) -> None:
        """No more reading."""
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
        """A digest of what stands before a position; None where the file does not reach there."""
        if self._file is None:
            return None
        begin = max(0, consumed - MARK)
        with self._in_words():
            before = os.pread(self._file.fileno(), consumed - begin, begin)
        return hashlib.sha256(before).hexdigest() if len(before) == consumed - begin else None

    def _replaced(self) -> bool:
        """Return whether the name means another file now, or this one was truncated."""
        assert self._file is not None
        with self._in_words():
            own = os.fstat(self._file.fileno())
            try:
                named = self._path.stat()
            except FileNotFoundError:
                return False
        return (named.st_dev, named.st_ino) != (own.st_dev, own.st_ino) or own.st_size < self._file.tell()

    def _begin_other(self) -> Iterator[Event]:
        tail = self._cutter.tail()
        if tail is not None:
            yield Arrived(self.origin, tail)
        yield Left(self.origin, f"{self._path} was replaced or cut")
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
        return False  # a descriptor that is closed: reading from it will say so
