"""The state of each channel along a run, such as those of a receiver: one strip per channel."""

from __future__ import annotations

from collections.abc import Sequence

from safeloc.railway.pictures import Standings
from safeloc.report.drawing import across, across_axis, legend, picture
from safeloc.report.recorded_run import RecordedRun, Series
from safeloc.report.strips import TALL, strip, strip_legend
from safeloc.report.violations import head, violations

_APART = TALL + 8


def standings_picture(one: Standings, recorded: RecordedRun) -> str:
    """Return the drawing; empty for a run without any known position."""
    places = _places(one, recorded)
    known = [place for place in places if place is not None]
    if not known:
        return ""
    axis, top = across(known), head(recorded)
    words = {row: recorded.words(row.signal) for row in one.rows}
    made, members = [], recorded.members(one.rows[0].signal)
    for number, row in enumerate(one.rows):
        made.append(strip(axis, places, words[row], members, top + _APART * number, _label(recorded, row.called, one)))
    bottom = top + _APART * len(one.rows)
    made.append(across_axis(axis, bottom + 4, "distance along the line in m"))
    made.append(violations(recorded, places, axis, bottom))
    labels = [name for row in one.rows for name in words[row]]
    drawn, y = legend(strip_legend(labels, members), bottom + 62)
    return picture([*made, drawn], y, f"{one.title}, recording {recorded.name}")


def _places(one: Standings, recorded: RecordedRun) -> Series:
    """Return the true position of each step, or the reported one if the truth is unknown; None if there is neither."""
    truth = recorded.truth(one.reported.truth)
    reported = [one.reported.interval_mm(step.outputs) for step in recorded.trace.steps]
    positions = [step.outputs[one.reported.position] for step in recorded.trace.steps]
    pairs = zip(truth, reported, positions, strict=True)
    return [place if place is not None or ends is None else float(at) for place, ends, at in pairs]


def _label(recorded: RecordedRun, signal: str, one: Standings) -> str:
    """Return the names that a signal gives to the channel during the run; of more than two, the first and the number of others."""
    numbers = dict.fromkeys(int(value) for value in recorded.series(signal) if value)
    names = [one.names(number) for number in numbers]
    return _short(names)


def _short(names: Sequence[str]) -> str:
    return ", ".join(names) if len(names) <= 2 else f"{names[0]} and {len(names) - 1} more"
