"""The log: one JSON object per line, for people and programs. Writing it never delays the process."""

from __future__ import annotations

import json
import os
import select
import time
from datetime import UTC, datetime

MOST_A_SECOND = 20
"""Most lines of one event per second; further ones are only counted."""

_SHORTER = (1_000, 200, 40)
"""Lengths to which each text of an event is cut if the event is too long for one line, tried in turn."""


class Journal:
    """A log on a file descriptor. If its reader is too slow, lines are left out and counted. `common`: in every line."""

    def __init__(self, fd: int, **common: object) -> None:
        self._fd, self._common = fd, common
        self._second = 0
        self._written: dict[str, int] = {}
        self._left_out = 0

    def info(self, event: str, **fields: object) -> None:
        """Log an event of normal operation."""
        self._log("info", event, fields)

    def warning(self, event: str, **fields: object) -> None:
        """Log an event from which the process recovered."""
        self._log("warning", event, fields)

    def error(self, event: str, **fields: object) -> None:
        """Log an event that ends the process, or prevents it from restarting in its last state."""
        self._log("error", event, fields)

    def _log(self, level: str, event: str, fields: dict[str, object]) -> None:
        if self._too_many(event):
            self._left_out += 1
            return
        left_out = {"left_out": self._left_out} if self._left_out else {}
        now = datetime.now(UTC).isoformat(timespec="milliseconds")
        head = {"time": now, "level": level, "event": event}
        if self._written_out(_fitting(head, {**self._common, **fields, **left_out})):
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
        """Write a line if that needs no waiting; return whether it was written. A pipe with room takes PIPE_BUF bytes."""
        poll = select.poll()
        poll.register(self._fd, select.POLLOUT)
        try:
            if poll.poll(0):
                os.write(self._fd, line)
                return True
        except OSError:
            pass  # nobody reads the log any more, and there is no other place to report it
        return False


def _fitting(head: dict[str, str], fields: dict[str, object]) -> bytes:
    """Return one line of at most PIPE_BUF bytes; `shortened` is true in it if something was cut."""
    line = _line({**head, **fields})
    for length in _SHORTER:
        if len(line) <= select.PIPE_BUF:
            return line
        short = {name: _shortened(value, length) for name, value in fields.items()}
        line = _line({**head, **short, "shortened": True})
    return line if len(line) <= select.PIPE_BUF else _line({**head, "shortened": True})


def _shortened(value: object, length: int) -> object:
    return value if isinstance(value, int | float | None) else str(value)[:length]


def _line(fields: dict[str, object]) -> bytes:
    return json.dumps(fields, default=str).encode() + b"\n"
