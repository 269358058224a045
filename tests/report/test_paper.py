"""The report on paper: everything that was not open is printed too, one machine by itself, and the page is as before afterwards."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from safeloc.catalogue import load_target
from safeloc.report import page as page_module
from safeloc.report.folder import write_folder
from tests.report import lamp
from tests.report.browser import Page
from tests.report.test_browser import BROWSER
from tests.report.test_page import door, findings

pytestmark = pytest.mark.slow
UNSEEN = "[...document.querySelectorAll('main > *')].filter(one => one.offsetParent === null).map(one => one.dataset.machine ?? '')"


@pytest.fixture
def report(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A report of two machines in parts."""
    monkeypatch.setattr(page_module, "MOST_OF_ONE_PAGE", 0)
    return write_folder(tmp_path / "report", [*findings(), *lamp.findings()], [door(), lamp.target()])


def on_paper(page: Page, wanted: bool) -> None:
    """Show the page as it is printed, or as on a screen."""
    page.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print" if wanted else ""})


def test_one_machine_is_printed_alone(page: Page, report: Path) -> None:
    """Its part is opened and no other; the other machine is not on paper; numbers of terms are links again afterwards."""
    page.open(report)
    links = "document.querySelectorAll('.term a').length"
    page.driver.execute_script(f"window.print = () => (window.printed = {links})")
    page.click("section[data-machine=lamp] .print-one")
    page.until("window.printed !== undefined")
    assert 0 == page.js("window.printed")
    assert ["lamp"] == page.js(
        "[...document.querySelectorAll('[data-shown]')].map(one => one.closest('section').dataset.machine)"
    )
    on_paper(page, True)
    try:
        assert "door" in page.js(UNSEEN)
        assert "lamp" not in page.js(UNSEEN)
    finally:
        on_paper(page, False)
    page.js("dispatchEvent(new Event('afterprint'))")
    assert page.js("!document.documentElement.classList.contains('prints-one')")
    assert "door" not in page.js(UNSEEN)


@pytest.mark.parametrize(("place", "parts"), [("#print", 4), ("#print=lamp", 1)])
def test_an_address_is_ready_to_be_printed(page: Page, report: Path, place: str, parts: int) -> None:
    """By a program that opens it: what is to be printed is open, without a click."""
    page.open(report, place)
    page.until("document.documentElement.dataset.printable !== undefined")
    assert parts == page.js("document.querySelectorAll('details.part[data-shown]').length")
    assert [] == page.said()


def test_a_machine_that_is_not_there_is_told(page: Page, report: Path) -> None:
    """At the head of the page, and nothing is opened for it."""
    page.open(report, "#print=torch")
    assert "this report has no machine torch" == page.until("document.getElementById('beside').textContent")
    assert 0 == page.js("document.querySelectorAll('[data-shown]').length")


def test_a_program_prints_all_of_it(report: Path, tmp_path: Path) -> None:
    """The command of docs/report.md: the PDF has what stands in parts that nobody opened."""
    if BROWSER is None:
        pytest.skip("no Chromium here")
    pdf = tmp_path / "report.pdf"
    options = [
        "--headless",
        "--no-sandbox",
        "--disable-pdf-tagging",
        "--virtual-time-budget=60000",
        f"--print-to-pdf={pdf}",
    ]
    address = f"{report.as_uri()}#print"
    subprocess.run([BROWSER, *options, f"--user-data-dir={tmp_path / 'profile'}", address], check=True, timeout=120, capture_output=True)  # fmt: skip
    bare = tmp_path / "bare.pdf"
    subprocess.run([BROWSER, *options[:-1], f"--print-to-pdf={bare}", f"--user-data-dir={tmp_path / 'profile'}", report.as_uri()], check=True, timeout=120, capture_output=True)  # fmt: skip
    assert pages(pdf) > pages(bare) > 1


def pages(pdf: Path) -> int:
    """The number of pages of a PDF."""
    return pdf.read_bytes().count(b"/Type /Page\n") or pdf.read_bytes().count(b"/Type /Page/")


def test_conditions_are_narrowed(page: Page, tmp_path: Path) -> None:
    """To one owner, and to those with a figure from memory; how many are left is said, and on paper all stand."""
    page.open(write_folder(tmp_path / "odometry", [], [load_target("odometry")]))
    rows = "[...document.querySelectorAll('table.conditions tr[data-owner]')]"
    every = page.js(f"{rows}.length")
    owner = page.js("document.querySelector('[data-narrows=owner] option:nth-child(2)').value")
    page.driver.execute_script("const s = document.querySelector('[data-narrows=owner]'); s.value = arguments[0]; s.dispatchEvent(new Event('change', {bubbles: true}))", owner)  # fmt: skip
    left = page.js(f"{rows}.filter(row => row.offsetParent).map(row => row.dataset.owner)")
    assert set(left) == {owner}
    assert 0 < len(left) < every
    page.click("[data-narrows=confirm]")
    confirmed = page.js(f"{rows}.filter(row => row.offsetParent).length")
    assert 0 < confirmed <= len(left)
    assert f"{confirmed} of {every}" == page.text(".narrows [role=status]")
    on_paper(page, True)
    try:
        assert every == page.js(f"{rows}.filter(row => row.offsetParent).length")
    finally:
        on_paper(page, False)
