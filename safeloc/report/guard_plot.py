"""A guarded run over time: the interval along the way, and below it the deviation of fixes from its middle."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby

from safeloc.report.drawing import (
    BLUE,
    GREY,
    LEFT,
    RIGHT,
    Axis,
    Swatch,
    across_axis,
    band,
    box,
    box_swatch,
    legend,
    picture,
    stroke_swatch,
    upright_axis,
)
from safeloc.report.guard_words import PASSED, WORDS, mark
from safeloc.report.thinning import Span, spans

_Value = Callable[["Moment"], float | None]
_UPPER, LOWER, BETWEEN, TOP = 250, 230, 44, 40


@dataclass(frozen=True)
class Moment:
    """One delivery: ms since the first, the reason of its judgement, and fix and interval along the way in mm."""

    time_ms: int
    reason: str
    position_mm: int | None
    interval_mm: tuple[int, int] | None

    @property
    def middle(self) -> float | None:
        """The middle of the interval."""
        return None if self.interval_mm is None else sum(self.interval_mm) / 2

    @property
    def half(self) -> float:
        """Half the width of the interval; 0 without one."""
        return 0.0 if self.interval_mm is None else (self.interval_mm[1] - self.interval_mm[0]) / 2


def guard_plot(moments: Sequence[Moment], tolerance_mm: int, title: str) -> str:
    """Return the drawing; empty if no delivery has a time."""
    if not moments:
        return ""
    last = max(moment.time_ms for moment in moments)
    across = Axis(0, max(last, 1_000), LEFT, RIGHT)
    upper = _places(moments)
    top = upper.begin + BETWEEN
    near = Axis(-2.0 * tolerance_mm, 2.0 * tolerance_mm, top + LOWER, top)
    made = [upright_axis(upper, "along the way in m"), _silence(moments, across, upper)]
    made += [_run(moments, across, upper), _spots(moments, across, upper, lambda one: one.position_mm)]
    made += [upright_axis(near, "deviation in m"), _silence(moments, across, near)]
    made += [_bounds(near, tolerance_mm), _around(moments, across, near)]
    made += [_spots(moments, across, near, _beside_middle)]
    made.append(across_axis(across, near.begin + 8, "time in s"))
    keys, y = legend(_keys(moments), near.begin + 66)
    return picture([*made, keys], y, title)


def _places(moments: Sequence[Moment]) -> Axis:
    known = [float(one.position_mm) for one in moments if one.position_mm is not None]
    known += [end for one in moments if one.interval_mm is not None for end in one.interval_mm]
    low, high = min(known, default=0.0), max(known, default=1_000.0)
    room = (high - low) * 0.03 or 1_000.0
    return Axis(low - room, high + room, TOP + _UPPER, TOP)


def _run(moments: Sequence[Moment], across: Axis, upper: Axis) -> str:
    """Draw the known intervals."""
    there = [
        None if one.interval_mm is None
        else Span(across.at(one.time_ms), upper.at(one.interval_mm[0]), upper.at(one.interval_mm[1]))
        for one in moments
    ]  # fmt: skip
    return band(spans(there), BLUE, kind="interval")


def _around(moments: Sequence[Moment], across: Axis, near: Axis) -> str:
    """Draw the intervals around their middles."""
    there = [
        None if one.interval_mm is None else Span(across.at(one.time_ms), near.at(-one.half), near.at(one.half))
        for one in moments
    ]
    return band(spans(there), BLUE, kind="interval")


def _beside_middle(moment: Moment) -> float | None:
    if moment.position_mm is None or moment.middle is None:
        return None
    return moment.position_mm - moment.middle


def _bounds(near: Axis, tolerance_mm: int) -> str:
    """Draw the tolerable error."""
    return "".join(
        f'<path d="M{LEFT} {near.at(side * tolerance_mm):.1f}H{RIGHT}" class="ink" stroke-width="1" stroke-dasharray="5 4"/>'
        for side in (-1, 1)
    )


def _spots(moments: Sequence[Moment], across: Axis, height: Axis, value: _Value) -> str:
    """Draw the fixes, at most one per reason and unit of the page; one beyond the edge is drawn at the edge."""
    found: dict[tuple[int, int, str], str] = {}
    for one in sorted(moments, key=lambda each: each.reason != PASSED):
        at = value(one)
        if at is not None:
            x, y = across.at(one.time_ms), height.at(max(height.low, min(height.high, at)))
            found.setdefault((round(x), round(y), one.reason), mark(x, y, one.reason, 2.2))
    return "".join(found.values())


def _silence(moments: Sequence[Moment], across: Axis, height: Axis) -> str:
    """Draw the stretches without an interval."""
    made = []
    for silent, run in _stretches(moments):
        if silent:
            begin, end = across.at(run[0]), across.at(run[1])
            made.append(box(begin, height.end, end - begin, height.begin - height.end, GREY, kind="silent", faint=True))
    return "".join(made)


def _stretches(moments: Sequence[Moment]) -> Iterator[tuple[bool, tuple[int, int]]]:
    """Divide the run into stretches with and without a report; each ends where the next begins."""
    runs = [(silent, list(run)) for silent, run in groupby(moments, lambda one: one.interval_mm is None)]
    for number, (silent, run) in enumerate(runs):
        end = runs[number + 1][1][0].time_ms if number + 1 < len(runs) else run[-1].time_ms
        yield silent, (run[0].time_ms, end)


def _keys(moments: Sequence[Moment]) -> list[Swatch]:
    keys = [
        box_swatch(BLUE, "interval that contains the vehicle", faint=True),
        stroke_swatch("", "tolerable error", "5 4", 1),
    ]
    keys.append(box_swatch(GREY, "no interval is reported", faint=True))
    present = {moment.reason for moment in moments}
    keys += [Swatch(mark(13, 0, reason, 4), reason) for reason in WORDS if reason in present]
    return keys
