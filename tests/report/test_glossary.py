"""The page explains its own words: an assessor has the folder of the report alone."""

from __future__ import annotations

from safeloc.report.data import report_data
from safeloc.report.glossary import words_in
from safeloc.report.page import to_html
from tests.report import lamp


def test_words_that_occur_are_explained() -> None:
    """In the order of the glossary, whole words alone, also in the plural; without the marks of its page."""
    found = {one.here: one for one in words_in("Ghosts and laws; nothing claimed.")}
    assert {"ghost", "law"} <= set(found)
    assert "claim" not in found
    assert all(
        one.standard and one.meaning and "`" not in one.meaning and "](" not in one.meaning for one in found.values()
    )
    assert [] == words_in("")


def test_the_page_has_its_words_and_how_to_read_it() -> None:
    """Both lead nowhere outside of the folder."""
    page = to_html(report_data(lamp.findings(), [lamp.target()]))
    words = page.partition('<h2 id="words"')[2].partition('<h2 id="versions">')[0]
    assert "words that this report uses" in words and "<b>witness</b>" in words
    assert '<a href="#words">' in page and "href=" not in words
