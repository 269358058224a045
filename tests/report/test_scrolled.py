"""What is wider than its place, in a browser: it is reached and scrolled by key, and nothing of a run is cut off."""

from __future__ import annotations

from pathlib import Path

import pytest

from safeloc.report import page as page_module
from safeloc.report.folder import write_folder
from tests.report.browser import DESK, PHONE, RIGHT, Page, opened, runs_of
from tests.report.test_page import door, findings

WIDE = "[...document.querySelectorAll('.scroll, pre')].filter(e => e.checkVisibility({contentVisibilityAuto: true}) && e.scrollWidth > e.clientWidth + 1)"


def test_what_is_too_wide_is_scrolled_by_key(page: Page, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """On a phone each wide table takes the focus, also in a part that was opened, and the arrow key moves it; at a desk it fits, and does not."""
    monkeypatch.setattr(page_module, "MOST_OF_ONE_PAGE", 0)
    page.size(*PHONE)
    page.open(write_folder(tmp_path, findings(), [door()]))
    page.click("#open-all")
    page.until("document.querySelectorAll('details.part[data-shown]').length === 3")
    page.js("document.querySelectorAll('details').forEach(one => one.open = true)")
    page.js("document.querySelector('table.transitions').scrollIntoView()")
    page.until(f"{WIDE}.length > 1 && {WIDE}.every(one => one.tabIndex === 0)")
    page.js(f"(window.widest = {WIDE}[0]).focus()")
    page.press(RIGHT)
    page.until("widest.scrollLeft > 0")
    page.size(*DESK)
    page.until("widest.scrollWidth <= widest.clientWidth && widest.tabIndex === -1")


def test_every_button_of_the_values_is_seen(page: Page, tmp_path: Path) -> None:
    """The table of values is as wide as its place, so that the button for a chart is not cut off: at a desk, a laptop, a narrow window."""
    opened(page, runs_of(write_folder(tmp_path, findings(), [door()])), "#result=door%2Fproperty%2Fbad+%3Cb%3E")
    for width in (1920, 1280, 1120, 1000, 920):
        page.size(width, 800)
        assert page.js("(box => box.scrollWidth <= box.clientWidth)(document.querySelector('.values'))"), width
