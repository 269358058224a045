"""The words of the project that a report uses, with their meaning, out of the glossary that is installed with safeloc.

An assessor has the folder of the report alone, so they stand in its page.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import safeloc

_PACKAGE = Path(safeloc.__file__).resolve().parent
_ROW = re.compile(r"\| (?P<here>[^|]+) \| (?P<standard>[^|]+) \| [^|]+ \| (?P<meaning>[^|]+) \|")
_DOTTED = str.maketrans("\u0130\u0131", "ii")
_LINK = re.compile(r"\[([^\]]+)\]\([^)]+\)")


@dataclass(frozen=True)
class Word:
    """A word of the project, the standard term for it, and what it means."""

    here: str
    standard: str
    meaning: str


def words_in(text: str) -> list[Word]:
    """Return the words of the glossary that occur in a text, in the order of the glossary; none where it is not installed."""
    small = _small(text)
    return [one for one in _glossary() if any(_occurs(name, text, small) for name in one.here.split(", "))]


def _occurs(name: str, text: str, small: str) -> bool:
    """Return whether the word occurs, also in the plural. Most words do not occur, which their letters tell in a hundredth of the time."""
    return _small(name) in small and re.search(rf"\b{re.escape(name)}(?:s|es)?\b", text, re.IGNORECASE) is not None


def _small(text: str) -> str:
    """Return a text in small letters, those with and without a dot that a search without case takes for `i` among them."""
    return text.translate(_DOTTED).casefold()


@cache
def _glossary() -> tuple[Word, ...]:
    for found in (_PACKAGE / "docs" / "glossary.md", _PACKAGE.parent / "docs" / "glossary.md"):
        if found.is_file():
            return tuple(_rows(found.read_text(encoding="utf-8")))
    return ()


def _rows(text: str) -> Iterator[Word]:
    """Yield the rows of the tables of words; heads and lines below them are none."""
    for line in text.partition("\n## Words\n")[2].splitlines():
        row = _ROW.fullmatch(line)
        if row and row["here"] != "here" and not row["here"].startswith("-"):
            yield Word(*(_LINK.sub(r"\1", row[name].replace("`", "")) for name in ("here", "standard", "meaning")))
