"""Pieces of a drawing as SVG text: axes, lines, bands, strips, marks, legends. Lengths are in units of the page.

The colours are those of Okabe and Ito, which colour-blind readers can distinguish. Nothing is shown by colour alone:
everything coloured has its name or its number beside it.
"""

from __future__ import annotations

import html
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from safeloc.report.thinning import Point, Span, thinned, thinned_band

_WIDTH, LEFT, RIGHT = 1_000, 150, 985
"""Width of a picture, and the begin and end of its axis."""
BLUE, ORANGE, GREEN, RED, PURPLE, SKY, BROWN, GREY = (
    "#0072b2", "#e69f00", "#009e73", "#d55e00", "#cc79a7", "#56b4e9", "#7f6a3f", "#98a1a9",
)  # fmt: skip
PALETTE = (GREY, BLUE, ORANGE, SKY, PURPLE, GREEN, RED, BROWN, "#c9b458")
DARK = (BLUE, BROWN)
"""Colours of the palette on which letters are white."""


@dataclass(frozen=True)
class Axis:
    """Values from `low` to `high` on the page from `begin` to `end`; the page's y runs downwards."""

    low: float
    high: float
    begin: float
    end: float

    def at(self, value: float) -> float:
        """Return the place of a value on the page."""
        return self.begin + (value - self.low) / (self.high - self.low) * (self.end - self.begin)

    def holds(self, value: float) -> bool:
        """Return whether a value lies on the axis."""
        return self.low <= value <= self.high

    @property
    def ticks(self) -> list[float]:
        """Round values, far enough apart for their labels."""
        length = self.end - self.begin
        room = 90 if length > 0 else 36
        step = _round_step((self.high - self.low) * room / abs(length))
        first, last = math.ceil(self.low / step), math.floor(self.high / step)
        return [number * step for number in range(first, last + 1)]


def _round_step(least: float) -> float:
    power: float = 10.0 ** math.floor(math.log10(least))
    return next(factor * power for factor in (1, 2, 5, 10) if factor * power >= least * (1 - 1e-9))


def across(values: Iterable[float]) -> Axis:
    """Return the axis across the page that shows all the values."""
    known = list(values)
    low, high = min(known), max(known)
    room = (high - low) * 0.02 or 1_000.0
    return Axis(low - room, high + room, LEFT, RIGHT)


def number(value: float) -> str:
    """Return a tick's label."""
    text = f"{value:.3f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text.replace("-", "\N{MINUS SIGN}")


def wide(text: str) -> float:
    """Estimate the width of a text: capital letters are wider."""
    return sum(8.6 if letter.isupper() or letter == "_" else 6.4 for letter in text)


def metres(value_mm: float, digits: int = 0) -> str:
    """Return a length in metres, such as `180 m`."""
    return f"{value_mm / 1_000:.{digits}f} m".replace("-", "\N{MINUS SIGN}")


def word(x: float, y: float, text: str, *, anchor: str = "start", soft: bool = False, style: str = "") -> str:
    """Return text, escaped."""
    kind = "word soft" if soft else "word"
    more = f' style="{style}"' if style else ""
    return f'<text x="{x:.1f}" y="{y:.1f}" class="{kind}" text-anchor="{anchor}"{more}>{html.escape(text)}</text>'


def across_axis(axis: Axis, y: float, label: str, *, unit: float = 1_000, top: float | None = None) -> str:
    """Return ticks and numbers below `y`, grid lines up to `top`, and the label at the end; values are divided by `unit`."""
    scaled = Axis(axis.low / unit, axis.high / unit, axis.begin, axis.end)
    made = [f'<path d="M{axis.begin:.1f} {y:.1f}H{axis.end:.1f}" class="ink" stroke-width="1"/>']
    for tick in scaled.ticks:
        x = scaled.at(tick)
        if top is not None:
            made.append(f'<path d="M{x:.1f} {top:.1f}V{y:.1f}" class="grid"/>')
        made.append(f'<path d="M{x:.1f} {y:.1f}v5" class="ink"/>' + word(x, y + 17, number(tick), anchor="middle"))
    return "".join(made) + word(axis.end, y + 33, label, anchor="end")


def upright_axis(axis: Axis, label: str, *, unit: float = 1_000) -> str:
    """Return the grid lines across and numbers beside them, with the label above."""
    scaled = Axis(axis.low / unit, axis.high / unit, axis.begin, axis.end)
    made = []
    for tick in scaled.ticks:
        y = scaled.at(tick)
        made.append(f'<path d="M{LEFT} {y:.1f}H{RIGHT}" class="grid"/>')
        made.append(word(LEFT - 8, y + 4, number(tick), anchor="end"))
    frame = f'<rect x="{LEFT}" y="{axis.end:.1f}" width="{RIGHT - LEFT}" height="{axis.begin - axis.end:.1f}" class="frame"/>'
    return frame + "".join(made) + word(LEFT - 8, axis.end - 11, label, anchor="end")


