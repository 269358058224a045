"""The sender's count of its lines: what shows that one was lost, or came twice."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Counted:
    """refused: why the line is not used, "" if it is; lost: what is missing before it, "" if nothing is."""

    refused: str = ""
    lost: str = ""


FINE = Counted()


class LineCount:
    """Of one vehicle.

    last     the number of its last line; None while it does not count
    unsure   why lines may have been lost since then, to be settled by the next number; "" if nothing says so
    """

    def __init__(self, last: int | None = None, unsure: str = "") -> None:
        self.last, self.unsure = last, unsure

    def take(self, number: int | None) -> Counted:
        """The next line, with its number or without."""
        last = self.last
        if number is not None and last is not None and number <= last and number != 1:
            return Counted(f"number {number} again" if number == last else f"number {number} after {last}")
        unsure, self.unsure = self.unsure, ""
        if number is None:
            return (
                Counted(lost=unsure) if last is None else Counted(f"no number, after {last}", "a line without a number")
            )
        self.last = number
        if last is None:
            return FINE if number == 1 else Counted(lost=unsure)
        if number == last + 1:
            return FINE
        return Counted(lost="the sender counts anew" if number == 1 else f"{number - last - 1} lines before {number}")
