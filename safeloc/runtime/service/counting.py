"""The sender's count of its lines, which reveals lost and repeated lines."""

from __future__ import annotations

from dataclasses import dataclass

AGREEING_LINES = 10
"""Lines out of step in a row that have to continue each other's numbers before they are accepted."""

_MOST_LOST = 1_000_000
"""Most lines that may be missing before a line. A number further ahead counts as wrong, not as a loss."""

_NEXT_WITHIN = 1_000
"""Largest step between two numbers that still continue each other."""


@dataclass(frozen=True)
class Counted:
    """The result for one line.

    refused   the reason why the line is not used; "" if it is used
    lost      what is missing before it; "" if nothing is
    """

    refused: str = ""
    lost: str = ""


_FINE = Counted()


class Agreement:
    """A row of lines out of step. A single one has a wrong number; if the sender counts differently, the lines agree.

    last    number of the last of them; None: they have no numbers
    lines   number of lines that agree so far
    """

    def __init__(self, last: int | None = None, lines: int = 0) -> None:
        self.last, self.lines = last, lines

    def end(self) -> None:
        """Record a line in step."""
        self.last, self.lines = None, 0

    def goes_on(self, number: int | None) -> bool:
        """Record one more line out of step; return whether enough of them agree to be accepted."""
        self.lines = self.lines + 1 if self.lines and self._follows(number) else 1
        self.last = number
        return self.lines >= AGREEING_LINES

    def _follows(self, number: int | None) -> bool:
        if number is None or self.last is None:
            return number is self.last
        return 0 < number - self.last <= _NEXT_WITHIN


class LineCount:
    """The line count of one vehicle.

    last     the number of its last line; None while lines have no numbers
    unsure   the reason why lines may have been lost since then; the next number decides it; "" without a reason
    agreed   lines that do not continue `last`, but continue each other
    """

    def __init__(self, last: int | None = None, unsure: str = "", agreed: Agreement | None = None) -> None:
        self.last, self.unsure, self.agreed = last, unsure, agreed or Agreement()

    def take(self, number: int | None) -> Counted:
        """Take the next line, with or without a number."""
        wrong = self._out_of_step(number)
        if not wrong:
            self.agreed.end()
            return self._in_step(number)
        if self.agreed.goes_on(number):
            self.agreed.end()
            self.last, self.unsure = number, ""
            return Counted(lost=f"its count was changed: {AGREEING_LINES} lines in a row agree")
        return Counted(wrong, "a line without a number" if number is None else "")

    def _out_of_step(self, number: int | None) -> str:
        last = self.last
        if last is None or number == 1:
            return ""
        if number is None:
            return f"no number, after {last}"
        if number <= last:
            return f"number {number} again" if number == last else f"number {number} after {last}"
        return f"number {number} after {last}: too far ahead for a loss" if number - last > _MOST_LOST else ""

    def _in_step(self, number: int | None) -> Counted:
        last, self.last = self.last, number
        unsure, self.unsure = self.unsure, ""
        if last is None:
            return _FINE if number == 1 else Counted(lost=unsure)
        assert number is not None
        if number == last + 1:
            return _FINE
        return Counted(
            lost="the sender's count restarted" if number == 1 else f"{number - last - 1} lines before {number}"
        )
