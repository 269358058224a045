"""Decisions are short records: the decision, its context, and its consequence."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

PAGES = sorted(path for path in Path(__file__).parents[1].joinpath("docs", "decisions").glob("*.md"))
ENTRY = re.compile(r"^\d+\. ", re.MULTILINE)
FORM = re.compile(r"\*\*.+?\*\*.*?\*Context:\*\s+\S.*?\*Consequence:\*\s+\S", re.DOTALL)
BESIDE = re.compile(r"^ +(?:[-*|] ?|```)", re.MULTILINE)
"""Where a list, a table or code begins that stands below an entry."""
MOST_WORDS = 200


def entries(text: str) -> Iterator[str]:
    """Yield the numbered entries of a page; a heading or a paragraph of its own ends an entry."""
    begins = [found.start() for found in ENTRY.finditer(text)]
    for begin, end in zip(begins, [*begins[1:], len(text)], strict=True):
        yield re.split(r"^#|\n\n(?=\S)", text[begin:end], maxsplit=1, flags=re.MULTILINE)[0]


@pytest.mark.parametrize("page", [page for page in PAGES if page.stem != "README"], ids=lambda page: page.stem)
def test_each_decision_has_its_three_parts(page: Path) -> None:
    """First the decision in bold, then one context and one consequence; none is longer than a screen."""
    found = list(entries(page.read_text(encoding="utf-8")))
    assert found
    without = [one[:80] for one in found if not FORM.match(one.split(" ", 1)[1])]
    twice = [one[:80] for one in found if one.count("*Context:*") != 1 or one.count("*Consequence:*") != 1]
    long = [one[:80] for one in found if len(BESIDE.split(one)[0].split()) > MOST_WORDS]
    assert (without, twice, long) == ([], [], [])


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_numbers_run_on(page: Path) -> None:
    """Under each heading they run on from 1, so that a number means one decision."""
    for part in re.split(r"^#+ ", page.read_text(encoding="utf-8"), flags=re.MULTILINE):
        numbers = [int(one) for one in re.findall(r"^(\d+)\. ", part, re.MULTILINE)]
        assert numbers == list(range(1, len(numbers) + 1))


def test_every_page_is_in_the_list() -> None:
    """README of the decisions names each page once."""
    listed = re.findall(r"\]\((\w+\.md)\)", (PAGES[0].parent / "README.md").read_text(encoding="utf-8"))
    assert sorted(listed) == sorted(page.name for page in PAGES if page.stem != "README")
