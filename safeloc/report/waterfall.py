"""Waterfall picture: loudness of a fibre over distance and time, with true trains, reported intervals and section
states."""

from __future__ import annotations

import html
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import groupby
from typing import NamedTuple

from safeloc.language.units import MS_PER_S
from safeloc.railway.pictures import (
    LoudFibre,
    NamedInterval,
    SectionState,
    Stretch,
    TrueEnds,
    VirtualSection,
    Waterfall,
)
from safeloc.report.drawing import (
    BLUE,
    GREEN,
    GREY,
    LEFT,
    ORANGE,
    PURPLE,
    RED,
    RIGHT,
    Axis,
    Swatch,
    across_axis,
    band,
    box_swatch,
    legend,
    line,
    picture,
    stroke_swatch,
    upright_axis,
    word,
)
from safeloc.report.png import Colour, data_address, png
from safeloc.report.recorded_run import RecordedRun
from safeloc.report.strips import strip, strip_legend
from safeloc.report.thinning import Point, Span, pieces, spans
from safeloc.report.violations import head, violations

_HEIGHT, ROW = 430, 26
_INK, CASING = "#101418", "#ffffff"
_QUIET: Colour = (246, 247, 248)
_LOUD: Colour = (44, 50, 60)
_UNTOLD: Colour = (255, 214, 204)
_DIGITS = "0123456789abcdef"
_INTERVALS = (BLUE, GREEN, PURPLE)
_STATES = {"FREE": GREEN, "OCCUPIED": ORANGE, "AMBIGUOUS": PURPLE, "UNKNOWN": GREY}
_SHADE = {"FREE": 0.0, "OCCUPIED": 0.42, "AMBIGUOUS": 0.42, "UNKNOWN": 0.5}
_INITIAL = {"FREE": "F", "OCCUPIED": "O", "AMBIGUOUS": "A", "UNKNOWN": "?"}
_MOST_ROWS = 24


class _Piece(NamedTuple):
    """A virtual section's state between two times."""

    begin_ms: float
    end_ms: float
    state: str


@dataclass(frozen=True)
class _Fall:
    """A run and the loudness along its fibre."""

    one: Waterfall
    recorded: RecordedRun
    loud: LoudFibre

    @property
    def columns(self) -> int:
        """The number of columns of the image; each is a stretch of time."""
        return len(self.loud.rows[0])

    @property
    def column_ms(self) -> int:
        """The duration of a column."""
        return self.loud.step_ms * self.loud.steps_per_column

    @cached_property
    def times_ms(self) -> list[float]:
        """The time of each step of the run."""
        return [float(self.loud.first_ms + number * self.loud.step_ms) for number in range(self.recorded.trace.length)]

    @property
    def time(self) -> Axis:
        """Time across the page, in ms."""
        begin = self.loud.first_ms - self.loud.step_ms
        return Axis(begin, begin + self.columns * self.column_ms, LEFT, RIGHT)

    def distance(self, top: float) -> Axis:
        """Return the distance up the page, in mm."""
        return Axis(0, len(self.loud.rows) * self.loud.row_mm, top + _HEIGHT, top)

    def ends(self, interval: NamedInterval) -> list[tuple[int, int] | None]:
        """Return the reported interval after each step."""
        return [interval.reported.interval_mm(step.outputs) for step in self.recorded.trace.steps]

    def spoken(self, name: str) -> tuple[list[str], tuple[str, ...]]:
        """Return a signal's values in words after each step, and all its possible values; a truth value is yes or no."""
        members = self.recorded.members(name)
        if members:
            return self.recorded.words(name), members
        return ["yes" if flag else "no" for flag in self.recorded.flags(name)], ("no", "yes")

    def states(self, section: SectionState) -> list[_Piece]:
        """Return a virtual section's states in time."""
        words, made, at = self.recorded.words(section.mode), list[_Piece](), 0
        for state, group in groupby(words):
            length = len(list(group))
            begin = self.times_ms[at] - self.loud.step_ms
            made.append(_Piece(begin, begin + length * self.loud.step_ms, state))
            at += length
        return made

    def virtual(self) -> Iterator[tuple[str, float, float, list[_Piece]]]:
        """Yield virtual sections of the machine and of the recording: name, bounds in mm, states in time."""
        row, known = self.recorded.rows[0], set[tuple[float, float]]()
        for section in self.one.sections:
            low, high = float(row[section.low]), float(row[section.high])
            known.add((low, high))
            yield section.name, low, high, self.states(section)
        for other in self.loud.virtual:
            if (other.low_mm, other.high_mm) not in known:
                yield "", float(other.low_mm), float(other.high_mm), self._kept(other)

    def _kept(self, section: VirtualSection) -> list[_Piece]:
        steps = [*(step for step, _ in section.states), len(self.times_ms)]
        begins = [self.loud.first_ms + (step - 1) * self.loud.step_ms for step in steps]
        return [
            _Piece(begin, end, state)
            for begin, end, (_, state) in zip(begins, begins[1:], section.states, strict=False)
        ]


