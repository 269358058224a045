"""A small line chart as SVG text: series over steps, with one band and one scale."""

from __future__ import annotations

import html
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from safeloc.report.drawing import RED, Axis, number, wide

WIDTH, HEIGHT, LEFT, BOTTOM, TOP = 860, 270, 120, 34, 34
_COLOURS = ("#1f6fb2", "#c4472b", "#3a8f4d", "#8a5bb0", "#9a7b1c")

_Series = Sequence[float | None]


def line_chart(
    title: str,
    unit: str,
    lines: Mapping[str, _Series],
    band: tuple[_Series, _Series] | None = None,
    broken: int | None = None,
) -> str:
    """Return lines by name over steps 0, 1, 2 ...; `band` is shaded between its lower and upper series. None is a gap.

    broken  the step that breaks the property, which is marked
    """
    every = [v for series in [*lines.values(), *(band or ())] for v in series if v is not None]
    length = max((len(series) for series in lines.values()), default=0)
    if not every or length < 2:
        return ""
    scale = _Scale(min(every), max(every), length)
    body = [_band(scale, *band)] if band else []
    for index, (name, series) in enumerate(lines.items()):
        colour = _COLOURS[index % len(_COLOURS)]
        body.append(f'<path d="{_path(scale, series)}" fill="none" stroke="{colour}" stroke-width="1.8"/>')
        body += [_dot(scale, step, value, colour) for step, value in _lone(series)]
        if name != title:
            body.append(line_of_text(LEFT + 10 + 150 * index, TOP - 4, name, colour))
    frame = f'<rect x="{LEFT}" y="{TOP + 4}" width="{WIDTH - LEFT - 10}" height="{HEIGHT - BOTTOM - TOP - 4}" class="frame"/>'
    marks = [_mark(scale, value, unit) for value in scale.ticks]
    if broken is not None:
        marks.append(broken_at(scale.steps, broken, TOP + 4, HEIGHT - BOTTOM))
    last = f"step {length - 1}" if broken is None else f"\N{MULTIPLICATION SIGN} violated at step {broken}"
    ends = [
        line_of_text(LEFT, 13, title),
        line_of_text(LEFT, HEIGHT - 12, "step 0"),
        line_of_text(WIDTH - 20 - wide(last), HEIGHT - 12, last),
    ]
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" role="img" '
        f'aria-label="{html.escape(title)}" class="chart">{frame}{"".join(marks)}{"".join(body)}{"".join(ends)}</svg>'
    )


@dataclass(frozen=True)
class StepScale:
    """Places of the steps 0 to length - 1 across the page."""

    length: int

    def x(self, step: int) -> float:
        """Return the place of a step."""
        return LEFT + (WIDTH - LEFT - 10) * step / (self.length - 1)


class _Scale:
    def __init__(self, low: float, high: float, length: int) -> None:
        pad = (high - low) * 0.04 or 1.0
        self._axis = Axis(low - pad, high + pad, HEIGHT - BOTTOM, TOP + 4)
        self.steps = StepScale(length)

    @property
    def ticks(self) -> list[float]:
        return self._axis.ticks

    def x(self, step: int) -> float:
        return self.steps.x(step)

    def y(self, value: float) -> float:
        return self._axis.at(value)


def _path(scale: _Scale, series: _Series) -> str:
    text, pen_up = "", True
    for step, value in enumerate(series):
        if value is None:
            pen_up = True
            continue
        text += f"{'M' if pen_up else 'L'}{scale.x(step):.1f} {scale.y(value):.1f}"
        pen_up = False
    return text


def _dot(scale: _Scale, step: int, value: float, colour: str) -> str:
    return f'<circle cx="{scale.x(step):.1f}" cy="{scale.y(value):.1f}" r="3" fill="{colour}"/>'


def _lone(series: _Series) -> list[tuple[int, float]]:
    """Return single values between two gaps, which a line would not show."""
    around = [None, *series, None]
    return [
        (step, value)
        for step, value in enumerate(series)
        if value is not None and around[step] is None and around[step + 2] is None
    ]


def _band(scale: _Scale, lower: _Series, upper: _Series) -> str:
    """Return the shaded band; None is a gap."""
    text, run = "", list[tuple[int, float, float]]()
    for step, (low, high) in enumerate([*zip(lower, upper, strict=True), (None, None)]):
        if low is not None and high is not None:
            run.append((step, low, high))
        elif run:
            there = " ".join(f"{x:.1f},{scale.y(high):.1f}" for x, _, high in _widened(scale, run))
            back = " ".join(f"{x:.1f},{scale.y(low):.1f}" for x, low, _ in reversed(_widened(scale, run)))
            text += f'<polygon points="{there} {back}" class="band"/>'
            run = []
    return text


def _widened(scale: _Scale, run: Sequence[tuple[int, float, float]]) -> list[tuple[float, float, float]]:
    """Return steps as places on the page; a single step is four units wide, so that it can be seen."""
    places = [(scale.x(step), low, high) for step, low, high in run]
    if len(run) > 1:
        return places
    ((x, low, high),) = places
    return [(x - 2, low, high), (x + 2, low, high)]


def _mark(scale: _Scale, value: float, unit: str) -> str:
    y = scale.y(value)
    return f'<line x1="{LEFT}" x2="{WIDTH - 10}" y1="{y:.1f}" y2="{y:.1f}" class="grid"/>' + line_of_text(
        4, y + 4, f"{number(value)} {unit}"
    )


def broken_at(scale: StepScale, step: int, top: float, bottom: float) -> str:
    """Return the mark of the step that breaks a property, from `top` to `bottom`."""
    x = scale.x(step)
    tip = f"violated at step {step}"
    return (
        f'<line x1="{x:.1f}" x2="{x:.1f}" y1="{top:.0f}" y2="{bottom:.0f}" stroke="{RED}" stroke-width="2" '
        f'stroke-dasharray="5 3" class="broken"><title>{tip}</title></line>'
    )


def line_of_text(x: float, y: float, text: str, colour: str = "") -> str:
    """Return a text that begins at a place; text in it is escaped."""
    style = f' style="fill:{colour}"' if colour else ""
    return f'<text x="{x:.0f}" y="{y:.0f}"{style}>{html.escape(text)}</text>'
