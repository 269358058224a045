"""The page explains its own words: an assessor has the folder of the report alone."""

from __future__ import annotations

import re

import pytest

from safeloc.report.data import report_data
from safeloc.report.glossary import _glossary, _occurs, _small, words_in  # pyright: ignore[reportPrivateUsage]
from safeloc.report.page import to_html
from safeloc.report.run_page import asset
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


@pytest.mark.parametrize(
    "text",
    ["GHO\u017fTS", "w\u0130tness", "W\u0131TNESSES", "c\u212aash claims", "laws\u00df", asset("page.html.jinja")],
)
def test_the_words_are_those_of_a_search(text: str) -> None:
    """Looking at letters first leaves no word out, whichever letters count as the same without case."""
    every = " ".join(name for one in _glossary() for name in one.here.split(", "))
    names = {name for one in words_in(every) for name in one.here.split(", ")}
    searched = {name for name in names if re.search(rf"\b{re.escape(name)}(?:s|es)?\b", text, re.IGNORECASE)}
    assert searched == {name for name in names if _occurs(name, text, _small(text))}


def test_the_page_has_its_words_and_how_to_read_it() -> None:
    """Both lead nowhere outside of the folder."""
    page = to_html(report_data(lamp.findings(), [lamp.target()]))
    words = page.partition('<h2 id="words"')[2].partition('<h2 id="versions">')[0]
    assert "words that this report uses" in words and "<b>witness</b>" in words
    assert '<a href="#words">' in page and "href=" not in words
