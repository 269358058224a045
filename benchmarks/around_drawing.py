"""The picture of proofs around a stream: processor seconds over cycles, width and sources, from the table of docs/around.md.

python -m benchmarks.around_drawing    draws docs/around.svg anew
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmarks.growth_drawing import STYLE
from safeloc.report.drawing import BLUE, LEFT, RIGHT, Axis, across_axis, line, picture, upright_axis, word
from safeloc.report.thinning import Point

PAGE = Path(__file__).resolve().parents[1] / "docs" / "around.md"
PICTURE = PAGE.with_suffix(".svg")
_ROW = re.compile(
    r"\| `odometry-service` \| (\d+) \| (\d+) sources? ± (\d+) mm[^|]*\| `valid` from 420 \| proved \| (\d+) \|"
)
_TOP, _TALL, _BETWEEN = 60, 170, 80
_NAMES = ("cycles, two sources, ± 2 mm", "width, ± mm, two sources, 1050 cycles", "sources, ± 2 mm, 600 cycles")


@dataclass(frozen=True)
class Measured:
    """A row of the table: cycles, number of sources that deviate, their width, and processor seconds of the proof."""

    cycles: int
    sources: int
    width_mm: int
    seconds: int


def measured(page: str) -> Iterator[Measured]:
    """Yield the rows of the odometry machine's service run."""
    yield from (Measured(*map(int, found.groups())) for found in _ROW.finditer(page))


def drawn(rows: Sequence[Measured]) -> str:
    """Return the picture, as SVG text: one chart for each of the three sizes, the other two kept."""
    over = (
        [(one.cycles, one.seconds) for one in rows if (one.sources, one.width_mm) == (2, 2)],
        [(one.width_mm, one.seconds) for one in rows if (one.sources, one.cycles) == (2, 1050)],
        [(one.sources, one.seconds) for one in rows if (one.width_mm, one.cycles) == (2, 600)],
    )
    title = "Processor seconds of a proof around a stream"
    parts, top = [STYLE, word(LEFT, 20, title)], _TOP
    for points, name in zip(over, _NAMES, strict=True):
        parts.append(_chart(sorted(points), name, top))
        top += _TALL + _BETWEEN
    return picture(parts, top, title)


def _chart(points: Sequence[tuple[int, int]], name: str, top: int) -> str:
    across = Axis(0, 1.05 * max(size for size, _ in points), LEFT, RIGHT)
    upright = Axis(0, 1.15 * max(second for _, second in points), top + _TALL, top)
    places = [Point(across.at(size), upright.at(second)) for size, second in points]
    dots = "".join(line([[place]], BLUE, kind="measured") for place in places)
    axes = upright_axis(upright, "processor s", unit=1) + across_axis(across, top + _TALL, name, unit=1)
    return axes + line([places], BLUE, kind="growth") + dots


if __name__ == "__main__":
    PICTURE.write_text(drawn([*measured(PAGE.read_text(encoding="utf-8"))]), encoding="utf-8")
