"""The glossary explains words that the project uses, in order, and says the truth about the margins above and below."""

from __future__ import annotations

import re
from collections import Counter
from functools import cache

import pytest

from safeloc.reported import Reported
from tests.rooms import ROOT

PAGE = ROOT / "docs" / "glossary.md"
TEXT = PAGE.read_text(encoding="utf-8")
ROWS = [row.strip("|").split(" | ") for row in TEXT.partition("## Words")[2].splitlines() if row.startswith("|")][2:]
WORDS = [row[0].strip() for row in ROWS]
SPOKEN = ("docs/**/*.md", "README.md", "models/**/*.py", "properties/**/*.py", "safeloc/**/*.py", "safeloc/**/*.jinja")
ABOUT_WORDS = ("glossary.md", "architecture.md")


@cache
def spoken() -> str:
    """Everything that the project says, in code and documents, but for the pages about words."""
    paths = (path for pattern in SPOKEN for path in sorted(ROOT.glob(pattern)) if path.name not in ABOUT_WORDS)
    return "\n".join(path.read_text(encoding="utf-8") for path in paths)


def occurs(word: str) -> bool:
    """Whether the project uses it: a name in backquotes as it is written, any other word in upper or lower case."""
    flags = re.NOFLAG if word.startswith("`") else re.IGNORECASE
    phrase = r"\s+".join(map(re.escape, word.strip("`").split()))
    return re.search(rf"(?<![A-Za-z]){phrase}(?![A-Za-z])", spoken(), flags) is not None


@pytest.mark.parametrize("word", WORDS)
def test_each_word_is_used(word: str) -> None:
    """A word that nobody uses any more needs no explanation."""
    assert occurs(word)


def test_a_word_that_is_not_used_is_noticed() -> None:
    """Neither as a part of another word, nor in other letters where it is a name."""
    assert not occurs("confidence ellipsoid")
    assert not occurs("ontainmen")
    assert not occurs("`wRoNg`")


def test_words_are_sorted_and_explained_once() -> None:
    """Without regard to upper case and backquotes; every row has its four cells filled."""
    plain = [word.strip("`").casefold() for word in WORDS]
    assert sorted(plain) == plain
    assert [] == [word for word, times in Counter(plain).items() if times > 1]
    assert {4} == {len([cell for cell in row if cell.strip()]) for row in ROWS}
    assert len(ROWS) > 80


def test_the_page_and_the_code_agree_on_the_margins() -> None:
    """The margin above reaches up, the one below down; the page says so in the code's own names."""
    report = Reported()
    outputs = {report.position: 1_000, report.above: 7, report.below: 5, report.valid: True}
    assert (1_000 - 5, 1_000 + 7) == report.interval_mm(outputs)
    assert f"[{report.position} - {report.below}, {report.position} + {report.above}]" in TEXT
    said = {word: row[1] for word, row in zip(WORDS, ROWS, strict=True)}
    assert "L_DOUBTUNDER" in said["`margin_above_mm`"]
    assert "L_DOUBTOVER" in said["`margin_below_mm`"]
