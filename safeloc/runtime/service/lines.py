"""Received bytes, cut into lines. A line that is too long is reported and not stored, so that memory stays bounded."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

LONGEST_LINE = 65_536
"""Most bytes of a line; a record takes about a hundred."""


class Line(NamedTuple):
    """One line without its end.

    flaw   the reason why it cannot be read (`text` is then empty); "" if it can
    cut    its sender disconnected before the end of the line
    """

    number: int
    text: bytes
    flaw: str = ""
    cut: bool = False


class LineCutter:
    """A cutter of one stream into lines.

    number    number of lines so far
    consumed  bytes of all complete lines so far, with their ends: the position of the next line
    """

    def __init__(self, number: int = 0, consumed: int = 0) -> None:
        self.number, self.consumed = number, consumed
        self._rest = bytearray()
        self._skipped = 0

    def feed(self, data: bytes) -> Iterator[Line]:
        """Yield the lines that are complete with these data. Take all of them before the next call."""
        *ended, rest = data.split(b"\n")
        for part in ended:
            if self._rest:
                part = bytes(self._rest) + part
                self._rest.clear()
            yield self._line(part, 1)
        self._keep(rest)

    def tail(self) -> Line | None:
        """Return the text after the last line end, at the end of the input; None if there is none."""
        if not self._rest and not self._skipped:
            return None
        raw = bytes(self._rest)
        self._rest.clear()
        return self._line(raw, 0)

    def _line(self, raw: bytes, end: int) -> Line:
        self.number += 1
        self.consumed += self._skipped + len(raw) + end
        long = self._skipped + len(raw) > LONGEST_LINE
        self._skipped = 0
        if long:
            return Line(self.number, b"", f"longer than {LONGEST_LINE} bytes")
        return Line(self.number, raw)

    def _keep(self, rest: bytes) -> None:
        self._rest += rest
        if len(self._rest) > LONGEST_LINE:
            self._skipped += len(self._rest)
            self._rest.clear()
