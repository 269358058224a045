"""Marks of violated statements: a line across the panels, with the statement's name."""

from __future__ import annotations

from safeloc.report.drawing import LEFT, RED, RIGHT, Axis, upright, word
from safeloc.report.recorded_run import Broken, RecordedRun, Series

FIRST, ROW = 14, 15


def head(recorded: RecordedRun) -> float:
    """Return the top of the panels, below the names of violated statements."""
    return FIRST + ROW * len(recorded.broken) + 14


def violations(recorded: RecordedRun, places: Series, axis: Axis, bottom: float) -> str:
    """Draw a line from each name down to `bottom`; the names are listed at the top."""
    made, row = "", 0
    for broken in recorded.broken:
        place = _place_at(places, broken)
        if place is None or not axis.holds(place):
            continue
        x, y = axis.at(place), FIRST + ROW * row
        text = f"\N{MULTIPLICATION SIGN} violated at step {broken.step}: {broken.name}"
        right = x > (LEFT + RIGHT) / 2
        made += upright(x, y - 8, bottom, RED, kind="violated", dash="")
        made += word(x - 5 if right else x + 5, y, text, anchor="end" if right else "start", style="font-weight:700")
        row += 1
    return made


def _place_at(places: Series, broken: Broken) -> float | None:
    """Return the position at a step, or the last one known before."""
    known = [place for place in places[: broken.step] if place is not None]
    return known[-1] if known else None
