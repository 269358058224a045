"""The picture of growth: seconds over the size, each axis in powers of ten, so that a power of the size is a straight line."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from safeloc.report.drawing import (
    BLUE,
    GREEN,
    GREY,
    LEFT,
    ORANGE,
    RIGHT,
    Axis,
    across_axis,
    legend,
    line,
    picture,
    stroke_swatch,
    upright_axis,
    word,
)
from safeloc.report.thinning import Point

STYLE = (
    "<style>text{font:13px sans-serif;fill:#1c2733}.frame{fill:none;stroke:#cdd5dc}.grid{stroke:#cdd5dc;"
    "stroke-dasharray:3 4}.ink{stroke:#1c2733}</style>"
)
COLOURS = {"properties": BLUE, "obligations": ORANGE, "tests": GREEN}
TOP, TALL, BETWEEN, ABOVE = 104, 260, 130, 56

Sized = Sequence[tuple[float, float]]
"""Sizes with their seconds."""


@dataclass(frozen=True)
class _Powers:
    """An axis of powers of ten."""

    axis: Axis

    @classmethod
    def of(cls, values: Sequence[float], begin: float, end: float) -> _Powers:
        """The whole powers that hold the values."""
        low, high = math.floor(math.log10(min(values))), math.ceil(math.log10(max(values)))
        return cls(Axis(low, max(high, low + 1), begin, end))

    def at(self, value: float) -> float:
        """The place of a value."""
        return self.axis.at(math.log10(value))

    @property
    def ticks(self) -> list[float]:
        """The powers."""
        return [10.0**power for power in range(round(self.axis.low), round(self.axis.high) + 1)]


def drawn(machines: Mapping[str, Mapping[str, Sized]], localizers: Sized) -> str:
    """The picture, as SVG text: a panel for each title of generated machines, by kind of seconds; below them localizers by sources."""
    title = "Processor seconds of verify over the size"
    parts, top = [STYLE, word(LEFT, 20, title)], TOP
    for of, kinds in machines.items():
        measured = {kind: sized for kind, sized in kinds.items() if sized}
        if measured:
            parts.append(_machines(of, measured, top))
            top += TALL + BETWEEN
    if localizers:
        parts.append(_localizers(localizers, top + TALL - ABOVE))
        top += TALL - ABOVE + BETWEEN
    return picture(parts, top - BETWEEN + 50, title)


def _machines(of: str, kinds: Mapping[str, Sized], top: float) -> str:
    sizes = [size for sized in kinds.values() for size, _ in sized]
    seconds = [second for sized in kinds.values() for _, second in sized]
    across, upright = _Powers.of(sizes, LEFT, RIGHT), _Powers.of(seconds, top + TALL, top)
    middle = [(size, min(seconds) * size / min(sizes)) for size in (min(sizes), max(sizes))]
    lines = [_line(sized, across, upright, COLOURS[kind]) for kind, sized in kinds.items()]
    swatches = [stroke_swatch(COLOURS[kind], kind) for kind in kinds]
    key, _ = legend([*swatches, stroke_swatch(GREY, "in line with the size", dash="5 4")], top - ABOVE + 18)
    head = word(LEFT, top - ABOVE, of)
    return "".join([head, _frame(across, upright), _line(middle, across, upright, GREY, dash="5 4"), *lines, key])


def _frame(across: _Powers, upright: _Powers) -> str:
    top, bottom = upright.axis.end, upright.axis.begin
    made = [f'<rect x="{LEFT}" y="{top:.1f}" width="{RIGHT - LEFT}" height="{bottom - top:.1f}" class="frame"/>']
    for value in upright.ticks:
        y = upright.at(value)
        made.append(
            f'<path d="M{LEFT} {y:.1f}H{RIGHT}" class="grid"/>' + word(LEFT - 8, y + 4, f"{value:g}", anchor="end")
        )
    for value in across.ticks:
        made.append(word(across.at(value), bottom + 17, f"{value:g}", anchor="middle"))
    made.append(word(LEFT - 8, top - 11, "processor s", anchor="end"))
    return "".join(made) + word(RIGHT, bottom + 33, "state variables", anchor="end")


def _line(sized: Sized, across: _Powers, upright: _Powers, colour: str, dash: str = "") -> str:
    points = [Point(across.at(size), upright.at(second)) for size, second in sized]
    return line([points], colour, kind="growth", dash=dash) + "".join(
        line([[point]], colour, kind="measured") for point in points if not dash
    )


def _localizers(sized: Sized, bottom: float) -> str:
    across = Axis(0, max(size for size, _ in sized) + 0.2, LEFT, RIGHT)
    upright = Axis(0, 1.15 * max(second for _, second in sized), bottom, bottom - TALL)
    points = [Point(across.at(size), upright.at(second)) for size, second in sized]
    dots = "".join(line([[point]], BLUE, kind="measured") for point in points)
    axes = upright_axis(upright, "processor s", unit=1) + across_axis(
        across, bottom, "sources of a localizer (lemmas, contracts, properties)", unit=1
    )
    return axes + line([points], BLUE, kind="growth") + dots
