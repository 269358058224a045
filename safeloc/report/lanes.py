"""The modes of a run as coloured lanes over its steps, on the same scale as the line charts (safeloc.report.plot)."""

from __future__ import annotations

import html
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any

from safeloc.report.drawing import DARK, PALETTE, wide
from safeloc.report.plot import LEFT, WIDTH, StepScale, broken_at, line_of_text

_Data = Mapping[str, Any]
_TOP, _ROW, _BAR = 8, 22, 16
MOST_LANES = 6
"""Machines of a composition whose modes are drawn: those that change mode in the run, the first ones; how many more there are is said."""


@dataclass(frozen=True)
class Lane:
    """The mode of one machine in every step, by its number, and the names of the modes."""

    name: str
    modes: Sequence[int]
    labels: Sequence[str]

    @property
    def stretches(self) -> Iterator[tuple[int, int, int]]:
        """Yield (mode, first step, step after the last one) of each stretch in one mode."""
        first = 0
        for mode, steps in groupby(self.modes):
            after = first + len(list(steps))
            yield mode, first, after
            first = after


def mode_lanes(trace: _Data, signals: _Data) -> str:
    """Return a lane for each machine, with the last step marked as the one that breaks; nothing for a run without steps.

    Of a composition only machines that change mode have a lane, at most MOST_LANES.
    """
    every = _lanes(trace, signals)
    lanes, left_out = every[:MOST_LANES], len(every[MOST_LANES:])
    if not lanes or not trace["steps"]:
        return ""
    length = len(trace["steps"]) + 1
    scale, height = StepScale(length), _TOP + _ROW * len(lanes)
    rows = "".join(_row(lane, scale, _TOP + _ROW * number) for number, lane in enumerate(lanes))
    mark = broken_at(scale, length - 1, 0, height)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" role="img" aria-label="modes" class="chart">'
        f"{rows}{mark}</svg>" + (f"<p>{left_out} more machines change mode.</p>" if left_out else "")
    )


def _lanes(trace: _Data, signals: _Data) -> list[Lane]:
    names = [name for name in trace["first"] if name.split(".")[-1] == "mode" and signals.get(name, {}).get("members")]
    lanes = [
        Lane(name, [trace["first"][name], *(step["state"][name] for step in trace["steps"])], signals[name]["members"])
        for name in names
    ]
    return lanes if len(lanes) == 1 else [lane for lane in lanes if len(set(lane.modes)) > 1]


def _row(lane: Lane, scale: StepScale, top: float) -> str:
    name = line_of_text(4, top + 12, _short(lane.name, LEFT - 8))
    return name + "".join(_stretch(lane, scale, top, *stretch) for stretch in lane.stretches)


def _stretch(lane: Lane, scale: StepScale, top: float, mode: int, first: int, after: int) -> str:
    """Draw a stretch from its first step to the first one of the next; its name stands in it where there is room."""
    left, right = scale.x(first), scale.x(min(after, scale.length - 1))
    width = max(right - left, 2.0)
    colour, label = PALETTE[mode % len(PALETTE)], lane.labels[mode]
    tip = html.escape(f"{lane.name} = {label}, steps {first} to {after - 1}")
    bar = f'<rect x="{left:.1f}" y="{top}" width="{width:.1f}" height="{_BAR}" fill="{colour}"><title>{tip}</title></rect>'
    if wide(label) + 6 > width:
        return bar
    return bar + line_of_text(left + 3, top + 12, label, "#ffffff" if colour in DARK else "#000000")


def _short(text: str, room: float) -> str:
    while wide(text) > room and len(text) > 2:
        text = text[:-2] + "\N{HORIZONTAL ELLIPSIS}"
    return text