def waterfall_picture(one: Waterfall, recorded: RecordedRun) -> str:
    """Return the drawing; empty for a recording without loudness."""
    loud = one.loud(recorded.name)
    if loud is None:
        return ""
    fall, top = _Fall(one, recorded, loud), head(recorded) + 14
    time, distance = fall.time, fall.distance(top)
    made = [_image(fall, distance), upright_axis(distance, "place in km", unit=1_000_000)]
    made += [_section(fall, low, high, states, distance) for _, low, high, states in fall.virtual()]
    for interval, colour in zip(one.intervals, _INTERVALS, strict=False):
        made.append(_interval(fall, interval, distance, colour))
    made += [_train(fall, train, distance) for train in loud.trains]
    made += [_marked(name, place, distance) for name, place in loud.marks.items()]
    made += [_stretch(section, distance) for section in loud.sections]
    made += [_signal(fall, name, distance) for name in one.signals]
    y = top + _HEIGHT + 10
    for label, name in one.modes.items():
        known: list[float | None] = list(fall.times_ms)
        words, members = fall.spoken(name)
        made.append(strip(time, known, words, members, y, label))
        y += ROW
    made.append(across_axis(time, y + 4, "time in s"))
    made.append(violations(recorded, fall.times_ms, time, y))
    keys, y = _legends(fall, y + 58)
    return picture([*made, keys], y, described(one, recorded))


def described(one: Waterfall, recorded: RecordedRun) -> str:
    """Describe the picture in text: the scene, and the modes of each machine over time."""
    loud = one.loud(recorded.name)
    if loud is None:
        return ""
    fall = _Fall(one, recorded, loud)
    length = len(loud.rows) * loud.row_mm / 1e6
    sentences = [
        f"{one.title}, recording {recorded.name}: {length:.1f} km of fibre over {fall.columns * fall.column_ms // 1_000} s."
    ]
    sentences.append(loud.says)
    for label, name in one.modes.items():
        sentences.append(f"{label}: {', '.join(_courses(fall, name))}.")
    return " ".join(sentences)


def _courses(fall: _Fall, name: str) -> Iterator[str]:
    at = 0
    for mode, group in groupby(fall.spoken(name)[0]):
        yield f"{mode} from {fall.times_ms[at] / MS_PER_S:.0f} s"
        at += len(list(group))


