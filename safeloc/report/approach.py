"""Speed over distance to a stop point, with orders, stop window, overrun and repositioning, as in source 001, fig. 2."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import groupby
from typing import NamedTuple

from safeloc.railway.pictures import Approach
from safeloc.report.drawing import (
    BLUE,
    GREEN,
    GREY,
    LEFT,
    RED,
    RIGHT,
    Axis,
    Swatch,
    across,
    across_axis,
    box,
    box_swatch,
    legend,
    line,
    metres,
    number,
    picture,
    stroke_swatch,
    upright,
    upright_axis,
    word,
)
from safeloc.report.recorded_run import RecordedRun, Series
from safeloc.report.strips import TALL, colour_of, strip, strip_legend
from safeloc.report.thinning import Point, pieces
from safeloc.report.violations import head, violations

_WHOLE, NEAR, BETWEEN = 230, 170, 84
_MM_S_PER_KM_H = 1e6 / 3_600
_FAR_OFF_MM = 50_000
"""A vehicle that stands farther away does not stand at this stop point."""
_DASHES = ("8 2 2 2", "2 3", "", "9 3", "5 2 1 2", "1 2")


class _Stop(NamedTuple):
    """A stop point and its window, mm along the line."""

    number: int
    words: str
    at: float
    begins: float
    ends: float


@dataclass(frozen=True)
class _Drive:
    """A run as positions (mm), speeds and orders."""

    one: Approach
    recorded: RecordedRun
    places: Series

    @cached_property
    def speeds(self) -> list[float]:
        """Measured speed, mm/s."""
        return [float(given[self.one.speed]) for given in self.recorded.given]

    @cached_property
    def orders(self) -> list[str]:
        """The order of the machine after each step."""
        return self.recorded.words(self.one.order)

    @cached_property
    def stops(self) -> list[_Stop]:
        """The stop points of the platform, with the last values in the run."""
        found = []
        for signals in self.one.stops:
            known = [given for given in self.recorded.given if signals.at in given]
            if known:
                at, before, after = (float(known[-1][name]) for name in (signals.at, signals.before, signals.after))
                name = signals.called.get(self.recorded.name, str(signals.number))
                found.append(_Stop(signals.number, f"stop point {name}", at, at - before, at + after))
        return found

    @cached_property
    def selected(self) -> _Stop | None:
        """The stop point that was selected last."""
        numbers = [given[self.one.selected] for given in self.recorded.given if self.one.selected in given]
        return next((stop for stop in self.stops if numbers and stop.number == numbers[-1]), None)

    @property
    def ordered(self) -> list[tuple[int, float]]:
        """Steps (from 0) and positions while a stop is pending; only these can be an overrun."""
        steps = enumerate(zip(self.places, self.orders, strict=True))
        return [(step, place) for step, (place, order) in steps if place is not None and order != self.one.idle]

    def points(self, axis: Axis, height: Axis) -> list[Point | None]:
        """Return places and speeds on the page."""
        return [None if place is None else Point(axis.at(place), height.at(speed / _MM_S_PER_KM_H))
                for place, speed in zip(self.places, self.speeds, strict=True)]  # fmt: skip


def _drive_of(one: Approach, recorded: RecordedRun) -> _Drive:
    """Return the run, each step at its true position, or at the reported one if the truth is unknown."""
    pairs = zip(recorded.truth(one.truth), recorded.given, strict=True)
    places = [given[one.position] if truth is None and given[one.valid] else truth for truth, given in pairs]
    return _Drive(one, recorded, places)


def approach_picture(one: Approach, recorded: RecordedRun) -> str:
    """Return the drawing; empty for a run without any position."""
    drive = _drive_of(one, recorded)
    places = [place for place in drive.places if place is not None]
    if not places:
        return ""
    axis = across([*places, *(stop.ends for stop in drive.stops)])
    fastest, slowest = max(drive.speeds) / _MM_S_PER_KM_H, min(drive.speeds) / _MM_S_PER_KM_H
    room = max(fastest - slowest, 1.0)
    height = Axis(slowest - 0.06 * room, fastest + 0.12 * room, head(recorded) + _WHOLE, head(recorded))
    made = [upright_axis(height, "speed in km/h", unit=1)]
    made.append(across_axis(axis, height.begin, "distance along the line in m"))
    made += [_windows(drive, axis, height), _due(drive, axis, height), _curve(drive, axis, height)]
    made += [_brake_order(drive, axis, height), violations(recorded, drive.places, axis, height.begin)]
    y = height.begin
    if drive.selected is not None and drive.ordered:
        made += _near(drive, drive.selected, y + BETWEEN)
        y += BETWEEN + NEAR
    y += 56
    made.append(_over_time(drive, y))
    y += 2 * TALL + 66
    for label, keys in (("mode", _mode_keys(drive)), ("order", _order_keys(drive)), ("", _keys(drive))):
        text, y = legend(keys, y, label)
        made.append(text)
    return picture(made, y, f"{one.title}, recording {recorded.name}")


def _curve(drive: _Drive, axis: Axis, height: Axis) -> str:
    """Draw the run, each stretch in the colour and dashes of its order, joined to the stretch before."""
    members, points = drive.recorded.members(drive.one.order), drive.points(axis, height)
    made, at = "", 0
    for order, group in groupby(drive.orders):
        end = at + len(list(group))
        stretch = points[max(at - 1, 0) : end]
        kind = f"run {order}"
        made += line(pieces(stretch), colour_of(members, order), kind=kind, width=2.6, dash=_dashes(members, order))
        at = end
    return made


def _dashes(members: Sequence[str], order: str) -> str:
    return _DASHES[members.index(order) % len(_DASHES)]


def _windows(drive: _Drive, axis: Axis, height: Axis) -> str:
    made = ""
    for stop in drive.stops:
        begin, end = axis.at(stop.begins), axis.at(stop.ends)
        made += box(begin, height.end, end - begin, height.begin - height.end, GREEN, kind="window", faint=True)
        made += upright(axis.at(stop.at), height.end, height.begin, GREEN, kind="stop", dash="")
        near = axis.at(stop.at) > (LEFT + RIGHT) / 2
        chosen = " (selected)" if stop is drive.selected else ""
        made += word(axis.at(stop.at) + (-5 if near else 5), height.end + 14 + 15 * (stop.number % 2),
                     f"{stop.words}{chosen}", anchor="end" if near else "start")  # fmt: skip
    return made


def _due(drive: _Drive, axis: Axis, height: Axis) -> str:
    """Draw, for each stop point, the speed at which braking is due over the position."""
    made = ""
    for stop in drive.stops:
        places = [axis.low + (axis.high - axis.low) * share / 400 for share in range(401)]
        known = [(place, due_mm_s(drive.one, stop.at - place)) for place in places if place <= stop.at]
        run = [Point(axis.at(place), height.at(speed / _MM_S_PER_KM_H)) for place, speed in known
               if 0 <= speed <= height.high * _MM_S_PER_KM_H]  # fmt: skip
        made += line([run], GREY, kind="due", width=1.6, dash="6 4")
    return made


def due_mm_s(one: Approach, to_go_mm: float) -> float:
    """Return the measured speed at which braking is due: with reaction time and speed error, the vehicle then just stops there."""
    brake, reaction_s = one.brake_mm_s2, one.reaction_ms / 1_000
    delay = brake * reaction_s
    return math.sqrt(delay * delay + 2 * brake * max(to_go_mm, 0.0)) - delay - one.speed_error_mm_s


def _brake_order(drive: _Drive, axis: Axis, height: Axis) -> str:
    """Draw the first brake order, with position and speed."""
    points = drive.points(axis, height)
    step = next((n for n, order in enumerate(drive.orders) if order == drive.one.braking), None)
    place = None if step is None else drive.places[step]
    if step is None or place is None:
        return ""
    point = points[step]
    assert point is not None  # a place is known
    stop = drive.selected
    left = "" if stop is None else f", {metres(stop.at - place, 1)} before {stop.words}"
    speed = f"{drive.speeds[step] / _MM_S_PER_KM_H:.0f} km/h"
    text = f"brake order at {metres(place, 1)}, {speed}{left}"
    below = height.begin - 0.3 * (height.begin - height.end)
    mark = f'<circle cx="{point.x:.1f}" cy="{point.y:.1f}" r="5" fill="none" stroke="{RED}" stroke-width="2" class="brake-order"/>'
    leader = upright(point.x, point.y + 5, below - 14, RED, kind="leader", dash="2 2")
    return mark + leader + word(max(point.x, LEFT + 170), below, text, anchor="middle")


# ------------------------------------------------------------------ the last metres


def _near(drive: _Drive, stop: _Stop, top: float) -> Iterator[str]:
    """Draw the surroundings of the selected stop point enlarged, with the interval that is reported at the end."""
    reach = _reach(drive, stop)
    axis = Axis(-reach, reach, LEFT, RIGHT)
    shifted = [None if place is None or abs(place - stop.at) > reach else place - stop.at for place in drive.places]
    speeds = [speed / _MM_S_PER_KM_H for place, speed in zip(shifted, drive.speeds, strict=True) if place is not None]
    if not speeds:
        return
    room = max(max(speeds) - min(speeds), 1.0)
    height = Axis(min(0.0, *speeds) - 0.3 * room, max(speeds) + 0.15 * room, top + NEAR, top)
    yield upright_axis(height, "speed in km/h", unit=1)
    yield across_axis(axis, height.begin, f"distance from {stop.words} in m; speed backwards is negative")
    begin, end = axis.at(stop.begins - stop.at), axis.at(stop.ends - stop.at)
    yield box(begin, height.end, end - begin, height.begin - height.end, GREEN, kind="near-window", faint=True)
    yield word((begin + end) / 2, height.end - 6, "stop window", anchor="middle")
    yield upright(axis.at(0), height.end, height.begin, GREEN, kind="near-stop", dash="")
    zero = height.at(0)
    yield f'<path d="M{LEFT} {zero:.1f}H{RIGHT}" class="ink" stroke-width=".8"/>'
    yield _reduced(drive, height)
    yield _curve(replace(drive, places=shifted), axis, height)
    yield _furthest(drive, stop, axis, height)
    yield _standing(drive, stop, axis, height)


def _reach(drive: _Drive, stop: _Stop) -> float:
    beyond = max((place - stop.at for _, place in drive.ordered), default=0.0)
    widest = max(stop.ends - stop.at, stop.at - stop.begins, 1_000.0)
    stood = [stop.at - place for step, place in drive.ordered if drive.speeds[step] == 0]
    short = max((away for away in stood if away < _FAR_OFF_MM), default=0.0)
    return max(4 * widest, 1.4 * beyond, 1.4 * short)


def _reduced(drive: _Drive, height: Axis) -> str:
    """Draw the reduced speed for moving within the platform, in both directions."""
    made, speed = "", drive.one.reduced_speed_mm_s / _MM_S_PER_KM_H
    for value in (speed, -speed):
        if height.holds(value):
            y = height.at(value)
            made += f'<path d="M{LEFT} {y:.1f}H{RIGHT}" stroke="{RED}" stroke-dasharray="9 4" class="reduced"/>'
    return made


def _furthest(drive: _Drive, stop: _Stop, axis: Axis, height: Axis) -> str:
    """Draw the distance by which the vehicle overran the stop window, if it did."""
    furthest = max((place for _, place in drive.ordered), default=stop.at)
    if furthest <= stop.ends:
        return ""
    x, zero = axis.at(furthest - stop.at), height.at(0)
    text = f"overrun: {metres(furthest - stop.ends, 2)} beyond the window"
    mark = f'<circle cx="{x:.1f}" cy="{zero:.1f}" r="5" fill="none" stroke="{RED}" stroke-width="2" class="overrun"/>'
    leader = upright(x, height.end + 22, zero - 5, RED, kind="leader", dash="2 2")
    return mark + leader + word(x, height.end + 17, text, anchor="end" if x > RIGHT - 200 else "start")


def _standing(drive: _Drive, stop: _Stop, axis: Axis, height: Axis) -> str:
    """Draw the interval that is reported at the end of the pending stop, at speed zero."""
    last, names = drive.recorded.given[drive.ordered[-1][0]], (drive.one.position, drive.one.below, drive.one.above)
    position, below, above = (float(last[name]) for name in names)
    if not last[drive.one.valid] or not axis.holds(position - stop.at):
        return ""
    zero = height.at(0)
    low, high = (min(max(axis.at(end - stop.at), LEFT), RIGHT) for end in (position - below, position + above))
    ends = f"{metres(position - below - stop.at, 2)} to {metres(position + above - stop.at, 2)}"
    bar = (
        f'<path d="M{low:.1f} {zero - 7:.1f}v14M{high:.1f} {zero - 7:.1f}v14M{low:.1f} {zero:.1f}H{high:.1f}" '
        f'stroke="{BLUE}" stroke-width="3" class="standing"/>'
    )
    return bar + word((low + high) / 2, height.begin - 6, f"reported interval at the end: {ends}", anchor="middle")


# ------------------------------------------------------------------ over time


def _over_time(drive: _Drive, y: float) -> str:
    """Draw modes and orders over time, since positions repeat when the vehicle moves back."""
    seconds = [step * drive.one.period_ms / 1_000 for step in range(1, len(drive.orders) + 1)]
    axis = across([0.0, *seconds])
    axis = Axis(0.0, seconds[-1] * 1.01, axis.begin, axis.end)
    recorded, one = drive.recorded, drive.one
    modes = strip(axis, seconds, recorded.words(one.mode), recorded.members(one.mode), y, "mode")
    orders = strip(axis, seconds, drive.orders, recorded.members(one.order), y + TALL + 4, "order")
    return modes + orders + across_axis(axis, y + 2 * TALL + 12, "time in s", unit=1)


def _order_keys(drive: _Drive) -> list[Swatch]:
    """Return the legend of orders: colour and dashes of the curve."""
    members = drive.recorded.members(drive.one.order)
    return [
        stroke_swatch(colour_of(members, order), f"{number} {order}", _dashes(members, order), 2.6)
        for number, order in enumerate(members, 1)
        if order in set(drive.orders)
    ]


def _keys(drive: _Drive) -> list[Swatch]:
    reduced = number(round(drive.one.reduced_speed_mm_s / _MM_S_PER_KM_H, 1))
    return [
        stroke_swatch(GREY, "speed at which braking is due, with reaction time", "6 4"),
        box_swatch(GREEN, "stop window", faint=True),
        stroke_swatch(RED, f"reduced speed, {reduced} km/h", "9 4", 1),
    ]


def _mode_keys(drive: _Drive) -> list[Swatch]:
    return strip_legend(drive.recorded.words(drive.one.mode), drive.recorded.members(drive.one.mode))
