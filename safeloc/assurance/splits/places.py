"""The expressions of a machine whose evaluation led to a term."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from types import FrameType

from safeloc.assurance.source_places import DECLARING, Place, place_of, shown

_MOST_CHARACTERS = 60
_BESIDE = ("picture", "recordings", "scenes", "simulate", "simulation", "target")
"""Files and folders of a machine that declare nothing of it."""


def source_of(place: Place) -> str:
    """Return the source text of a place, cut if it is long."""
    return place.text if len(place.text) <= _MOST_CHARACTERS else f"{place.text[:_MOST_CHARACTERS]} ..."


def way_to(frame: FrameType | None) -> tuple[Place, ...]:
    """Return the expressions of machine, world and claims that are being evaluated, the innermost first."""
    found = []
    while frame is not None:
        if declares(frame.f_code.co_filename):
            found.append(place_of(frame.f_code, frame.f_lasti))
        frame = frame.f_back
    return tuple(found)


@cache
def declares(file: str) -> bool:
    """Return whether the code of a file belongs to a machine, a world or a claim, not to the engine."""
    path = Path(shown(file))
    return path.parts[0] in DECLARING and not any(part in _BESIDE for part in path.with_suffix("").parts)
