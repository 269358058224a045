"""Stanford diagram of a run: the margin of every reported position over its error.

The margin is that of the side on which the truth lies. Below the diagonal the interval misses the truth: the report is
misleading, and hazardous if the error exceeds the alert limit too. Both are safety failures. A step with a margin beyond the
limit or without a report is unavailable, which is no safety failure.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Literal, get_args

from safeloc.railway.pictures import Stanford
from safeloc.report.drawing import (
    BLUE,
    GREY,
    LEFT,
    ORANGE,
    RED,
    RIGHT,
    Axis,
    Swatch,
    across_axis,
    box,
    box_swatch,
    cross,
    legend,
    metres,
    picture,
    stroke_swatch,
    upright_axis,
    word,
)
from safeloc.report.recorded_run import RecordedRun
from safeloc.report.violations import FIRST, ROW, head

Region = Literal["nominal", "unavailable", "misleading", "hazardous"]
REGIONS: tuple[Region, ...] = get_args(Region)
_TALL, CELL = 420, 6
_COLOURS: Mapping[Region, str] = {"nominal": BLUE, "unavailable": GREY, "misleading": ORANGE, "hazardous": RED}
_MEANT: Mapping[Region, str] = {
    "nominal": "error within the margin, margin within the limit",
    "unavailable": "margin beyond the limit, or nothing reported",
    "misleading": "error beyond the margin, within the limit",
    "hazardous": "error beyond the margin and the limit",
}


def region(error_mm: float, margin_mm: float, limit_mm: float) -> Region:
    """Return the region of a report in the diagram; equal values count as inside."""
    if error_mm > margin_mm:
        return "hazardous" if error_mm > limit_mm else "misleading"
    return "unavailable" if margin_mm > limit_mm else "nominal"


@dataclass(frozen=True)
class Report:
    """Reported steps with a known truth: error, and margin on the side of the truth, in mm; and how many steps are so."""

    error: float
    margin: float
    steps: int = 1


@dataclass(frozen=True)
class Reports:
    """All steps of a run: those with report and truth, and the numbers of steps without report and without truth."""

    made: tuple[Report, ...]
    silent: int
    unknown: int

    def counts(self, limit_mm: float) -> Counter[Region]:
        """Return the number of steps in each region; a step without report is unavailable."""
        found: Counter[Region] = Counter()
        for one in self.made:
            found[region(one.error, one.margin, limit_mm)] += one.steps
        found["unavailable"] += self.silent
        return found


def _reports(one: Stanford, recorded: RecordedRun) -> Reports:
    """Collect the reports of the run, with the numbers of steps without report or without known truth."""
    made, silent, unknown = list[Report](), 0, 0
    for step, truth in zip(recorded.trace.steps, recorded.truth(one.reported.truth), strict=True):
        ends = one.reported.interval_mm(step.outputs)
        if ends is None:
            silent += 1
        elif truth is None:
            unknown += 1
        else:
            position = step.outputs[one.reported.position]
            margin = ends[1] - position if truth >= position else position - ends[0]
            made.append(Report(abs(truth - position), margin))
    return Reports(tuple(made), silent, unknown)


def stanford_picture(one: Stanford, recorded: RecordedRun) -> str:
    """Return the drawing; empty for a run without any reported position of known truth."""
    top, title = head(recorded) + 10, f"{one.title}, recording {recorded.name}"
    return stanford_diagram(_reports(one, recorded), one.limit_mm, title, top=top, above=_violated(recorded))


def stanford_diagram(
    found: Reports, limit_mm: int, title: str, *, top: float = 28, above: Iterable[str] = (), style: str = ""
) -> str:
    """Return the diagram of reports; empty without any.

    above   drawings above the diagram; style: a style sheet, for a diagram outside of the page
    """
    if not found.made:
        return ""
    farthest = max(limit_mm, *(report.error for report in found.made)) * 1.15
    widest = max(limit_mm, *(report.margin for report in found.made)) * 1.15
    across, up = Axis(0, farthest, LEFT, RIGHT), Axis(0, widest, top + _TALL, top)
    counts = found.counts(limit_mm)
    made = [
        style,
        *above,
        upright_axis(up, "margin in m"),
        *_areas(limit_mm, across, up),
        *_lines(limit_mm, across, up),
        *_cells(limit_mm, found, across, up),
        *_words(limit_mm, counts, across, up),
        across_axis(across, up.begin, "error in m"),
    ]
    drawn, y = legend(_keys(limit_mm, found, counts), up.begin + 62)
    return picture([*made, drawn], y, title)


def _violated(recorded: RecordedRun) -> Iterator[str]:
    """Yield the names of violated statements, above the diagram, which does not show steps."""
    for row, broken in enumerate(recorded.broken):
        text = f"\N{MULTIPLICATION SIGN} violated at step {broken.step}: {broken.name}"
        yield word(LEFT, FIRST + ROW * row, text, style="font-weight:700")


def _areas(limit_mm: int, across: Axis, up: Axis) -> Iterator[str]:
    """Draw the four regions, faintly."""
    limit, right, top = float(limit_mm), across.high, up.high
    end = min(right, top)
    corners: dict[Region, tuple[tuple[float, float], ...]] = {
        "nominal": ((0, 0), (limit, limit), (0, limit)),
        "unavailable": ((0, limit), (limit, limit), (end, end), (end, top), (0, top)),
        "misleading": ((0, 0), (limit, 0), (limit, limit)),
        "hazardous": ((limit, 0), (right, 0), (right, end), (end, end), (limit, limit)),
    }
    for name, points in corners.items():
        text = " ".join(f"{across.at(x):.1f},{up.at(y):.1f}" for x, y in points)
        yield f'<polygon points="{text}" fill="{_COLOURS[name]}" fill-opacity=".10" class="region-{name}"/>'


def _lines(limit_mm: int, across: Axis, up: Axis) -> Iterator[str]:
    end = min(across.high, up.high)
    ends = f"M{across.begin:.1f} {up.begin:.1f}L{across.at(end):.1f} {up.at(end):.1f}"
    yield f'<path d="{ends}" class="ink" stroke-width="1"/>'
    x, y = across.at(limit_mm), up.at(limit_mm)
    for path in (f"M{LEFT} {y:.1f}H{RIGHT}", f"M{x:.1f} {up.end:.1f}V{up.begin:.1f}"):
        yield f'<path d="{path}" stroke="{RED}" stroke-width="1.6" stroke-dasharray="9 4" class="limit"/>'


def _cells(limit_mm: int, found: Reports, across: Axis, up: Axis) -> Iterator[str]:
    """Draw the steps, collected in cells: the more steps, the darker; failures are crosses."""
    cells: Counter[tuple[float, float, Region]] = Counter()
    for report in found.made:
        cells[_cell(limit_mm, report, across, up)] += report.steps
    most = math.log1p(max(cells.values()))
    for (x, y, name), count in sorted(cells.items()):
        if name in ("misleading", "hazardous"):
            yield cross(x + CELL / 2, y + CELL / 2, kind=f"step {name}", size=4)
        else:
            opacity = 0.3 + 0.7 * math.log1p(count) / most
            drawn = box(x, y, CELL, CELL, _COLOURS[name], kind=f"step {name}")
            yield f'<g fill-opacity="{opacity:.2f}">{drawn}</g>'


def _cell(limit_mm: int, report: Report, across: Axis, up: Axis) -> tuple[float, float, Region]:
    x, y = across.at(report.error), up.at(report.margin)
    return x // CELL * CELL, y // CELL * CELL, region(report.error, report.margin, limit_mm)


def _words(limit_mm: int, counts: Counter[Region], across: Axis, up: Axis) -> Iterator[str]:
    """Write name and number of steps into each region."""
    limit = float(limit_mm)
    places: dict[Region, tuple[float, float, str]] = {
        "nominal": (across.at(limit / 2), up.at(limit) + 18, "middle"),
        "unavailable": (across.at(limit / 2), up.end + 16, "middle"),
        "misleading": (across.at(limit) - 8, up.begin - 10, "end"),
        "hazardous": (across.end - 4, up.begin - 10, "end"),
    }
    for name, (x, y, anchor) in places.items():
        yield word(x, y, f"{name}: {counts[name]}", anchor=anchor)


def _keys(limit_mm: int, found: Reports, counts: Counter[Region]) -> list[Swatch]:
    total = sum(counts.values())
    keys = [box_swatch(_COLOURS[name], f"{name}: {_MEANT[name]}, {_share(counts[name], total)}") for name in REGIONS]
    keys.append(stroke_swatch(RED, f"alert limit, {metres(limit_mm)}", "9 4"))
    if found.silent:
        keys.append(Swatch("", f"nothing reported in {found.silent} of {total} steps"))
    if found.unknown:
        keys.append(Swatch("", f"{found.unknown} steps without a known truth are left out"))
    return keys


def _share(count: int, total: int) -> str:
    return f"{count} of {total} steps"
