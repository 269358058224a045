"""The picture of a tube: what was recorded of a signal, in the band that is proved for all streams of the tube."""

from __future__ import annotations

from collections.abc import Sequence

from safeloc.report.plot import line_chart

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
    """Return the same with all values less the recorded one: a tube is often narrow against what it is drawn around."""
    lower, upper = (
        [None if value is None or at is None else value - at for value, at in zip(side, recorded, strict=True)]
        for side in band
    )
    zero = [None if value is None else 0.0 for value in recorded]
    title = f"{name}: proved bounds of all streams of the tube, less what was recorded"
    return _file(line_chart(title, unit, {title: zero}, (lower, upper), broken))


def _file(chart: str) -> str:
    if not chart:
        return ""
    head, _, rest = chart.partition(">")
    return f"{head}>{_STYLE}{rest}\n"
