"""The report of all machines that ship, in a browser: no barrier, and every place once, on its first page and in each of its parts."""

from __future__ import annotations

from pathlib import Path

import pytest

from safeloc.catalogue import ENTRIES, load_target
from safeloc.language.verdict import NotAsked
from safeloc.proof.results import Finding
from safeloc.report.folder import write_folder
from tests.report.browser import Page

pytestmark = pytest.mark.slow
LARGEST = ("localizer", "conditions")


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The page, in which each property is a row that nobody has asked about."""
    targets = list(map(load_target, ENTRIES))
    unasked = [
        Finding(f"{target.name}/property/{one.name}", target.name, "property", one.name, NotAsked("quick"), "by hand", 0.0, one.requirements)
        for target in targets
        for one in target.properties
    ]  # fmt: skip
    return write_folder(tmp_path_factory.mktemp("report"), unasked, targets)


def test_the_first_page_has_no_barrier(page: Page, report: Path) -> None:
    """Piece by piece: axe takes many minutes for the whole."""
    page.open(report)
    assert [] == page.barriers_piece_by_piece()


@pytest.mark.parametrize("part", LARGEST)
def test_a_large_part_has_no_barrier(page: Page, report: Path, part: str) -> None:
    """Opened, and alone in the page."""
    page.open(report)
    place = f"[data-part='page/{part}.js']"
    page.js(f'document.querySelector("{place}").open = true')
    page.until(f'"shown" in document.querySelector("{place}").dataset')
    page.driver.execute_script(
        f"""const box = document.querySelector("{place}"), head = document.createElement('h1');
        head.textContent = 'part'; document.querySelector('main').replaceChildren(head, ...box.querySelector('div').children)"""
    )
    assert [] == page.barriers_piece_by_piece()


def test_every_place_is_there_once(page: Page, report: Path) -> None:
    """With all parts open no two elements have one id, and no link leads to a place that is not there."""
    page.open(report)
    page.click("#open-all")
    page.until("[...document.querySelectorAll('details.part')].every(box => 'shown' in box.dataset)")
    ids = "[...document.querySelectorAll('[id]')].map(one => one.id)"
    assert [] == page.js(f"((all) => all.filter((one, at) => all.indexOf(one) !== at))({ids})")
    lost = "[...document.querySelectorAll('a[href^=\"#\"]')].map(a => a.hash.slice(1)).filter(at => !document.getElementById(at))"
    assert [] == page.js(lost)
