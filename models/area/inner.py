"""Detection sections inside a line area: each says whether nobody is in it, and so how far any bound can really reach.

An inner section that is clear contains no part of any vehicle. So a bound that lies in it moves to its edge: a lower bound up, an upper
bound down. Vehicles that were never counted, and the ground behind a train, spread across an inner border only while the next section is not clear.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from safeloc.language.declared import Declared
from safeloc.language.expr import Bool, BoolVar, Num, NumVar, any_of, boolean, ite, number
from safeloc.language.machine import ANY
from safeloc.language.units import MM


@dataclass(frozen=True, eq=False)
class Inner:
    """One detection section inside the area: any two places, mm, and whether it is clear at the end of the cycle."""

    start: NumVar
    end: NumVar
    clear: BoolVar

    def holds(self, place: Num) -> Bool:
        """Return the condition that the section is clear, and the place is in it."""
        return self.clear & (self.start <= place) & (place <= self.end)

    def covers(self, start: Num, end: Num) -> Bool:
        """Return the condition that the section is clear, and the stretch is in it."""
        return self.clear & (self.start <= start) & (end <= self.end)


def raised(place: Num, inner: Sequence[Inner]) -> Num:
    """Return a lower bound of a vehicle's rear end, moved up to the end of a clear section in which it lies."""
    for one in inner:
        place = ite(one.holds(place), one.end, place)
    return place


def lowered(place: Num, inner: Sequence[Inner]) -> Num:
    """Return an upper bound of a vehicle's front end, moved down to the start of a clear section in which it lies."""
    for one in reversed(inner):
        place = ite(one.holds(place), one.start, place)
    return place


def covered(start: Num, end: Num, inner: Sequence[Inner]) -> Bool:
    """Return the condition that some clear section contains the stretch."""
    return any_of(one.covers(start, end) for one in inner)


def inner_sections(declared: Declared, count: int, limit: int) -> tuple[Inner, ...]:
    """Return fresh variables."""
    return tuple(
        Inner(
            declared.state(number(f"inner_{n}_from_mm", MM, -limit, limit), first=ANY),
            declared.state(number(f"inner_{n}_to_mm", MM, -limit, limit), first=ANY),
            declared.sensor(boolean(f"inner_{n}_clear")),
        )
        for n in range(1, count + 1)
    )
