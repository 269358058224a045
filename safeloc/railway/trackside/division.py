"""Division of an area into virtual sections: no two overlap, and what belongs to none is named.

The machine is right for any places. But an operator who reads one section as clear and its overlapping neighbour as occupied, or
trusts that the sections are the whole area, would be misled by a slip of the pen.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

Stretch = tuple[int, int]


class _Piece(NamedTuple):
    """A stretch of the file: its key, its place in the list, and how messages call it."""

    key: str
    number: int
    name: str
    from_mm: int
    to_mm: int

    def __str__(self) -> str:
        return f"{self.name} [{self.from_mm}, {self.to_mm}]" if self.key else f"{self.name} {self.from_mm}"


class Flaw(NamedTuple):
    """A flaw of the division, the key of the file and the number in its list where it is to be mended."""

    key: str
    number: int
    why: str


def division_flaws(
    low_end_mm: int, high_end_mm: int, sections_mm: Sequence[Stretch], without_section_mm: Sequence[Stretch]
) -> Iterator[Flaw]:
    """Yield overlaps and gaps along the area; sections are called as the outputs of the machine call them, in any order."""
    pieces = [_Piece("sections_mm", n, f"section_{n + 1}", *one) for n, one in enumerate(sections_mm)]
    pieces += [
        _Piece("without_section_mm", n, f"without_section_mm.{n}", *one) for n, one in enumerate(without_section_mm)
    ]
    pieces.sort(key=lambda one: (one.from_mm, one.to_mm))
    reached = _Piece("", 0, "low_end_mm", low_end_mm, low_end_mm)
    for one in pieces:
        yield from _between(reached, one)
        reached = max(reached, one, key=lambda piece: piece.to_mm)
    yield from _between(reached, _Piece("", 0, "high_end_mm", high_end_mm, high_end_mm))


def _between(before: _Piece, after: _Piece) -> Iterator[Flaw]:
    mend = after if after.key else before
    if after.from_mm < before.to_mm:
        both = f"[{after.from_mm}, {min(before.to_mm, after.to_mm)}]"
        yield Flaw(
            mend.key, mend.number, f"{before} and {after} overlap in {both}; each place has one section at most."
        )
    if after.from_mm > before.to_mm:
        gap = f"[{before.to_mm}, {after.from_mm}]"
        yield Flaw(
            mend.key,
            mend.number,
            f"between {before} and {after}, {gap} belongs to no section; close the gap, or name it if it is meant: "
            f"without_section_mm = [{gap}].",
        )
