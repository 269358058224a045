"""Pictures of a campaign: Stanford diagram, width and availability along the line, margins of situations, time until nothing is reported."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

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


@dataclass(frozen=True)
class Spread:
    """A figure with its interval; an end is None where nothing bounds it."""

    value: float
    low: float | None
    high: float | None


@dataclass(frozen=True)
class Stretch:
    """A stretch of the line, by the vehicles that were there.

    number     its place, in stretches from the beginning of the line
    vehicles   that were there; reporting: those of them that reported there
    told       mean share of a vehicle's cycles there with a report
    width_mm   mean of the reporting vehicles' mean widths; None without one
    widest_mm  the greatest width that was reported there
    """

    number: int
    vehicles: int
    told: Spread
    reporting: int
    width_mm: Spread | None
    widest_mm: int


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


def width_along_line(stretches: Mapping[str, Sequence[Stretch]], step_mm: int, confidence: float, title: str) -> str:
    """Return mean (full) and greatest (broken line) width of the interval in stretches of the line, a colour for each stratum, of many for the worst."""
    told = {name: [(one, one.width_mm) for one in rows if one.width_mm] for name, rows in stretches.items()}
    every = [one for rows in told.values() for one, _ in rows]
    if not every:
        return ""
    across = _line_axis(every, step_mm)
    up = Axis(0, max(one.widest_mm for one in every) * 1.1 + 1, _TOP + _TALL, _TOP)
    made = [upright_axis(up, "width in m")]
    colours = _colours({name: -max((one.widest_mm for one, _ in rows), default=0) for name, rows in told.items()})
    for name, colour in colours.items():
        means = [(across.at((one.number + 0.5) * step_mm), width) for one, width in told[name]]
        made += _with_band(means, up, colour, "width")
        widest = [Point(across.at((one.number + 0.5) * step_mm), up.at(one.widest_mm)) for one, _ in told[name]]
        made.append(line([widest], colour, kind="width", dash="5 3"))
    made.append(across_axis(across, up.begin, "place in m"))
    keys = [
        *_keys(colours, {}),
        stroke_swatch("#222", "mean of the vehicles"),
        stroke_swatch("#222", "greatest seen", "5 3"),
    ]
    drawn, y = legend(keys, up.begin + 62)
    beyond = f"{-math.log(1 - confidence):.1f} / (their number in the run)"
    says = (
        f"shaded: the mean at {confidence * 100:g} %, for each stretch by itself (empirical Bernstein; of widths up to twice the tolerance)",
        f"broken line: of vehicles that report there fewer than {beyond} are wider, at {confidence * 100:g} %",
    )
    return picture([*made, drawn, *_words_below(says, y)], y + 36, title)


def availability_along_line(
    stretches: Mapping[str, Sequence[Stretch]], step_mm: int, confidence: float, title: str
) -> str:
    """Return the share of a vehicle's cycles with a report in stretches of the line, a colour for each stratum, of many for the worst."""
    known = {name: rows for name, rows in stretches.items() if rows}
    if not known:
        return ""
    across = _line_axis([one for rows in known.values() for one in rows], step_mm)
    up = Axis(0, 1.02, _TOP + _TALL, _TOP)
    made = [upright_axis(up, "share of cycles", unit=1)]
    colours = _colours({name: sum(one.told.value for one in rows) / len(rows) for name, rows in known.items()})
    for name, colour in colours.items():
        shares = [(across.at((one.number + 0.5) * step_mm), one.told) for one in known[name]]
        made += _with_band(shares, up, colour, "availability")
    made.append(across_axis(across, up.begin, "place in m"))
    drawn, y = legend(_keys(colours, {}), up.begin + 62)
    says = f"mean over the vehicles that were there; shaded: at {confidence * 100:g} %, for each stretch by itself (empirical Bernstein)"
    return picture([*made, drawn, *_words_below((says,), y)], y + 22, title)


def _line_axis(stretches: Sequence[Stretch], step_mm: int) -> Axis:
    numbers = [one.number for one in stretches]
    return Axis(min(numbers) * step_mm, (max(numbers) + 1) * step_mm, LEFT, RIGHT)


def _with_band(points: Sequence[tuple[float, Spread]], up: Axis, colour: str, kind: str) -> list[str]:
    """Return a curve, and the band of its intervals where it has a colour of its own."""
    made = []
    bounded = [(x, one.low, one.high) for x, one in points if one.low is not None and one.high is not None]
    if colour != _OTHERS and bounded:
        above = [(x, up.at(min(up.high, high))) for x, _, high in bounded]
        below = [(x, up.at(max(up.low, low))) for x, low, _ in reversed(bounded)]
        made.append(_band([*above, *below], colour))
    return [*made, line([[Point(x, up.at(one.value)) for x, one in points]], colour, kind=kind)]


def _words_below(says: Sequence[str], y: float) -> list[str]:
    return [word(LEFT, y + 8 + 14 * number, one, soft=True) for number, one in enumerate(says)]


def margins_of_situations(margins: Mapping[str, Sequence[Spread]], confidence: float, title: str) -> str:
    """Return a row for each stratum with any report: from the smallest margin of its vehicles to the median, with a dot and an interval at each.

    margins  least, 1 %, 10 % and median of the vehicles' smallest margins, mm; below 0 the interval misses the truth
    """
    known = {name: rows for name, rows in margins.items() if rows}
    if not known:
        return ""
    every = [end for rows in known.values() for one in rows for end in (one.value, one.high) if end is not None]
    low, high = min(every), max(every)
    room = (high - low) * 0.03 + 1
    across, bottom = Axis(min(0, low) - room, max(0, high) + room, LEFT, RIGHT), _TOP + 34 * len(known)
    made = [
        upright(across.at(0), _TOP - 12, bottom, "#222", kind="truth"),
        across_axis(across, bottom, "smallest margin in m"),
    ]
    for number, (name, rows) in enumerate(known.items()):
        y, colour = _TOP + 34 * number + 16, _COLOURS[1] if rows[0].value < 0 else _COLOURS[0]
        made.append(word(LEFT, y - 8, name))
        made += [_interval(one, across, y, colour) for one in rows[1:]]
        made.append(line([[Point(across.at(one.value), y) for one in (rows[0], rows[-1])]], colour, kind="margin"))
        made += [line([[Point(across.at(one.value), y)]], colour, kind="quantile") for one in rows]
    says = (
        "dots: the least margin, and 1 %, 10 % and half of the vehicles below; left of the broken line the interval misses the truth",
        f"shaded: each of these three at {confidence * 100:g} % (order statistics), to the picture's edge where so few vehicles do not bound it",
        f"least: of vehicles that report fewer than {-math.log(1 - confidence):.1f} / (their number in the run) have a smaller one, at {confidence * 100:g} %",
    )
    return picture([*made, *_words_below(says, bottom + 48)], bottom + 96, title)


def _interval(one: Spread, across: Axis, y: float, colour: str) -> str:
    """Return the interval of a quantile as a bar."""
    begin = across.begin if one.low is None else across.at(one.low)
    end = across.end if one.high is None else across.at(one.high)
    return _band([(begin, y - 5), (end, y - 5), (end, y + 5), (begin, y + 5)], colour)


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
    return _band([*above, *below], colour)


def _band(corners: Sequence[tuple[float, float]], colour: str) -> str:
    points = " ".join(f"{x:.1f},{y:.1f}" for x, y in corners)
    return f'<polygon points="{points}" fill="{colour}" fill-opacity=".22" class="confidence"/>'


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
