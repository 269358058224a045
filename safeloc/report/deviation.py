"""Deviation of the reported position over the distance run, as in source 001, fig. 1."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from safeloc.language.nodes import Value
from safeloc.railway.pictures import Deviation, Things
from safeloc.report.drawing import (
    BLUE,
    GREY,
    LEFT,
    ORANGE,
    RED,
    RIGHT,
    SKY,
    Axis,
    Swatch,
    across,
    across_axis,
    band,
    box,
    box_swatch,
    cross,
    diamond,
    legend,
    line,
    metres,
    picture,
    stroke_swatch,
    triangle,
    upright,
    upright_axis,
    word,
)
from safeloc.report.recorded_run import RecordedRun, Series
from safeloc.report.strips import TALL, strip, strip_legend
from safeloc.report.thinning import Point, Span, pieces, spans
from safeloc.report.violations import head, violations

_WHOLE, ENLARGED, BETWEEN = 230, 150, 44
_ENLARGED_WHERE = 6
"""There is an enlarged panel if the tolerable error is more than this many times the narrowest margin."""


class _Thing(NamedTuple):
    """Something beside the line: kind, position, name, and view zone."""

    kind: str
    at_mm: int
    words: str
    zone: tuple[int, int] | None


class _Off(NamedTuple):
    """One step in mm: position, deviation (None if the truth is unknown), and the bounds of the deviation by the interval."""

    place: float
    deviation: float | None
    low: float
    high: float

    @property
    def wrong(self) -> bool:
        """Return whether the interval misses the truth."""
        return self.deviation is not None and not self.low <= self.deviation <= self.high


@dataclass(frozen=True)
class _Offs:
    """A run as positions and deviations."""

    one: Deviation
    recorded: RecordedRun

    @cached_property
    def steps(self) -> list[_Off | None]:
        """Each step; None if nothing is reported."""
        made: list[_Off | None] = []
        for step, truth in zip(self.recorded.trace.steps, self.truth, strict=True):
            ends = self.one.reported.interval_mm(step.outputs)
            if ends is None:
                made.append(None)
                continue
            position = step.outputs[self.one.reported.position]
            off = None if truth is None else position - truth
            made.append(_Off(position if truth is None else truth, off, position - ends[1], position - ends[0]))
        return made

    @cached_property
    def truth(self) -> Series:
        """The true position of each step in mm."""
        return self.recorded.truth(self.one.reported.truth)

    @property
    def places(self) -> Series:
        """The true positions, or the reported ones if the truth is unknown."""
        pairs = zip(self.truth, self.steps, strict=True)
        return [truth if truth is not None or off is None else off.place for truth, off in pairs]

    @property
    def reported(self) -> list[_Off]:
        """The steps with a reported position."""
        return [off for off in self.steps if off is not None]

    @property
    def narrowest(self) -> float:
        """The least of the greater margins of all steps, mm."""
        return min((max(off.high, -off.low) for off in self.reported), default=0.0)


def deviation_picture(one: Deviation, recorded: RecordedRun) -> str:
    """Return the drawing; empty for a run without any position."""
    offs = _Offs(one, recorded)
    places = [place for place in offs.places if place is not None]
    if not places:
        return ""
    axis = across(places)
    furthest = max([one.tolerance_mm, *(max(abs(off.low), off.high, abs(off.deviation or 0)) for off in offs.reported)])
    upper = Axis(-furthest * 1.1, furthest * 1.1, head(recorded) + _WHOLE, head(recorded))
    made = [_panel(offs, axis, upper, "deviation in m"), _tolerance(one, upper)]
    bottom = upper.begin
    if 0 < offs.narrowest * _ENLARGED_WHERE < one.tolerance_mm:
        near = Axis(-4 * offs.narrowest, 4 * offs.narrowest, bottom + BETWEEN + ENLARGED, bottom + BETWEEN)
        made.append(_clipped(recorded.name, near, _panel(offs, axis, near, "")))
        made.append(upright_axis(near, "enlarged, in m"))
        bottom = near.begin
    things = [thing for thing in _things(one, recorded) if axis.holds(thing.at_mm)]
    made += [_along(things, axis, bottom + 60), _lines(things, axis, upper.end, bottom)]
    modes, members = recorded.words(one.mode), recorded.members(one.mode)
    strip_at = bottom + 104
    made.append(strip(axis, offs.places, modes, members, strip_at, "mode"))
    made.append(across_axis(axis, strip_at + TALL + 8, "distance along the line in m"))
    made.append(violations(recorded, offs.places, axis, bottom))
    first, y = legend(_keys(offs, things), strip_at + TALL + 66)
    second, y = legend(strip_legend(modes, members), y, "mode")
    return picture([*made, first, second], y, f"{one.title}, recording {recorded.name}")


def _panel(offs: _Offs, axis: Axis, height: Axis, label: str) -> str:
    """Draw interval, deviation, stretches without a report, and wrong intervals, at one scale."""
    grid = upright_axis(height, label) if label else ""
    inside = [None if off is None else _span(axis, height, off) for off in offs.steps]
    run = [
        None if off is None or off.deviation is None else Point(axis.at(off.place), height.at(off.deviation))
        for off in offs.steps
    ]
    zero = f'<path d="M{LEFT} {height.at(0):.1f}H{RIGHT}" class="ink" stroke-width=".8"/>'
    shaded = band(spans(inside), BLUE, kind="interval")
    wrong = "".join(cross(x, y, kind="wrong") for x, y in _wrong(offs, axis, height))
    return grid + _silence(offs, axis, height) + shaded + zero + line(pieces(run), "", kind="deviation") + wrong


def _span(axis: Axis, height: Axis, off: _Off) -> Span:
    return Span(axis.at(off.place), height.at(off.high), height.at(off.low))


def _wrong(offs: _Offs, axis: Axis, height: Axis) -> list[Point]:
    """Return the places of crosses for wrong intervals, at most one in eight units across."""
    found: dict[int, Point] = {}
    for off in offs.reported:
        if off.wrong and off.deviation is not None:
            x = axis.at(off.place)
            found.setdefault(round(x / 8), Point(x, height.at(off.deviation)))
    return list(found.values())


def _silence(offs: _Offs, axis: Axis, height: Axis) -> str:
    """Draw the stretches without a report, which cost availability, not safety."""
    steps = zip(offs.places, offs.steps, strict=True)
    silent = [None if off is not None or place is None else Span(axis.at(place), 0, 0) for place, off in steps]
    top, size = height.end, height.begin - height.end
    return "".join(
        box(min(one.x for one in run), top, max(one.x for one in run) - min(one.x for one in run), size, GREY,
            kind="silent", faint=True)
        for run in spans(silent)
    )  # fmt: skip


def _tolerance(one: Deviation, height: Axis) -> str:
    made = ""
    for value in (one.tolerance_mm, -one.tolerance_mm):
        y = height.at(value)
        made += f'<path d="M{LEFT} {y:.1f}H{RIGHT}" stroke="{RED}" stroke-width="2" stroke-dasharray="9 4" class="tolerable"/>'
    return made


def _clipped(name: str, height: Axis, drawn: str) -> str:
    plain = "".join(letter if letter.isascii() and letter.isalnum() else "-" for letter in name)
    area = f'<rect x="{LEFT}" y="{height.end:.1f}" width="{RIGHT - LEFT}" height="{height.begin - height.end:.1f}"/>'
    return f'<clipPath id="clip-{plain}">{area}</clipPath><g clip-path="url(#clip-{plain})">{drawn}</g>'


# ------------------------------------------------------------------ things beside the line


def _things(one: Deviation, recorded: RecordedRun) -> Iterator[_Thing]:
    for things in one.things:
        yield from _of_kind(things, recorded)


def _of_kind(things: Things, recorded: RecordedRun) -> Iterator[_Thing]:
    """Yield each place once, with its first values in the run."""
    called, done = things.called.get(recorded.name, {}), set[int]()
    for given in recorded.given:
        at = given.get(things.at)
        if at is None or at in done:
            continue
        done.add(at)
        label = recorded.word(things.label, given[things.label]) if things.label in given else ""
        words = f"{called[at]} ({label})" if at in called else label
        yield _Thing(things.kind, at, words, _zone(things, given, at))


def _zone(things: Things, given: Mapping[str, Value], at: int) -> tuple[int, int] | None:
    if things.zone is None or not set(things.zone) <= set(given):
        return None
    begin, end = things.zone
    return at - given[begin], at - given[end]


def _along(things: list[_Thing], axis: Axis, y: float) -> str:
    """Draw the track, and everything beside it."""
    made = [word(LEFT - 8, y + 4, "track", anchor="end")]
    made.append(f'<path d="M{LEFT} {y:.1f}H{RIGHT}" class="ink track" stroke-width="3"/>')
    for thing in things:
        x = axis.at(thing.at_mm)
        if thing.zone is not None:
            begin, end = (min(max(axis.at(place), LEFT), RIGHT) for place in thing.zone)
            made.append(box(begin, y - 9, end - begin, 18, SKY, kind="zone", faint=True))
        passed = thing.kind != "reflector"
        drawn = triangle(x, y, kind="balise") if passed else diamond(x, y, kind="reflector")
        made.append(drawn + word(x, y + 24 if passed else y - 14, f"{thing.kind} {thing.words}", anchor=_side(x)))
    return "".join(made)


def _side(x: float) -> str:
    return "end" if x > RIGHT - 60 else "start" if x < LEFT + 60 else "middle"


def _lines(things: list[_Thing], axis: Axis, top: float, bottom: float) -> str:
    colours = {"balise": ORANGE, "reflector": SKY, "marker": ORANGE}
    return "".join(
        upright(axis.at(thing.at_mm), top, bottom, colours[thing.kind], kind=f"at-{thing.kind}") for thing in things
    )


def _keys(offs: _Offs, things: list[_Thing]) -> list[Swatch]:
    keys = [stroke_swatch("", "deviation: reported position less true position")]
    keys.append(
        box_swatch(
            BLUE, "allowed by the reported interval: down by the margin above, up by the margin below", faint=True
        )
    )
    keys.append(stroke_swatch(RED, f"tolerable error, {metres(offs.one.tolerance_mm)}", "9 4"))
    if any(off is None for off in offs.steps):
        keys.append(box_swatch(GREY, "no position reported", faint=True))
    if any(thing.zone for thing in things):
        keys.append(box_swatch(SKY, "view zone of a reflector", faint=True))
    wrong = [number for number, off in enumerate(offs.steps, 1) if off is not None and off.wrong]
    if wrong:
        keys.append(
            Swatch(cross(13, 0, kind="key"), f"interval misses the truth: {len(wrong)} steps from {wrong[0]} on")
        )
    if all(value is None for value in offs.truth):
        keys.append(Swatch("", "the recording holds no truth: deviation unknown, distance as reported"))
    return keys
