"""The page of a campaign: what was asked, of how many vehicles, and every estimate with its interval."""

from __future__ import annotations

from collections.abc import Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any

from jinja2 import Environment, StrictUndefined
from markupsafe import Markup

from safeloc.report.style_sheet import style_sheet

_TEMPLATE = Path(__file__).with_name("campaign.html.jinja")


def campaign_page(data: Mapping[str, Any], pictures: Mapping[str, str]) -> str:
    """Return the page as text; `pictures` are drawings by caption."""
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    environment.filters |= {"share": share_words, "mm": _metres}
    return environment.from_string(_TEMPLATE.read_text(encoding="utf-8")).render(
        style=Markup(style_sheet()),
        data=data,
        pictures={caption: Markup(drawn) for caption, drawn in pictures.items() if drawn},
        version=version("safeloc"),
    )


def share_words(estimate: Mapping[str, Any] | None) -> str:
    """Return a share with its interval, as `0.012 (0.0095 to 0.015)`."""
    if estimate is None:
        return "not known"
    return f"{estimate['value']:.4g} ({estimate['low']:.4g} to {estimate['high']:.4g})"


def _metres(value: int | None) -> str:
    return "beyond all values" if value is None else f"{value / 1_000:.1f} m"
