"""The picture of a tube: what was recorded of a signal, in the band that is proved for all streams of the tube."""

from __future__ import annotations

import math
from collections.abc import Sequence

from safeloc.report.plot import HEIGHT, LEFT, line_chart, line_of_text

_STYLE = (
    "<style>text{font:11px system-ui,sans-serif;fill:#222}.frame{fill:none;stroke:#c8ced3}"
    ".grid{stroke:#c8ced3;stroke-dasharray:3 4}.band{fill:#1f6fb2;opacity:.22}svg{background:#fff}</style>"
)


def tube_picture(
    name: str,
    unit: str,
    recorded: Sequence[float | None],
    band: tuple[Sequence[float | None], Sequence[float | None]],
    broken: int | None = None,
) -> str:
    """Return an SVG file's text; "" for a signal of which nothing is known.

    broken  the cycle in which the nearest stream breaks a claim
    """
    title = f"{name}: recorded, and proved bounds of all streams of the tube"
    return _file(line_chart(title, unit, {name: recorded}, band, broken))


def deviation_picture(
    name: str,
    unit: str,
    recorded: Sequence[float | None],
    band: tuple[Sequence[float | None], Sequence[float | None]],
    broken: int | None = None,
) -> str:
    """Return the same with all values less the recorded one: a tube is often narrow against what it is drawn around.

    Where it is very wide in a few cycles it is cut off there, and the picture says so: else nothing of the others could be seen.
    """
    lower, upper = (
        [None if value is None or at is None else value - at for value, at in zip(side, recorded, strict=True)]
        for side in band
    )
    most = _most_shown([max(abs(low or 0), abs(high or 0)) for low, high in zip(lower, upper, strict=True)])
    zero = [None if value is None else 0.0 for value in recorded]
    title = f"{name}: proved bounds of all streams of the tube, less what was recorded"
    shown = tuple([None if one is None else min(most, max(-most, one)) for one in side] for side in (lower, upper))
    chart = line_chart(title, unit, {title: zero}, (shown[0], shown[1]), broken)
    return _file(_with_note(chart, _cut_off(lower, upper, most, unit)))


_USUAL, _TIMES = 0.9, 3.0
"""The share of the cycles that a picture has to show well, and how many times their greatest deviation it shows."""


def _most_shown(values: Sequence[float]) -> float:
    """Return the deviation at which a picture is cut off: a multiple of that which most cycles keep to, or the greatest."""
    known = sorted(one for one in values if one)
    if not known:
        return math.inf
    return min(known[-1], _TIMES * known[int(_USUAL * (len(known) - 1))])


def _cut_off(lower: Sequence[float | None], upper: Sequence[float | None], most: float, unit: str) -> str:
    """Return how many cycles a picture cuts off, and the widest of them; "" for none."""
    beyond = [
        (abs(one), one, cycle)
        for side in (lower, upper)
        for cycle, one in enumerate(side)
        if one is not None and abs(one) > most
    ]
    if not beyond:
        return ""
    _, widest, cycle = max(beyond)
    cycles = len({cycle for _, _, cycle in beyond})
    some = "1 cycle" if cycles == 1 else f"{cycles} cycles"
    return f"cut off at \N{PLUS-MINUS SIGN}{most:g} {unit} in {some}; widest in cycle {cycle}: {widest:+g} {unit}"


def _with_note(chart: str, note: str) -> str:
    """Return a chart with words below it."""
    if not chart or not note:
        return chart
    return chart.removesuffix("</svg>") + line_of_text(LEFT + 90, HEIGHT - 12, note) + "</svg>"


def _file(chart: str) -> str:
    if not chart:
        return ""
    head, _, rest = chart.partition(">")
    return f"{head}>{_STYLE}{rest}\n"
