"""The margins of a machine's figures on the page: a bar for each figure, and one row for each machine on the first page."""

from __future__ import annotations

import html
import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from safeloc.report.drawing import (
    BLUE,
    GREY,
    ORANGE,
    RED,
    Axis,
    across_axis,
    box_swatch,
    cross,
    legend,
    line,
    picture,
    stroke_swatch,
    styled,
    upright,
    upright_axis,
    word,
)
from safeloc.report.thinning import Point

_BEGIN, _OWN, _END = 310, 520, 790
"""Places of the factors 0, 1 and 10 on a picture."""
_MOST = 10
_ROW, _TOP = 24, 30
_Data = Mapping[str, Any]


def margins_shown(margins: _Data | None) -> dict[str, Any] | None:
    """Return what the page shows of a machine's margins: for each way in which figures move a table and a picture."""
    if margins is None:
        return None
    moved = [
        {
            "where": where,
            "rows": _rows(margins[where]),
            "picture": margins_picture(margins[where], where),
            "unmoved": _unmoved(margins[where]),
        }
        for where in ("world", "design")
        if where in margins
    ]
    fronts = [{**one, "picture": front_picture(one)} for one in margins.get("pairs", ())]
    if not moved and not fronts:
        return None
    return {"moved": moved, "fronts": fronts, "shipped": margins.get("shipped", "")}


def of_another_version(margins: _Data | None) -> str:
    """Return the day on which the margins that ship were found, if they are of another version of the machine; else nothing."""
    return str((margins or {}).get("other_version", ""))


def first_page_row(name: str, margins: _Data | None) -> dict[str, Any]:
    """Return the row of a machine on the first page: how many figures may not move at all, and which may move least."""
    rows = _moving((margins or {}).get("world", ()))
    broken = [one for one in rows if one["end"] == "broken"]
    none = [one for one in broken if one["margin"] == 0]
    some = sorted((one for one in broken if one["margin"] and one["value"]), key=_relative)
    return {
        "machine": name,
        "known": margins is not None and "world" in margins,
        "shipped": (margins or {}).get("shipped", ""),
        "other_version": of_another_version(margins),
        "figures": len({one["figure"] for one in rows}),
        "none": _by_figure(none),
        "least": [f"{one['figure']} {_percent(one)}" for one in some[:3]],
        "undecided": _by_figure([one for one in rows if one["end"] == "undecided"]),
    }


def _by_figure(limits: Sequence[_Data]) -> list[str]:
    """Return the figures of some limits, each once with its directions."""
    ways: dict[str, list[str]] = {}
    for one in limits:
        ways.setdefault(one["figure"], []).append(one["direction"])
    return [f"{figure} {' and '.join(sorted(found))}" for figure, found in ways.items()]


def _moving(limits: Sequence[_Data]) -> list[_Data]:
    """Return the limits of the figures on which something depends, be it in one direction alone."""
    moving = {one["figure"] for one in limits if not one["unmoved"]}
    return [one for one in limits if one["figure"] in moving]


def _unmoved(limits: Sequence[_Data]) -> list[str]:
    moving = {one["figure"] for one in _moving(limits)}
    return list(dict.fromkeys(one["figure"] for one in limits if one["figure"] not in moving))


def _relative(one: _Data) -> float:
    return abs(float(one["margin"]) / float(one["value"]))


def _percent(one: _Data) -> str:
    sign = "+" if one["direction"] == "up" else "\N{MINUS SIGN}"
    share = 100 * _relative(one)
    return f"{sign}{share:.2g} %" if share < 1000 else f"{sign}{share:.0f} %"


def _rows(limits: Sequence[_Data]) -> list[dict[str, Any]]:
    """Return the rows of the table, one for each figure that moves something, with its limit in both directions."""
    by_figure: dict[str, dict[str, Any]] = {}
    for one in _moving(limits):
        row = by_figure.setdefault(one["figure"], {"figure": one["figure"], "value": one["value"], "unit": one["unit"]})
        row[one["direction"]] = {**one, "told": _how_far(one)}
    return list(by_figure.values())


def _how_far(one: _Data) -> str:
    if one["margin"]:
        return f"to {one['holds_to']}"
    return "none" if one["end"] in ("broken", "undecided") else "stays"


