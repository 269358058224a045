"""The state of each channel along a run, such as those of a receiver: one strip per channel."""

from __future__ import annotations

from collections.abc import Sequence

from safeloc.railway.pictures import Standings
from safeloc.report.drawing import across, across_axis, legend, picture
from safeloc.report.strips import TALL, strip, strip_legend
from safeloc.report.told import Series, Told
from safeloc.report.violations import head, violations

APART = TALL + 8


def standings_picture(one: Standings, told: Told) -> str:
    """Return the drawing; empty for a run without any known place."""
    places = _places(one, told)
    known = [place for place in places if place is not None]
    if not known:
        return ""
    axis, top = across(known), head(told)
    words = {row: told.words(row.signal) for row in one.rows}
    made, members = [], told.members(one.rows[0].signal)
    for number, row in enumerate(one.rows):
        made.append(strip(axis, places, words[row], members, top + APART * number, _label(told, row.called, one)))
    bottom = top + APART * len(one.rows)
    made.append(across_axis(axis, bottom + 4, "distance along the line in m"))
    made.append(violations(told, places, axis, bottom))
    said = [name for row in one.rows for name in words[row]]
    drawn, y = legend(strip_legend(said, members), bottom + 62)
    return picture([*made, drawn], y, f"{one.title}, recording {told.name}")


def _places(one: Standings, told: Told) -> Series:
    """The truth; without it what is reported, with gaps while nothing is."""
    truth = told.truth(one.reported.truth)
    reported = [one.reported.interval_mm(step.outputs) for step in told.trace.steps]
    positions = [step.outputs[one.reported.position] for step in told.trace.steps]
    pairs = zip(truth, reported, positions, strict=True)
    return [place if place is not None or ends is None else float(at) for place, ends, at in pairs]


def _label(told: Told, signal: str, one: Standings) -> str:
    """The names of what the part was, in order; of more than two the first and how many more."""
    numbers = dict.fromkeys(int(value) for value in told.series(signal) if value)
    names = [one.names(number) for number in numbers]
    return _short(names)


def _short(names: Sequence[str]) -> str:
    return ", ".join(names) if len(names) <= 2 else f"{names[0]} and {len(names) - 1} more"
