"""Marks of violated statements: a line across the panels, with the name of the statement."""

from __future__ import annotations

from safeloc.report.drawing import LEFT, RED, RIGHT, Axis, upright, word
from safeloc.report.told import Broken, Series, Told

FIRST, ROW = 14, 15


def head(told: Told) -> float:
    """Return the top of a picture, below the names of violated statements."""
    return FIRST + ROW * len(told.broken) + 14


def violations(told: Told, places: Series, axis: Axis, bottom: float) -> str:
    """Return lines from the names down to `bottom`; the names stand one below the other at the head."""
    made, row = "", 0
    for broken in told.broken:
        place = place_at(places, broken)
        if place is None or not axis.holds(place):
            continue
        x, y = axis.at(place), FIRST + ROW * row
        text = f"\N{MULTIPLICATION SIGN} violated at step {broken.step}: {broken.name}"
        right = x > (LEFT + RIGHT) / 2
        made += upright(x, y - 8, bottom, RED, kind="violated", dash="")
        made += word(x - 5 if right else x + 5, y, text, anchor="end" if right else "start", style="font-weight:700")
        row += 1
    return made


def place_at(places: Series, broken: Broken) -> float | None:
    """Return the place at that step, or the last one known before."""
    known = [place for place in places[: broken.step] if place is not None]
    return known[-1] if known else None
