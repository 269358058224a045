"""Places of the page: an address, a heading and a link open the part that they lead to; words explain themselves; paper has all of it."""

from __future__ import annotations

from pathlib import Path
from urllib.parse import urlencode

import pytest

from safeloc.catalogue import load_target
from safeloc.language.verdict import Held
from safeloc.proof.results import Finding
from safeloc.report import page as page_module
from safeloc.report.folder import write_folder
from tests.report.browser import ENTER, ESCAPE, Page, opened
from tests.report.test_page import door, findings
from tests.report.test_paper import on_paper

pytestmark = pytest.mark.slow
UNKNOWN = """[...document.querySelectorAll('main a[href^="#"]')].map(a => a.hash.slice(1)).filter(id => !document.getElementById(id))"""
WIDER = "[...document.querySelectorAll('main table')].filter(t => t.offsetParent && t.getBoundingClientRect().right > 1032).map(t => t.textContent.slice(0, 40))"


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A report of two machines in parts, one of them with many recordings."""
    most, page_module.MOST_OF_ONE_PAGE = page_module.MOST_OF_ONE_PAGE, 0
    try:
        return write_folder(
            tmp_path_factory.mktemp("report"), [*findings(), *replays()], [door(), load_target("odometry")]
        )
    finally:
        page_module.MOST_OF_ONE_PAGE = most


def replays() -> list[Finding]:
    """What twelve recordings with long names say of one statement, each with a note of its own."""
    names = [f"a-recording-with-a-rather-long-name-{number}" for number in range(12)]
    return [
        Finding(
            f"odometry/replay/{name}: containment",
            "odometry",
            "replay",
            "the interval contains the truth",
            Held("replay", 1, 90, {"never happened": f"the case (mode = {name})"}),
            f"replay of {name}.jsonl.gz",
            0.1,
        )
        for name in names
    ]


def shown(page: Page) -> list[str]:
    """The parts that were opened."""
    found: list[str] = page.js("[...document.querySelectorAll('[data-shown]')].map(one => one.dataset.part)")
    return found


@pytest.mark.parametrize(
    ("place", "part"),
    [
        ("#conditions", "page/conditions.js"),
        ("#condition-odometry-A1", "page/conditions.js"),
        ("#items", "page/trace-back.js"),
        ("#law-odometry-odometry-A1", "page/odometry.js"),
        ("#source-odometry-0", "page/odometry.js"),
    ],
)
def test_an_address_opens_its_part(page: Page, report: Path, place: str, part: str) -> None:
    """And no other; the place is in sight."""
    page.open(report, place)
    page.until("document.querySelector('[data-shown]')")
    assert [part] == shown(page)
    page.until(
        "(box => box && box.top > -2 && box.top < innerHeight)(document.getElementById(location.hash.slice(1))?.getBoundingClientRect())"
    )
    assert [] == page.said()


def test_every_link_leads_somewhere(page: Page, report: Path) -> None:
    """Also those to source lines of laws."""
    page.open(report, "#print")
    page.until("document.documentElement.dataset.printable !== undefined")
    page.js("dispatchEvent(new Event('afterprint'))")
    assert [] == page.js(UNKNOWN)
    assert page.js("document.querySelectorAll('.laws a[href^=\"#source-\"]').length") >= 1
    assert page.js("document.querySelectorAll('table.conditions a[href^=\"#source-\"]').length") >= 1


def test_nothing_is_wider_than_a_sheet(page: Page, report: Path) -> None:
    """A browser makes everything smaller on paper when one table is too wide; with twelve recordings none is."""
    page.size(1032, 687)
    page.open(report, "#print")
    page.until("document.documentElement.dataset.printable !== undefined")
    on_paper(page, True)
    try:
        assert [] == page.js(WIDER)
    finally:
        on_paper(page, False)


def test_the_conditions_are_printed_alone(page: Page, report: Path) -> None:
    """As a machine is; the sheet says that it has one part of the report."""
    page.open(report, "#print=conditions")
    page.until("document.documentElement.dataset.printable !== undefined")
    assert ["page/conditions.js"] == shown(page)
    on_paper(page, True)
    try:
        assert page.js("document.querySelector('table.conditions').offsetParent !== null")
        assert page.js("document.querySelector('.of-one-part').offsetParent !== null")
        assert page.js(
            "[...document.querySelectorAll('section[data-machine]')].every(one => one.offsetParent === null)"
        )
    finally:
        on_paper(page, False)


def test_steps_on_paper_have_their_numbers(page: Page, report: Path) -> None:
    """And values their units."""
    place = urlencode({"result": "door/property/bad <b>"})
    opened(page, report.with_name("run.html"), f"#{place}")
    on_paper(page, True)
    try:
        assert page.js(
            "[...document.querySelectorAll('#run-steps [data-step] button')].every(one => one.offsetParent !== null)"
        )
    finally:
        on_paper(page, False)


def test_a_word_explains_itself(page: Page, report: Path) -> None:
    """By Enter and by a click, once in a section; Escape and a click elsewhere take the meaning away."""
    page.open(report)
    page.until("document.querySelector('main > p a.explained')")
    page.type("main > p a.explained", ENTER)
    word = page.text("main > p a.explained")
    assert page.text(".bubble").lower().startswith(word.lower()[:4])
    assert "true" == page.js("document.querySelector('main > p a.explained').getAttribute('aria-expanded')")
    page.press(ESCAPE)
    assert page.js("document.querySelector('.bubble') === null")
    page.click("main > p a.explained")
    page.click("h1")
    assert page.js("document.querySelector('.bubble') === null")
    twice = "(words => words.filter((word, at) => words.indexOf(word) !== at))([...document.querySelectorAll('section[data-machine=odometry] a.explained')].map(a => a.hash))"
    page.js("document.getElementById('odometry').scrollIntoView()")
    page.until("document.querySelector('section[data-machine=odometry] a.explained')")
    assert [] == page.js(twice)
    assert [] == page.barriers()
