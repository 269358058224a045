"""A strip along an axis, coloured by the value of a signal, with the value's name or number in each piece."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import NamedTuple

from safeloc.report.drawing import DARK, LEFT, PALETTE, Axis, Swatch, box, box_swatch, wide, word
from safeloc.report.recorded_run import Series

TALL = 20


class _Piece(NamedTuple):
    """A stretch of constant value of a signal: start and end on the page, and the value in words."""

    begin: float
    end: float
    words: str


def strip(axis: Axis, places: Series, words: Sequence[str], members: Sequence[str], y: float, label: str) -> str:
    """Return the strip at `y`. `words` are the values at the places; `members` define their colours and numbers. Gaps stay
    empty."""
    made = [word(LEFT - 8, y + TALL - 6, label, anchor="end")]
    found = sorted(_thinned(_pieces(axis, places, words)), key=lambda piece: piece.begin - piece.end)
    for piece in found:
        colour = colour_of(members, piece.words)
        made.append(box(piece.begin, y, piece.end - piece.begin, TALL, colour, kind=f"piece {_class(piece.words)}"))
        made.append(_lettered(piece, members, y, colour))
    return "".join(made)


def colour_of(members: Sequence[str], name: str) -> str:
    """Return the colour of a member."""
    return PALETTE[list(members).index(name) % len(PALETTE)]


def strip_legend(words: Sequence[str], members: Sequence[str]) -> list[Swatch]:
    """Return the legend of the values that occur, with their numbers."""
    present = set(words)
    return [
        box_swatch(colour_of(members, name), f"{number} {name}")
        for number, name in enumerate(members, 1)
        if name in present
    ]


def _pieces(axis: Axis, places: Series, words: Sequence[str]) -> Iterator[_Piece]:
    """Yield the pieces; each reaches to the begin of the next one, unless there is a gap between."""
    known = [None if place is None else (axis.at(place), label) for place, label in zip(places, words, strict=True)]
    for gap, run in groupby(known, lambda one: one is None):
        stretch = [one for one in run if one is not None]
        if gap:
            continue
        at = 0
        for label, group in groupby(stretch, lambda one: one[1]):
            length = len(list(group))
            reached = [x for x, _ in stretch[at : at + length + 1]]
            yield _Piece(min(reached), max(reached), label)
            at += length


def _thinned(found: Iterator[_Piece]) -> list[_Piece]:
    """Return the pieces; of those narrower than a unit, one of each kind in each column."""
    kept: dict[tuple[object, ...], _Piece] = {}
    for piece in found:
        narrow = piece.end - piece.begin < 1
        kept.setdefault((round(piece.begin), piece.words) if narrow else piece, piece)
    return list(kept.values())


def _lettered(piece: _Piece, members: Sequence[str], y: float, colour: str) -> str:
    width, numbered = piece.end - piece.begin, str(list(members).index(piece.words) + 1)
    text = next((text for text in (piece.words, numbered) if wide(text) + 4 <= width), "")
    ink = "#fff" if colour in DARK else "#101418"
    middle = (piece.begin + piece.end) / 2
    return word(middle, y + TALL - 6, text, anchor="middle", style=f"fill:{ink}") if text else ""


def _class(words: str) -> str:
    return "".join(letter if letter.isalnum() else "-" for letter in words)
