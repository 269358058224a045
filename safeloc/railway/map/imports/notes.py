"""The result of an importer: the line, and notes on everything in the file that was dropped or changed."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal, NamedTuple

from safeloc.railway.map.model import Line

Kind = Literal["refused", "not understood", "not carried over", "assumed", "rounded", "doubtful"]


@dataclass(frozen=True)
class Note:
    """One remark.

    kind   refused           an element whose data is wrong: it is left out of the map, and the text says why
           not understood    unknown to the importer
           not carried over  known, but the map has no place for it, or the file does not contain enough
           assumed           the map contains something that the file does not
           rounded           a length that is not a whole number of mm
           doubtful          the file contradicts itself; the text says which value was taken
    place  where in the file: element, identity, line
    """

    kind: Kind
    place: str
    text: str

    def __str__(self) -> str:
        return f"{self.place}: {self.kind}: {self.text}"


class Imported(NamedTuple):
    """A line and the notes on its import, in the order of the file."""

    line: Line
    notes: tuple[Note, ...]

    @property
    def refused(self) -> tuple[Note, ...]:
        """The elements that are left out because their data is wrong."""
        return tuple(note for note in self.notes if note.kind == "refused")


@dataclass(frozen=True)
class Similar:
    """Notes of one kind and text, reported together."""

    kind: Kind
    text: str
    places: tuple[str, ...]

    def __str__(self) -> str:
        shown = ", ".join(self.places[:3])
        more = f" and {len(self.places) - 3} more" if len(self.places) > 3 else ""
        return f"{self.kind}: {self.text} [{shown}{more}]"


def similar(notes: Iterable[Note]) -> list[Similar]:
    """Return the notes grouped by kind and text, in the order of the first of each."""
    places: dict[tuple[Kind, str], list[str]] = {}
    for note in notes:
        places.setdefault((note.kind, note.text), []).append(note.place)
    return [Similar(kind, text, tuple(found)) for (kind, text), found in places.items()]
