"""The log: one JSON object a line, for people and machines. It never holds the process up."""

from __future__ import annotations

import json
import os
import select
import time
from datetime import UTC, datetime

MOST_A_SECOND = 20
"""Lines of one event; further ones of that second are counted."""

SHORTER = (1_000, 200, 40)
"""Characters that are left of each text of an event that is too long for one line, tried in turn."""


class Journal:
    """Writes to a file descriptor; a reader that does not read costs lines of the log, and they are counted."""

    def __init__(self, fd: int) -> None:
        self._fd = fd
        self._second = 0
        self._written: dict[str, int] = {}
        self._left_out = 0

    def info(self, event: str, **fields: object) -> None:
        """Something that happens in a good run too."""
        self._log("info", event, fields)

    def warning(self, event: str, **fields: object) -> None:
        """Something that was survived."""
        self._log("warning", event, fields)

    def error(self, event: str, **fields: object) -> None:
        """Something that ended the process, or keeps it from restarting as it was."""
        self._log("error", event, fields)

    def _log(self, level: str, event: str, fields: dict[str, object]) -> None:
        if self._too_many(event):
            self._left_out += 1
            return
        left_out = {"left_out": self._left_out} if self._left_out else {}
        now = datetime.now(UTC).isoformat(timespec="milliseconds")
        head = {"time": now, "level": level, "event": event}
        if self._written_out(_fitting(head, {**fields, **left_out})):
            self._left_out = 0
        else:
            self._left_out += 1

    def _too_many(self, event: str) -> bool:
        second = int(time.monotonic())
        if second != self._second:
            self._second, self._written = second, {}
        self._written[event] = self._written.get(event, 0) + 1
        return self._written[event] > MOST_A_SECOND

    def _written_out(self, line: bytes) -> bool:
        """A pipe that has room takes PIPE_BUF bytes without waiting."""
        poll = select.poll()
        poll.register(self._fd, select.POLLOUT)
        try:
            if poll.poll(0):
                os.write(self._fd, line)
                return True
        except OSError:
            pass  # nobody reads the log any more, and there is nowhere else to say so
        return False


def _fitting(head: dict[str, str], fields: dict[str, object]) -> bytes:
    """One line of at most PIPE_BUF bytes; where something was left out, it says `shortened`."""
    line = _line({**head, **fields})
    for length in SHORTER:
        if len(line) <= select.PIPE_BUF:
            return line
        short = {name: _shortened(value, length) for name, value in fields.items()}
        line = _line({**head, **short, "shortened": True})
    return line if len(line) <= select.PIPE_BUF else _line({**head, "shortened": True})


def _shortened(value: object, length: int) -> object:
    return value if isinstance(value, int | float | None) else str(value)[:length]


def _line(fields: dict[str, object]) -> bytes:
    return json.dumps(fields, default=str).encode() + b"\n"
