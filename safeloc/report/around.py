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
    chart = line_chart(
        f"{name}: recorded, and proved bounds of all streams of the tube", unit, {name: recorded}, band, broken
    )
    if not chart:
        return ""
    head, _, rest = chart.partition(">")
    return f"{head}>{_STYLE}{rest}\n"
