"""One Chromium for all tests of the pages."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.report.browser import DESK, Page, chromium


@pytest.fixture(scope="session")
def browser() -> Iterator[Page]:
    """The browser of all tests of a process."""
    with chromium() as started:
        yield started


@pytest.fixture
def page(browser: Page) -> Page:
    """The browser, by day and at a desk."""
    browser.dark(False)
    browser.size(*DESK)
    return browser
