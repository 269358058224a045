"""A Chromium without a window, for tests of the pages; they are left out, with the reason, where it or its driver is missing."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

PHONE, DESK = (390, 844), (1300, 900)
RIGHT, LEFT, DOWN, ENTER, ESCAPE, END, SHIFT = "\ue014", "\ue012", "\ue015", "\ue007", "\ue00c", "\ue010", "\ue008"


class Page:
    """The browser with a page: what it shows, keys, and everything that its console said."""

    def __init__(self, driver: Any) -> None:
        self.driver = driver

    def open(self, path: Path, place: str = "") -> None:
        """Open a file, at a place in it; what the console said before is forgotten."""
        self.driver.get("about:blank")
        self.driver.get_log("browser")
        self.driver.get(path.as_uri() + place)

    def js(self, text: str, *given: Any) -> Any:
        """Return the value of an expression."""
        return self.driver.execute_script(f"return ({text});", *given)

    def until(self, text: str, *given: Any) -> Any:
        """Wait until an expression is true, and return its value."""
        from selenium.webdriver.support.ui import WebDriverWait

        return WebDriverWait(self.driver, 30, 0.05).until(lambda _: self.js(text, *given), message=text)

    def text(self, selector: str) -> str:
        """Return the text of an element."""
        return str(self.js("document.querySelector(arguments[0]).textContent", selector)).strip()

    def click(self, selector: str) -> None:
        """Click on an element."""
        self.driver.find_element("css selector", selector).click()

    def follow(self, words: str) -> None:
        """Click on the link with these words, as soon as it is there."""
        self.until("[...document.querySelectorAll('a')].some(a => a.textContent === arguments[0])", words)
        self.driver.find_element("link text", words).click()

    def type(self, selector: str, *keys: str) -> None:
        """Send keys to an element."""
        self.driver.find_element("css selector", selector).send_keys(*keys)

    def press(self, *keys: str) -> None:
        """Send keys to whatever has the focus."""
        self.driver.switch_to.active_element.send_keys(*keys)

    def said(self) -> list[str]:
        """Return all messages of the console since the page was opened."""
        return [entry["message"] for entry in self.driver.get_log("browser")]

    def dark(self, wanted: bool) -> None:
        """Choose the colours of the night, or of the day."""
        scheme = {"name": "prefers-color-scheme", "value": "dark" if wanted else "light"}
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [scheme]})

    def size(self, width: int, height: int) -> None:
        """Choose the size of the screen."""
        screen = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", screen)

    def barriers(self) -> list[str]:
        """Return what axe calls a serious or critical barrier, with the places."""
        import axe_core_python

        source = Path(axe_core_python.__file__).with_name("axe.min.js").read_text(encoding="utf-8")
        self.driver.execute_script(source)
        found = self.driver.execute_async_script(
            "const done = arguments[0]; axe.run({resultTypes: ['violations']}).then(({violations}) => done(violations))"
        )
        return [
            f"{one['id']}: {node['target']} {node.get('failureSummary', '')}"
            for one in found
            if one["impact"] in ("serious", "critical")
            for node in one["nodes"]
        ]

    def barriers_piece_by_piece(self, nodes: int = 1500) -> list[str]:
        """Return the barriers of a large page: of its children a few at a time, all others taken out, long tables without their end.

        Axe compares the contrast of every text with all that lies over it, and takes minutes for tens of thousands of elements. The
        page is not as it was afterwards.
        """
        sizes = self.js(_LAID_OUT)
        groups: list[list[int]] = [[]]
        for at, size in enumerate(sizes):
            if groups[-1] and sum(sizes[one] for one in groups[-1]) + size > nodes:
                groups.append([])
            groups[-1].append(at)
        found = list[str]()
        for group in groups:
            self.driver.execute_script(
                "document.querySelector('main').replaceChildren(...arguments[0].map(at => window.pieces[at]))", group
            )
            found += self.barriers()
        return found


_LAID_OUT = """(() => {
    const main = document.querySelector('main'), most = 40;
    for (const details of main.querySelectorAll('details:not(.part)')) details.open = true;
    for (const table of main.querySelectorAll('tbody')) for (const row of [...table.rows].slice(most)) row.remove();
    window.pieces = [...main.children];
    return window.pieces.map(one => one.querySelectorAll('*').length + 1);
})()"""


@contextmanager
def chromium() -> Iterator[Page]:
    """Start the browser, and quit it in the end; skip the test where it is missing."""
    selenium = pytest.importorskip("selenium.webdriver", reason="selenium is not installed; it is in the extra dev")
    pytest.importorskip("axe_core_python", reason="axe-core-python is not installed; it is in the extra dev")
    program, driver = shutil.which("chromium"), shutil.which("chromedriver")
    if program is None or driver is None:
        pytest.skip("chromium and chromedriver are not installed; Debian's packages are chromium and chromium-driver")
    options = selenium.ChromeOptions()
    options.binary_location = program
    for option in ("--headless", "--no-sandbox", "--disable-gpu", "--disable-background-networking", "--disable-sync"):
        options.add_argument(option)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    started = selenium.Chrome(options=options, service=selenium.ChromeService(driver))
    started.set_script_timeout(60)
    try:
        yield Page(started)
    finally:
        started.quit()


def runs_of(report: Path) -> Path:
    """The page that shows the runs of a report."""
    beside = report.with_name("run.html")
    return beside if beside.exists() else report


def opened(page: Page, path: Path, place: str = "") -> None:
    """Open the run of a place."""
    page.open(path, place)
    page.until("document.getElementById('run-said').textContent !== ''")