def margins_picture(limits: Sequence[_Data], where: str) -> str:
    """Return a bar for each figure, from the least to the greatest factor of its value at which all claims are proved; "" for none."""
    rows = [row for row in _rows(limits) if row["value"]]
    if not rows:
        return ""
    bottom = _TOP + _ROW * len(rows)
    parts = [*_factors(bottom)]
    for number, row in enumerate(rows):
        parts += _bar(row, _TOP + _ROW * number)
    keys, end = legend(
        [
            box_swatch(BLUE, "every claim is proved as far as here"),
            stroke_swatch(RED, "\N{MULTIPLICATION SIGN} one unit farther a run breaks a claim"),
            stroke_swatch(ORANGE, "? undecided beyond"),
            stroke_swatch(GREY, "| its range ends, or a claim says nothing beyond"),
        ],
        bottom + 44,
    )
    title = f"how far each figure may move, in factors of its configured value ({where})"
    return picture([*parts, keys], end + 10, title)


def _place(factor: float) -> float:
    """Return the place of a factor: evenly up to 1, by its logarithm beyond."""
    if factor <= 1:
        return _BEGIN + (_OWN - _BEGIN) * max(0.0, factor)
    return _OWN + (_END - _OWN) * min(1.0, math.log10(factor) / math.log10(_MOST))


def _factors(bottom: float) -> Iterator[str]:
    """Yield the axis: factors of the configured value."""
    for factor in (0, 0.25, 0.5, 0.75, 1, 1.5, 2, 3, 5, _MOST):
        x = _place(factor)
        yield f'<path d="M{x:.1f} {_TOP - 6}V{bottom:.1f}" class="grid"/>' + word(
            x, bottom + 16, f"{factor:g}", anchor="middle"
        )
    yield upright(_OWN, _TOP - 6, bottom, "", kind="ink", dash="")


def _bar(row: _Data, y: float) -> Iterator[str]:
    value, low, high = row["value"], row["down"]["holds_to"], row["up"]["holds_to"]
    begin, end = sorted((_place(low / value), _place(high / value)))
    middle = y + _ROW / 2
    yield word(10, middle + 4, f"{row['figure']} = {value} {row['unit']}".rstrip())
    yield f'<rect x="{begin:.1f}" y="{y + 5:.1f}" width="{max(end - begin, 1.5):.1f}" height="{_ROW - 10}" fill="{BLUE}" fill-opacity=".45"><title>{html.escape(_told(row))}</title></rect>'
    apart = 6 if end - begin < 12 else 0  # so that the marks of a figure without a margin stand side by side
    yield _mark(row["down"]["end"], begin - apart, middle)
    yield _mark(row["up"]["end"], end + apart, middle)
    yield word(_END + 12, middle + 4, f"{low} \N{HORIZONTAL ELLIPSIS} {high}", soft=True)


def _told(row: _Data) -> str:
    return f"{row['figure']}: down {row['down']['in_words']}; up {row['up']['in_words']}"


def _mark(end: str, x: float, y: float) -> str:
    if end == "broken":
        return cross(x, y, kind="broken", size=5)
    if end == "undecided":
        return f'<text x="{x:.1f}" y="{y + 4:.1f}" text-anchor="middle" fill="{ORANGE}" style="font:bold 14px system-ui,sans-serif">?</text>'
    return f'<path d="M{x:.1f} {y - 7:.1f}V{y + 7:.1f}" stroke="{GREY}" stroke-width="2"/>'


def front_picture(front: _Data) -> str:
    """Return the Pareto front of two figures: the limit of the second one over values of the first; "" for fewer than two points."""
    points = [(first, second) for first, second, *_ in front["points"]]
    if len(points) < 2:
        return ""
    first, second = ([point[side] for point in points] for side in (0, 1))
    across, up = _axis(first, 150, 985), _axis(second, 330, 40)
    at = [Point(across.at(a), up.at(b)) for a, b in points]
    parts = [
        upright_axis(up, f"{front['second']}", unit=1),
        across_axis(across, 330, f"{front['first']}", unit=1),
        line([at], BLUE, kind="front"),
        *(line([[point]], BLUE, kind="point") for point in at),
    ]
    title = f"{front['name']}: as far as here every claim is proved"
    return picture(parts, 372, title)


def _axis(values: Sequence[float], begin: float, end: float) -> Axis:
    low, high = min(values), max(values)
    room = (high - low) * 0.06 or max(1.0, abs(high) * 0.06)
    return Axis(low - room, high + room, begin, end)


def alone(drawn: str) -> str:
    """Return a picture as the text of an SVG file, with the colours that the page gives it otherwise."""
    return styled(drawn, _STYLE)


_STYLE = (
    "<style>svg{background:#fff}.word{font:12px system-ui,sans-serif;fill:#1c2733}.word.soft{fill:#5c6b7a}.ink{stroke:#1c2733}"
    ".frame{fill:none;stroke:#d8dfe6}.grid{stroke:#d8dfe6;stroke-dasharray:3 4}</style>"
)