def line(stretches: Iterable[Sequence[Point]], colour: str, *, kind: str, width: float = 1.8, dash: str = "") -> str:
    """Return the stretches of a line; one with a single point is a dot. An empty `colour` means that of text."""
    paint = f'stroke="{colour}"' if colour else ""
    broken = f' stroke-dasharray="{dash}"' if dash else ""
    made = []
    for stretch in stretches:
        if len(stretch) == 1:
            x, y = stretch[0]
            made.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="2.5" fill="{colour or "currentColor"}" class="{kind}"/>')
        elif stretch:
            text = "L".join(f"{x:.1f} {y:.1f}" for x, y in thinned(stretch))
            inked = kind if colour else f"{kind} ink"
            made.append(f'<path d="M{text}" fill="none" {paint} stroke-width="{width}"{broken} class="{inked}"/>')
    return "".join(made)


def band(stretches: Iterable[Sequence[Span]], colour: str, *, kind: str) -> str:
    """Return shaded bands; a single span is three units wide, so that it can be seen."""
    made = []
    for stretch in stretches:
        shown = thinned_band(stretch)
        if len(shown) == 1:
            shown = [shown[0]._replace(x=shown[0].x - 1.5), shown[0]._replace(x=shown[0].x + 1.5)]
        there = " ".join(f"{one.x:.1f},{one.high:.1f}" for one in shown)
        back = " ".join(f"{one.x:.1f},{one.low:.1f}" for one in reversed(shown))
        made.append(f'<polygon points="{there} {back}" fill="{colour}" fill-opacity=".22" class="{kind}"/>')
    return "".join(made)


def box(x: float, y: float, width: float, height: float, colour: str, *, kind: str, faint: bool = False) -> str:
    """Return a filled rectangle, at least a unit wide."""
    opacity = ' fill-opacity=".25"' if faint else ""
    size = f'width="{max(width, 1):.1f}" height="{height:.1f}"'
    return f'<rect x="{x:.1f}" y="{y:.1f}" {size} fill="{colour}"{opacity} class="{kind}"/>'


def upright(x: float, top: float, bottom: float, colour: str, *, kind: str, dash: str = "4 3") -> str:
    """Return a line from top to bottom."""
    broken = f' stroke-dasharray="{dash}"' if dash else ""
    return f'<path d="M{x:.1f} {top:.1f}V{bottom:.1f}" stroke="{colour}" stroke-width="1.4"{broken} class="{kind}"/>'


def cross(x: float, y: float, *, kind: str, size: float = 6) -> str:
    """Return a cross, which marks something wrong or the end of something."""
    arms = f"M{x - size:.1f} {y - size:.1f}l{2 * size} {2 * size}m0 {-2 * size}l{-2 * size} {2 * size}"
    return f'<path d="{arms}" stroke="{RED}" stroke-width="2.6" fill="none" class="{kind}"/>'


def triangle(x: float, y: float, *, kind: str) -> str:
    """Return a balise, as on track plans; its tip on the track."""
    return f'<path d="M{x:.1f} {y:.1f}l-6 10h12z" fill="{ORANGE}" class="{kind} ink"/>'


def diamond(x: float, y: float, *, kind: str) -> str:
    """Return a reflector."""
    return f'<path d="M{x:.1f} {y - 8:.1f}l7 8l-7 8l-7 -8z" fill="{SKY}" class="{kind} ink"/>'


@dataclass(frozen=True)
class Swatch:
    """One entry of a legend: a drawing that starts at 0, 0 and is 26 wide, and its words."""

    drawn: str
    words: str


def legend(entries: Sequence[Swatch], y: float, label: str = "") -> tuple[str, float]:
    """Return the entries in rows from `y` on, with the label beside them, and the `y` below them."""
    x, made = float(LEFT), [word(LEFT - 8, y + 4, label, anchor="end", soft=True)]
    for entry in entries:
        needed = 32 + wide(entry.words) + 18
        if x > LEFT and x + needed > RIGHT + 12:
            x, y = float(LEFT), y + 19
        made.append(f'<g transform="translate({x:.0f} {y:.0f})">{entry.drawn}{word(32, 4, entry.words)}</g>')
        x += needed
    return "".join(made), y + 22


def stroke_swatch(colour: str, words: str, dash: str = "", width: float = 2) -> Swatch:
    """Return a line's entry."""
    return Swatch(line([[Point(0, 0), Point(26, 0)]], colour, kind="key", dash=dash, width=width), words)


def box_swatch(colour: str, words: str, *, faint: bool = False) -> Swatch:
    """Return an area's entry."""
    return Swatch(box(0, -7, 26, 13, colour, kind="key", faint=faint), words)


def picture(parts: Iterable[str], height: float, title: str) -> str:
    """Return the whole drawing; the title is read out by screen readers."""
    label = html.escape(title)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {height:.0f}" width="{_WIDTH}" '
        f'height="{height:.0f}" role="img" aria-label="{label}" class="picture">{"".join(parts)}</svg>'
    )


def styled(drawn: str, style: str) -> str:
    """Return a picture as the text of an SVG file, with a style sheet of its own."""
    head, _, rest = drawn.partition(">")
    return f"{head}>{style}{rest}\n"
