"""The page in a browser, opened from disk: its parts open, and what is missing, damaged or foreign is told in its place.

Left out where there is no Chromium.
"""

from __future__ import annotations

import re
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest

from safeloc.report import page as page_module
from safeloc.report.folder import write_folder
from tests.report.test_page import door, findings

BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
pytestmark = [pytest.mark.skipif(BROWSER is None, reason="no Chromium here"), pytest.mark.slow]
WATCH = """<script>addEventListener("error", (e) => { document.title = "error " + (e.message || "") });
addEventListener("load", () => document.getElementById("open-all").click())</script>"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A report in parts, of which every part is asked for as soon as it is opened."""
    monkeypatch.setattr(page_module, "MOST_OF_ONE_PAGE", 0)
    named = replace(findings()[0], id=f"door/property/{door().properties[0].name}")
    page = write_folder(tmp_path / "report", [*findings(), named], [door()])
    page.write_text(page.read_text(encoding="utf-8").replace("</body>", f"{WATCH}</body>"), encoding="utf-8")
    return page.parent


def seen(folder: Path) -> str:
    """The page as it stands when everything has been loaded."""
    assert BROWSER is not None
    options = ["--headless", "--no-sandbox", "--disable-gpu", "--virtual-time-budget=10000", "--dump-dom"]
    profile = f"--user-data-dir={folder.parent / 'profile'}"
    page = (folder / "index.html").as_uri()
    done = subprocess.run([BROWSER, *options, profile, page], capture_output=True, text=True, check=True, timeout=120)
    assert "<title>error" not in done.stdout
    return done.stdout


def told(page: str, part: str) -> str:
    """What stands in the place of a part."""
    found = re.search(rf'data-part="page/{part}\.js".*?<div[^>]*>(.*?)</div>', page, re.DOTALL)
    assert found is not None
    return found[1]


def test_parts_open(folder: Path) -> None:
    """Each in its place, without a warning."""
    page = seen(folder)
    assert "<h3>Property tests and replayed recordings</h3>" in page
    assert '<table class="transitions">' in page
    assert page.count(' data-shown=""') == 3
    assert re.search(r'<p id="beside"[^>]*hidden', page)


def test_a_link_opens_the_part_that_has_its_place(folder: Path) -> None:
    """Source lines of a property are in the part of its machine; a click on the link shows them, and opens no other part."""
    page = folder / "index.html"
    text = page.read_text(encoding="utf-8")
    click = """document.querySelector('a[href^="#source-"]').click()"""
    assert 'document.getElementById("open-all").click()' in text
    page.write_text(text.replace('document.getElementById("open-all").click()', click), encoding="utf-8")
    shown = seen(folder)
    assert shown.count(' data-shown=""') == 1
    assert 'id="source-door-' in shown
    assert told(shown, "conditions") == ""


def test_parts_that_are_gone(folder: Path) -> None:
    """A page that was taken alone says so at its head and in every place."""
    shutil.rmtree(folder / "page")
    page = seen(folder)
    assert "The files beside this page (folder `page`) are missing: the parts of this page cannot be opened" in page
    assert told(page, "door").startswith("page/door.js is missing beside this page; ")


def test_a_part_that_is_damaged(folder: Path) -> None:
    """Cut in the middle, or of other letters."""
    path = folder / "page" / "door.js"
    whole = path.read_text(encoding="utf-8")
    path.write_text(whole.replace('", "H4s', '", "X4s'), encoding="utf-8")
    assert told(seen(folder), "door").startswith("page/door.js is damaged; ")
    path.write_text("", encoding="utf-8")
    assert told(seen(folder), "door").startswith("page/door.js is damaged; ")


def test_parts_of_another_report(folder: Path) -> None:
    """They are never shown under this report's verdicts."""
    for path in (folder / "page").iterdir():
        path.write_text(
            re.sub(r'"[0-9a-f]{16}"', '"0123456789abcdef"', path.read_text(encoding="utf-8")), encoding="utf-8"
        )
    page = seen(folder)
    assert "The files beside this page are of another report" in page
    assert told(page, "door").startswith("page/door.js is of another report than this page; ")
