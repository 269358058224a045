"""The style sheet that all pages share. On the pages of a report it tells in print when the report was made; other pages have no such time."""

from __future__ import annotations

from pathlib import Path

_WHEN = "safeloc report of {{ data.made }}"


def style_sheet() -> str:
    """Return the style sheet of a page outside of a report."""
    return Path(__file__).with_name("page.css").read_text(encoding="utf-8").replace(_WHEN, "safeloc")
