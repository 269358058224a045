"""A small line chart as SVG text: whole-number series over steps, one band, one scale."""

from __future__ import annotations

import html
from collections.abc import Mapping, Sequence

WIDTH, HEIGHT, LEFT, BOTTOM, TOP = 860, 270, 120, 34, 34
COLOURS = ("#1f6fb2", "#c4472b", "#3a8f4d", "#8a5bb0", "#9a7b1c")

Series = Sequence[float | None]


def line_chart(title: str, unit: str, lines: Mapping[str, Series], band: tuple[Series, Series] | None = None) -> str:
    """Lines by name over steps 0, 1, 2 ...; `band` is shaded between its lower and upper series. None is a gap."""
    every = [v for series in [*lines.values(), *(band or ())] for v in series if v is not None]
    length = max((len(series) for series in lines.values()), default=0)
    if not every or length < 2:
        return ""
    scale = _Scale(min(every), max(every), length)
    body = [_band(scale, *band)] if band else []
    for index, (name, series) in enumerate(lines.items()):
        colour = COLOURS[index % len(COLOURS)]
        body.append(f'<path d="{_path(scale, series)}" fill="none" stroke="{colour}" stroke-width="1.8"/>')
        body.append(_text(LEFT + 10 + 150 * index, TOP - 4, name, colour))
    frame = f'<rect x="{LEFT}" y="{TOP + 4}" width="{WIDTH - LEFT - 10}" height="{HEIGHT - BOTTOM - TOP - 4}" class="frame"/>'
    marks = [_mark(scale, value, unit) for value in (scale.low, (scale.low + scale.high) / 2, scale.high)]
    ends = [
        _text(LEFT, 13, title),
        _text(LEFT, HEIGHT - 12, "step 0"),
        _text(WIDTH - 70, HEIGHT - 12, f"step {length - 1}"),
    ]
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" role="img" '
        f'aria-label="{html.escape(title)}" class="chart">{frame}{"".join(marks)}{"".join(body)}{"".join(ends)}</svg>'
    )


class _Scale:
    def __init__(self, low: float, high: float, length: int) -> None:
        pad = (high - low) * 0.04 or 1.0
        self.low, self.high, self._length = low - pad, high + pad, length

    def x(self, step: int) -> float:
        return LEFT + (WIDTH - LEFT - 10) * step / (self._length - 1)

    def y(self, value: float) -> float:
        share = (value - self.low) / (self.high - self.low)
        return HEIGHT - BOTTOM - share * (HEIGHT - BOTTOM - TOP - 4)


def _path(scale: _Scale, series: Series) -> str:
    text, pen_up = "", True
    for step, value in enumerate(series):
        if value is None:
            pen_up = True
            continue
        text += f"{'M' if pen_up else 'L'}{scale.x(step):.1f} {scale.y(value):.1f}"
        pen_up = False
    return text


def _band(scale: _Scale, lower: Series, upper: Series) -> str:
    """The shaded band, interrupted where it is None."""
    text, run = "", list[tuple[int, float, float]]()
    for step, (low, high) in enumerate([*zip(lower, upper, strict=True), (None, None)]):
        if low is not None and high is not None:
            run.append((step, low, high))
        elif run:
            there = " ".join(f"{scale.x(s):.1f},{scale.y(h):.1f}" for s, _, h in run)
            back = " ".join(f"{scale.x(s):.1f},{scale.y(lo):.1f}" for s, lo, _ in reversed(run))
            text += f'<polygon points="{there} {back}" class="band"/>'
            run = []
    return text


def _mark(scale: _Scale, value: float, unit: str) -> str:
    y = scale.y(value)
    return f'<line x1="{LEFT}" x2="{WIDTH - 10}" y1="{y:.1f}" y2="{y:.1f}" class="grid"/>' + _text(
        4, y + 4, f"{value:,.0f} {unit}".replace(",", " ")
    )


def _text(x: float, y: float, text: str, colour: str = "") -> str:
    style = f' style="fill:{colour}"' if colour else ""
    return f'<text x="{x:.0f}" y="{y:.0f}"{style}>{html.escape(text)}</text>'
