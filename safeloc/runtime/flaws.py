"""Flaws across elements of a file: each with the places of the elements that it concerns, so that a reader can name their lines."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

Place = tuple[str | int, ...]
"""Keys and numbers that lead to a value of the file, such as ("edges", 3, "length_mm")."""

_MOST = 10


class Flaw(NamedTuple):
    """A flaw: what is wrong, and the places that it concerns; the first is where it is to be mended."""

    text: str
    places: Sequence[Place] = ((),)


class FlawsError(ValueError):
    """Flaws of one file. As text it tells them without places; `told` puts the places before them."""

    def __init__(self, flaws: Sequence[Flaw]) -> None:
        self._flaws = flaws
        super().__init__(_joined([flaw.text for flaw in flaws[:_MOST]], len(flaws)))

    def told(self, where: Callable[[Place], str]) -> str:
        """Return the flaws with their places; `where` turns a place into words. A place that was just named is not repeated."""
        told, before = [], ""
        for flaw in self._flaws[:_MOST]:
            here = where(flaw.places[0])
            every = list(dict.fromkeys(where(place) for place in flaw.places[:_MOST]))
            listed = f" ({', '.join(every)})" if len(every) > 1 else ""
            told.append(f"{'' if here == before else f'{here}: '}{flaw.text}{listed}")
            before = here
        return _joined(told, len(self._flaws))


def _joined(told: Sequence[str], count: int) -> str:
    more = f"; and {count - len(told)} more" if count > len(told) else ""
    return f"{'; '.join(told)}{more}"
