"""Pictures of a campaign: Stanford diagram, width and availability along the line, margins of situations, time until nothing is reported."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from safeloc.report.drawing import (
    LEFT,
    PALETTE,
    RIGHT,
    Axis,
    Swatch,
    across_axis,
    legend,
    line,
    picture,
    stroke_swatch,
    styled,
    upright,
    upright_axis,
    word,
)
from safeloc.report.stanford import Report, Reports, stanford_diagram
from safeloc.report.thinning import Point

_TOP, _TALL = 28, 260
_COLOURS = PALETTE[1:]
_OTHERS = "#c8ced3"
_STYLE = (
    "<style>.picture text{font:11px system-ui,sans-serif;fill:#222}.picture .frame{fill:none;stroke:#c8ced3}"
    ".picture path.ink{stroke:#222}.picture .grid{stroke:#c8ced3;stroke-dasharray:3 4}.picture{background:#fff}</style>"
)


def stanford_of_cells(
    cells: Sequence[tuple[int, int, str, int]], silent: int, limit_mm: int, cells_to_limit: int, title: str
) -> str:
    """Return the Stanford diagram of counted cells: error, margin, contained or wrong, vehicle-cycles."""
    size = limit_mm / cells_to_limit
    made = []
    for x, y, name, cycles in cells:
        error, margin = (x + 0.5) * size, (y + 0.5) * size
        if name == "contained":
            error = min(error, margin)
        else:
            error = max(error, margin + size / 10)
        made.append(Report(error, margin, cycles))
    return stanford_diagram(Reports(tuple(made), silent, 0), limit_mm, title)


def width_along_line(
    stretches: Mapping[str, Sequence[tuple[int, int, int, int, int]]], step_mm: int, title: str
) -> str:
    """Return mean (full) and greatest (broken line) width of the interval in stretches of the line, a colour for each stratum, of many for the worst.

    stretches  stretch, cycles, those with a report, mean and greatest width in mm
    """
    told = {name: [one for one in rows if one[2]] for name, rows in stretches.items()}
    every = [one for rows in told.values() for one in rows]
    if not every:
        return ""
    across = Axis(min(one[0] for one in every) * step_mm, (max(one[0] for one in every) + 1) * step_mm, LEFT, RIGHT)
    up = Axis(0, max(one[4] for one in every) * 1.1 + 1, _TOP + _TALL, _TOP)
    made = [upright_axis(up, "width in m")]
    colours = _colours({name: -max((one[4] for one in rows), default=0) for name, rows in told.items()})
    for name, colour in colours.items():
        for column, dash in ((3, ""), (4, "5 3")):
            points = [Point(across.at((one[0] + 0.5) * step_mm), up.at(one[column])) for one in told[name]]
            made.append(line([points], colour, kind="width", dash=dash))
    made.append(across_axis(across, up.begin, "place in m"))
    keys = [*_keys(colours, {}), stroke_swatch("#222", "mean"), stroke_swatch("#222", "greatest", "5 3")]
    drawn, y = legend(keys, up.begin + 62)
    return picture([*made, drawn], y, title)


def availability_along_line(
    stretches: Mapping[str, Sequence[tuple[int, int, int, int, int]]], step_mm: int, title: str
) -> str:
    """Return the share of vehicle-cycles with a report in stretches of the line, a colour for each stratum, of many for the worst. `stretches` as for the width."""
    every = [one for rows in stretches.values() for one in rows]
    if not every:
        return ""
    across = Axis(min(one[0] for one in every) * step_mm, (max(one[0] for one in every) + 1) * step_mm, LEFT, RIGHT)
    up = Axis(0, 1.02, _TOP + _TALL, _TOP)
    made = [upright_axis(up, "share of cycles", unit=1)]
    known = {name: rows for name, rows in stretches.items() if rows}
    colours = _colours(
        {name: sum(one[2] for one in rows) / sum(one[1] for one in rows) for name, rows in known.items()}
    )
    for name, colour in colours.items():
        points = [Point(across.at((one[0] + 0.5) * step_mm), up.at(one[2] / one[1])) for one in known[name]]
        made.append(line([points], colour, kind="availability"))
    made.append(across_axis(across, up.begin, "place in m"))
    drawn, y = legend(_keys(colours, {}), up.begin + 62)
    return picture([*made, drawn], y, title)


def margins_of_situations(margins: Mapping[str, Sequence[int]], title: str) -> str:
    """Return a row for each stratum with any report: from the smallest margin of its vehicles to the median, with a dot at each.

    margins  least, 1 %, 10 % and median of the vehicles' smallest margins, mm; below 0 the interval misses the truth
    """
    known = {name: rows for name, rows in margins.items() if rows}
    if not known:
        return ""
    low, high = (pick(one for rows in known.values() for one in rows) for pick in (min, max))
    room = (high - low) * 0.03 + 1
    across, bottom = Axis(min(0, low) - room, max(0, high) + room, LEFT, RIGHT), _TOP + 34 * len(known)
    made = [
        upright(across.at(0), _TOP - 12, bottom, "#222", kind="truth"),
        across_axis(across, bottom, "smallest margin in m"),
    ]
    for number, (name, rows) in enumerate(known.items()):
        y, colour = _TOP + 34 * number + 16, _COLOURS[1] if rows[0] < 0 else _COLOURS[0]
        made.append(word(LEFT, y - 8, name))
        made.append(line([[Point(across.at(rows[0]), y), Point(across.at(rows[-1]), y)]], colour, kind="margin"))
        made += [line([[Point(across.at(one), y)]], colour, kind="quantile") for one in rows]
    says = "dots: the least margin, and 1 %, 10 % and half of the vehicles below; left of the broken line the interval misses the truth"
    return picture([*made, word(LEFT, bottom + 56, says, soft=True)], bottom + 68, title)


def times_until_silent(
    times: Mapping[str, Sequence[tuple[int, int]]], period_ms: Mapping[str, int], confidence: float, title: str
) -> str:
    """Return the share of vehicles that report nothing any more after some time, with the band that holds at all times at once (DKW).

    times  of each stratum: cycles (-1: not until the end of the run), vehicles
    """
    known = {name: rows for name, rows in times.items() if rows}
    ends = [cycles * period_ms[name] for name, rows in known.items() for cycles, _ in rows if cycles >= 0]
    if not known:
        return ""
    across, up = Axis(0, max(ends, default=0) * 1.05 + 1_000, LEFT, RIGHT), Axis(0, 1.02, _TOP + _TALL, _TOP)
    made = [upright_axis(up, "share of vehicles", unit=1)]
    totals = {name: sum(vehicles for _, vehicles in rows) for name, rows in known.items()}
    withdrawn = {
        name: [(cycles * period_ms[name], vehicles) for cycles, vehicles in rows if cycles >= 0]
        for name, rows in known.items()
    }
    colours = _colours({name: sum(vehicles for _, vehicles in rows) / totals[name] for name, rows in withdrawn.items()})
    for name, colour in colours.items():
        points = _steps(withdrawn[name], totals[name], across.high)
        if colour != _OTHERS:
            room = math.sqrt(math.log(2 / (1 - confidence)) / (2 * totals[name]))
            made.append(_around(points, room, across, up, colour))
        made.append(line([[Point(across.at(x), up.at(y)) for x, y in points]], colour, kind="withdrawn"))
    made.append(across_axis(across, up.begin, "time in s"))
    drawn, y = legend(_keys(colours, {name: f": {total} vehicles" for name, total in totals.items()}), up.begin + 62)
    band_says = (
        f"shaded: the band that holds the whole curve at {confidence * 100:g} % (Dvoretzky, Kiefer, Wolfowitz, Massart)"
    )
    return picture([*made, drawn, word(LEFT, y + 8, band_says, soft=True)], y + 22, title)


def _around(points: Sequence[tuple[float, float]], room: float, across: Axis, up: Axis, colour: str) -> str:
    """Return the band around a curve of steps, which is of steps too."""
    above = [(across.at(x), up.at(min(1.0, y + room))) for x, y in points]
    below = [(across.at(x), up.at(max(0.0, y - room))) for x, y in reversed(points)]
    corners = " ".join(f"{x:.1f},{y:.1f}" for x, y in [*above, *below])
    return f'<polygon points="{corners}" fill="{colour}" fill-opacity=".22" class="confidence"/>'


def _steps(times: Sequence[tuple[int, int]], total: int, end: float) -> list[tuple[float, float]]:
    points, share = [(0.0, 0.0)], 0.0
    for time, vehicles in times:
        points.append((float(time), share))
        share += vehicles / total
        points.append((float(time), share))
    return [*points, (end, share)]


def _colours(goodness: Mapping[str, float]) -> dict[str, str]:
    """Return the colour of each stratum, in the order of drawing: the worst have one each, all others are grey and below them."""
    worst = sorted(goodness, key=goodness.__getitem__)[: len(_COLOURS)]
    own = dict(zip((name for name in goodness if name in worst), _COLOURS, strict=False))
    return dict.fromkeys((name for name in goodness if name not in own), _OTHERS) | own


def _keys(colours: Mapping[str, str], more: Mapping[str, str]) -> list[Swatch]:
    """Return the swatches of the legend: one for each stratum with a colour of its own, and one for all others."""
    keys = [stroke_swatch(colour, name + more.get(name, "")) for name, colour in colours.items() if colour != _OTHERS]
    others = len(colours) - len(keys)
    return [
        *keys,
        *([stroke_swatch(_OTHERS, f"{others} other situations (the page has their figures)")] if others else []),
    ]


def with_style(drawn: str) -> str:
    """Return a picture with its style, for a file of its own and for the page."""
    return styled(drawn, _STYLE)
