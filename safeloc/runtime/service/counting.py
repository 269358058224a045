"""The sender's count of its lines: what shows that one was lost, or came twice."""

from __future__ import annotations

from dataclasses import dataclass

AGREEING_LINES = 10
"""So many lines in a row that are out of step have to go on from each other before they are believed."""

MOST_LOST = 1_000_000
"""Lines that may be missing before one. A number further ahead is a wrong one, not a loss."""

NEXT_WITHIN = 1_000
"""How far a number may be from the one before it, for the two to go on from each other."""


@dataclass(frozen=True)
class Counted:
    """refused: why the line is not used, "" if it is; lost: what is missing before it, "" if nothing is."""

    refused: str = ""
    lost: str = ""


FINE = Counted()


class Agreement:
    """Lines out of step in a row. One wrong number is one line; a sender that counts otherwise goes on from there.

    last    number of the last of them; None: they have none
    lines   how many agree so far
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
        return 0 < number - self.last <= NEXT_WITHIN


class LineCount:
    """Of one vehicle.

    last     the number of its last line; None while it does not count
    unsure   why lines may have been lost since then, to be settled by the next number; "" if nothing says so
    agreed   lines that are out of step with `last`, and in step with each other
    """

    def __init__(self, last: int | None = None, unsure: str = "", agreed: Agreement | None = None) -> None:
        self.last, self.unsure, self.agreed = last, unsure, agreed or Agreement()

    def take(self, number: int | None) -> Counted:
        """Take the next line, with its number or without."""
        wrong = self._out_of_step(number)
        if not wrong:
            self.agreed.end()
            return self._in_step(number)
        if self.agreed.goes_on(number):
            self.agreed.end()
            self.last, self.unsure = number, ""
            return Counted(lost=f"its count was set: {AGREEING_LINES} lines in a row agree")
        return Counted(wrong, "a line without a number" if number is None else "")

    def _out_of_step(self, number: int | None) -> str:
        last = self.last
        if last is None or number == 1:
            return ""
        if number is None:
            return f"no number, after {last}"
        if number <= last:
            return f"number {number} again" if number == last else f"number {number} after {last}"
        return f"number {number} after {last}: too far ahead for a loss" if number - last > MOST_LOST else ""

    def _in_step(self, number: int | None) -> Counted:
        last, self.last = self.last, number
        unsure, self.unsure = self.unsure, ""
        if last is None:
            return FINE if number == 1 else Counted(lost=unsure)
        assert number is not None
        if number == last + 1:
            return FINE
        return Counted(lost="the sender counts anew" if number == 1 else f"{number - last - 1} lines before {number}")
