"""What a real day does to a vehicle's lines now and then. None of it makes a measurement wrong that is believed."""

from __future__ import annotations

from collections.abc import Callable
from random import Random

Said = list[bytes]


def _lost(said: Said, chance: Random) -> None:
    del said[chance.randrange(len(said))]


def _cut(said: Said, chance: Random) -> None:
    at = chance.randrange(len(said))
    said[at] = said[at][: chance.randrange(1, len(said[at]) - 2)] + b"\n"


def _line_end_lost(said: Said, chance: Random) -> None:
    at = chance.randrange(len(said))
    said[at] = said[at].rstrip(b"\n")


def _garbage(said: Said, chance: Random) -> None:
    said.insert(chance.randrange(len(said) + 1), chance.randbytes(40).replace(b"\n", b"") + b"\n")


def _doubled(said: Said, chance: Random) -> None:
    at = chance.randrange(len(said))
    said.insert(at, said[at])


def _swapped(said: Said, chance: Random) -> None:
    at = chance.randrange(len(said))
    said[at - 1], said[at] = said[at], said[at - 1]


def _no_measurement(said: Said, chance: Random) -> None:
    at = chance.randrange(len(said))
    said[at] = said[at].replace(
        b'"distance_mm": ', chance.choice((b'"distance_mm": 1e', b'"distance_mm": "', b'"distance_mm": null'))
    )


def _ahead(said: Said, chance: Random) -> None:
    """One stamp is wrong; no marker's, for where a marker stands is measured from its time on."""
    at = chance.randrange(len(said))
    if b'"kind": "marker"' not in said[at]:
        said[at] = said[at].replace(b'"time_ms": ', b'"time_ms": 9', 1)


MISHAPS: dict[str, Callable[[Said, Random], None]] = {
    "line lost": _lost,
    "line cut": _cut,
    "line end lost": _line_end_lost,
    "garbage between lines": _garbage,
    "line doubled": _doubled,
    "lines swapped": _swapped,
    "no measurement": _no_measurement,
    "time far ahead": _ahead,
}
"""Each befalls the lines of one cycle."""

LINES_EVERY = 400
"""In one cycle of so many something befalls the lines."""

SILENCE, HANG_UP = "silence", "connection lost"
AWAY_EVERY = 1_500
"""Before one cycle of so many the vehicle falls silent, or its connection is lost."""

SILENCE_CYCLES = (2, 58)
"""Shorter than the longest gap, so that it adds to the error and the place goes on; longer ones are the pauses between trips."""


def befall(said: Said, chance: Random) -> str:
    """Change the lines of a cycle, now and then; the mishap's name, "" if there was none."""
    if chance.randrange(LINES_EVERY):
        return ""
    name = chance.choice(list(MISHAPS))
    MISHAPS[name](said, chance)
    return name


def away(chance: Random) -> tuple[str, int]:
    """What takes the vehicle away now and for how many cycles; "" mostly."""
    if chance.randrange(AWAY_EVERY):
        return "", 0
    name = chance.choice((SILENCE, HANG_UP))
    return name, chance.randint(*SILENCE_CYCLES) if name == SILENCE else chance.choice((0, 0, 1, 5, 30))
