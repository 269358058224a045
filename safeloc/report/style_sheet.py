"""The style sheet that all pages of a report share; it stands in the first page's template."""

from __future__ import annotations

from pathlib import Path

_PAGE = Path(__file__).with_name("page.html.jinja")


def style_sheet() -> str:
    """Return the style sheet."""
    text = _PAGE.read_text(encoding="utf-8")
    return text[text.index("<style>") + len("<style>") : text.index("</style>")]
