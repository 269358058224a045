"""The picture of a day: python -m tests.soak.drawing FILE PICTURE.svg

Memory, latency, the share of time without a core, and the vehicles that drive, over the fleet's clock.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from safeloc.report.drawing import (
    BLUE,
    GREEN,
    GREY,
    LEFT,
    ORANGE,
    RED,
    RIGHT,
    Axis,
    Swatch,
    across_axis,
    legend,
    line,
    picture,
    stroke_swatch,
    upright,
    upright_axis,
    word,
)
from safeloc.report.thinning import Point
from tests.kept_lines import kept_lines
from tests.soak.day import HOUR_MS
from tests.soak.windows import Window, as_window, at_share

STYLE = (
    "<style>text{font:13px sans-serif;fill:#1c2733}.frame{fill:none;stroke:#cdd5dc}.grid{stroke:#cdd5dc;"
    "stroke-dasharray:3 4}.ink{stroke:#1c2733}</style>"
)
TALL, BETWEEN, TOP = 140, 54, 60
ENDED = {"SIGKILL": "kill -9", "SIGTERM": "orderly restart"}

Figure = Callable[[Window], float]


def drawn(windows: Sequence[Window]) -> str:
    """The picture of these windows, as SVG text."""
    across = Axis(0, windows[-1].to_ms / HOUR_MS, LEFT, RIGHT)
    tops = [TOP + place * (TALL + BETWEEN) for place in range(4)]
    bottom = tops[-1] + TALL
    title = (
        f"{round(windows[-1].to_ms / HOUR_MS, 1):g} hours of a fleet, in windows of {windows[0].to_ms / 60_000:g} min"
    )
    parts = [
        STYLE,
        word(LEFT, 20, title),
        *(_ended(one, across, bottom) for one in windows if one.ended and one is not windows[-1]),
        _memory(windows, across, tops[0]),
        _latency(windows, across, tops[1]),
        _waited(windows, across, tops[2]),
        _driving(windows, across, tops[3]),
        across_axis(across, bottom, "hours of the fleet's clock", unit=1),
    ]
    return picture(parts, bottom + 44, title)


def _memory(windows: Sequence[Window], across: Axis, top: float) -> str:
    most = max(one.resident_kib for one in windows) / 1024
    axis = _axis(0, most * 1.15, top)
    return upright_axis(axis, "memory, MiB", unit=1) + _line(
        windows, across, axis, lambda one: one.resident_kib / 1024, BLUE, "memory"
    )


def _latency(windows: Sequence[Window], across: Axis, top: float) -> str:
    shown: tuple[tuple[str, str, Figure], ...] = (
        ("half of the reports within", GREEN, lambda one: at_share([one.latency], 0.5)),
        ("99 % of the reports within", ORANGE, lambda one: at_share([one.latency], 0.99)),
        ("the latest report", RED, lambda one: one.worst_ms),
    )
    values = [figure(one) for _, _, figure in shown for one in windows]
    axis = _axis(_decade(min(values), math.floor), _decade(max(values), math.ceil), top)
    lines = [
        _line(windows, across, axis, lambda one, of=figure: math.log10(max(of(one), 0.01)), colour, "latency")
        for _, colour, figure in shown
    ]
    swatches: list[Swatch] = [stroke_swatch(colour, name) for name, colour, _ in shown]
    return _decades(axis, "latency, ms") + "".join(lines) + legend(swatches, top - 15)[0]


def _waited(windows: Sequence[Window], across: Axis, top: float) -> str:
    axis = _axis(0, 100, top)
    label = upright_axis(axis, "ready, no core, %", unit=1)
    return label + _line(windows, across, axis, lambda one: min(100.0, one.waited * 100), GREY, "waited")


def _driving(windows: Sequence[Window], across: Axis, top: float) -> str:
    axis = _axis(0, max(one.driving for one in windows) * 1.15, top)
    return upright_axis(axis, "vehicles that drive", unit=1) + _line(
        windows, across, axis, lambda one: one.driving, BLUE, "driving"
    )


def _axis(low: float, high: float, top: float) -> Axis:
    return Axis(low, high, top + TALL, top)


def _decade(value_ms: float, rounded: Callable[[float], int]) -> int:
    return rounded(math.log10(max(value_ms, 0.01)))


def _decades(axis: Axis, label: str) -> str:
    """An upright axis of logarithms: a grid line for each power of ten."""
    frame = f'<rect x="{LEFT}" y="{axis.end:.1f}" width="{RIGHT - LEFT}" height="{axis.begin - axis.end:.1f}" class="frame"/>'
    made = []
    for power in range(round(axis.low), round(axis.high) + 1):
        y = axis.at(power)
        made.append(f'<path d="M{LEFT} {y:.1f}H{RIGHT}" class="grid"/>')
        made.append(word(LEFT - 8, y + 4, f"{10.0**power:g}", anchor="end"))
    return frame + "".join(made) + word(LEFT - 8, axis.end - 11, label, anchor="end")


def _line(windows: Sequence[Window], across: Axis, axis: Axis, of: Figure, colour: str, kind: str) -> str:
    """A figure of each window, at its end."""
    points = [Point(across.at(one.to_ms / HOUR_MS), axis.at(of(one))) for one in windows]
    return line([points], colour, kind=kind)


def _ended(window: Window, across: Axis, bottom: float) -> str:
    """Where the process was ended and started again."""
    x = across.at(window.from_ms / HOUR_MS)
    return upright(x, TOP, bottom, GREY, kind="ended") + word(x + 4, TOP + 14, ENDED[window.ended])


def main() -> None:
    """Draw a file."""
    file, out = map(Path, sys.argv[1:])
    out.write_text(drawn([as_window(one) for one in kept_lines(file)]) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