def waterfall_table(one: Waterfall, recorded: RecordedRun) -> dict[str, list[str] | list[list[str]]] | None:
    """Return the numbers of the picture for some of its times; None if there is no picture."""
    loud = one.loud(recorded.name)
    if loud is None:
        return None
    fall = _Fall(one, recorded, loud)
    many = len(loud.trains) > 1
    trains = [f"train {number} in m" if many else "train in m" for number in range(1, len(loud.trains) + 1)]
    head_ = ["time in s", *trains, *(f"{one.name} in m" for one in one.intervals), *one.modes]
    steps = range(0, recorded.trace.length, -(-recorded.trace.length // _MOST_ROWS))
    return {
        "head": [*head_, *(section.name for section in one.sections)],
        "rows": [_cells(fall, step) for step in steps],
    }


def _cells(fall: _Fall, step: int) -> list[str]:
    column = min(step // fall.loud.steps_per_column, fall.columns - 1)
    made = [f"{fall.times_ms[step] / MS_PER_S:.1f}"]
    made += [_from_to(train.low_mm[column], train.high_mm[column]) for train in fall.loud.trains]
    for interval in fall.one.intervals:
        ends = fall.ends(interval)[step]
        made.append("not reported" if ends is None else _from_to(*ends))
    names = (*fall.one.modes.values(), *(section.mode for section in fall.one.sections))
    return [*made, *(fall.spoken(name)[0][step] for name in names)]


def _from_to(low_mm: float, high_mm: float) -> str:
    return f"{low_mm / 1_000:.0f} to {high_mm / 1_000:.0f}".replace("-", "\N{MINUS SIGN}")


# ------------------------------------------------------------------ pieces of the drawing


def _image(fall: _Fall, distance: Axis) -> str:
    """Draw the loudness, with the greatest position on top."""
    shades = [_between(_QUIET, _LOUD, level / (len(_DIGITS) - 1)) for level in range(len(_DIGITS))]
    numbers = {digit: number for number, digit in enumerate(_DIGITS)} | {".": len(_DIGITS)}
    rows = [bytes(numbers[digit] for digit in row) for row in reversed(fall.loud.rows)]
    address = data_address(png(rows, [*shades, _UNTOLD]))
    return (
        f'<image x="{LEFT}" y="{distance.end:.1f}" width="{RIGHT - LEFT}" height="{_HEIGHT}" preserveAspectRatio="none" '
        f'style="image-rendering:pixelated" class="loudness" href="{address}"/>'
    )


def _between(one: Colour, other: Colour, share: float) -> Colour:
    red, green, blue = (round(a + (b - a) * share) for a, b in zip(one, other, strict=True))
    return red, green, blue


def _train(fall: _Fall, train: TrueEnds, distance: Axis) -> str:
    """Draw both ends of a train where they are on the fibre, with a light edge, visible on any background."""
    made = ""
    for ends, dash in ((train.high_mm, ""), (train.low_mm, "6 4")):
        points = [_on(fall, distance, column, place) for column, place in enumerate(ends)]
        made += line(pieces(points), CASING, kind="casing", width=4.2)
        made += line(pieces(points), _INK, kind="true-end", width=1.8, dash=dash)
    return made


def _on(fall: _Fall, distance: Axis, column: int, place_mm: float) -> Point | None:
    last_ms = fall.loud.first_ms + ((column + 1) * fall.loud.steps_per_column - 1) * fall.loud.step_ms
    at = min(fall.time.at(last_ms), RIGHT)
    return Point(at, distance.at(place_mm)) if distance.holds(place_mm) else None


def _interval(fall: _Fall, interval: NamedInterval, distance: Axis, colour: str) -> str:
    """Draw an interval as a band with edges; there are gaps while nothing is reported."""
    found = [
        None
        if ends is None
        else Span(fall.time.at(at), distance.at(_kept(ends[0], distance)), distance.at(_kept(ends[1], distance)))
        for at, ends in zip(fall.times_ms, fall.ends(interval), strict=True)
    ]
    shown = [
        None if span is None else Span(span.x, max(span.low, span.high), min(span.low, span.high)) for span in found
    ]
    edges = [
        pieces(None if span is None else Point(span.x, y) for span, y in zip(shown, heights, strict=True))
        for heights in zip(*((0.0, 0.0) if span is None else (span.low, span.high) for span in shown), strict=True)
    ]
    shade = band([[Span(s.x, s.high, s.low) for s in stretch] for stretch in spans(shown)], colour, kind="interval")
    return shade + "".join(line(edge, colour, kind="interval-edge", width=1.6) for edge in edges)


def _kept(place_mm: float, distance: Axis) -> float:
    """Return the part of an interval that lies on the fibre."""
    return min(max(place_mm, distance.low), distance.high)


def _section(fall: _Fall, low_mm: float, high_mm: float, states: Sequence[_Piece], distance: Axis) -> str:
    """Draw a virtual section: its bounds, and its state over time, with a letter."""
    top, bottom = distance.at(high_mm), distance.at(low_mm)
    made = [
        f'<path d="M{LEFT} {y:.1f}H{RIGHT}" stroke="{_INK}" stroke-opacity=".45" stroke-width="1" class="bound"/>'
        for y in (top, bottom)
    ]
    return "".join([*made, *(_state(fall, piece, top, bottom) for piece in states)])


def _state(fall: _Fall, piece: _Piece, top: float, bottom: float) -> str:
    begin, end = fall.time.at(piece.begin_ms), min(fall.time.at(piece.end_ms), RIGHT)
    shape = (
        f'<rect x="{begin:.1f}" y="{top:.1f}" width="{max(end - begin, 1):.1f}" height="{bottom - top:.1f}" '
        f'fill="{_STATES.get(piece.state, GREY)}" fill-opacity="{_SHADE.get(piece.state, 0.5)}" class="state {piece.state}"/>'
    )
    room = end - begin > 14 and bottom - top > 13
    letter = _INITIAL.get(piece.state, piece.state)
    return shape + (word(begin + 4, top + 12, letter, style=f"fill:{_INK};font-weight:700") if room else "")


def _stretch(section: Stretch, distance: Axis) -> str:
    """Draw a surveyed localization section: two dotted lines, with its effect between them at the right."""
    low, high = distance.at(section.low_mm), distance.at(section.high_mm)
    lines = "".join(
        f'<path d="M{LEFT} {y:.1f}H{RIGHT}" stroke="{RED}" stroke-dasharray="2 4" class="section"/>'
        for y in (low, high)
    )
    return lines + _plate((low + high) / 2 + 4, section.name)


def _marked(name: str, place_mm: int, distance: Axis) -> str:
    y = distance.at(place_mm)
    return f'<path d="M{LEFT} {y:.1f}H{RIGHT}" stroke="{_INK}" stroke-opacity=".6" class="mark"/>' + _plate(y - 4, name)


def _plate(y: float, text: str) -> str:
    """Write words at the right edge of the image, readable on any background."""
    return (
        f'<text x="{RIGHT - 6}" y="{y:.1f}" class="word" text-anchor="end" paint-order="stroke" '
        f'style="fill:{_INK};stroke:#fff;stroke-width:3">{html.escape(text)}</text>'
    )


def _signal(fall: _Fall, name: str, distance: Axis) -> str:
    """Draw position signals: a mark on the upper edge at the time of each."""
    y = distance.end
    return "".join(
        f'<path d="M{fall.time.at(at):.1f} {y + 1:.1f}l-6 12h12z" fill="{RED}" class="position-signal"/>'
        for at, flag in zip(fall.times_ms, fall.recorded.flags(name), strict=True)
        if flag
    )


def _legends(fall: _Fall, y: float) -> tuple[str, float]:
    made = ""
    drawn, y = legend([_on_light(key) for key in _keys(fall)], y, "picture")
    made += drawn
    for label, name in fall.one.modes.items():
        drawn, y = legend(strip_legend(*fall.spoken(name)), y, label)
        made += drawn
    return made, y


def _keys(fall: _Fall) -> Sequence[Swatch]:
    step_db = fall.loud.level_cdb / 100
    keys = [
        Swatch(_ramp(), f"amplitude: quiet to {step_db * (len(_DIGITS) - 1):.0f} dB over quiet and more"),
        stroke_swatch(_INK, "true train: end towards greater places"),
        stroke_swatch(_INK, "end towards smaller places", "6 4"),
    ]
    keys += [
        box_swatch(colour, f"reported: {one.name}", faint=True)
        for one, colour in zip(fall.one.intervals, _INTERVALS, strict=False)
    ]
    if fall.loud.sections:
        keys.append(stroke_swatch(RED, "localization section", "2 4"))
    if fall.one.signals:
        keys.append(Swatch(f'<path d="M13 -6l-6 12h12z" fill="{RED}"/>', "position signal counted"))
    if any("." in row for row in fall.loud.rows):
        keys.append(box_swatch("#ffd6cc", "no data"))
    present = {piece.state for *_, states in fall.virtual() for piece in states}
    return [*keys, *(_state_key(state) for state in _STATES if state in present)]


def _on_light(key: Swatch) -> Swatch:
    """Return a legend's swatch with the light background of the picture, in every colour scheme."""
    red, green, blue = _QUIET
    return Swatch(
        f'<rect x="-2" y="-8" width="30" height="15" fill="rgb({red},{green},{blue})"/>{key.drawn}', key.words
    )


def _state_key(state: str) -> Swatch:
    shade = f'<rect x="0" y="-7" width="26" height="13" fill="{_STATES[state]}" fill-opacity="{_SHADE[state]}" stroke="{GREY}"/>'
    return Swatch(shade, f"{_INITIAL[state]} section {state}")


def _ramp() -> str:
    """Return a swatch with some shades from quiet to loud."""
    shades = [_between(_QUIET, _LOUD, share / 4) for share in range(5)]
    return "".join(
        f'<rect x="{number * 5.2:.1f}" y="-7" width="5.4" height="13" fill="rgb{colour}"/>'
        for number, colour in enumerate(shades)
    )
