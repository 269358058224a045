"""Docstrings as reStructuredText: they are plain sentences, `names` in single backquotes, and tables aligned by spaces."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from itertools import groupby

SPAN = re.compile(r"(`[^`]*`)")
MARKUP = re.compile(r"([\\*_|`])")
ALIGNED = re.compile(r"\S {2,}\S")


def as_rst(lines: Sequence[str]) -> list[str]:
    """Return the lines with every character shown as it stands, and aligned or indented paragraphs as literal blocks."""
    made: list[str] = []
    for filled, group in groupby(lines, key=lambda line: bool(line.strip())):
        paragraph = list(group)
        made += _paragraph(paragraph) if filled else paragraph
    return made


def _paragraph(lines: Sequence[str]) -> Iterator[str]:
    if any(line[0] == " " or ALIGNED.search(line) for line in lines):
        yield from ["::", "", *(f"    {line}" for line in lines)]
        return
    text = "\n".join(lines)  # a span may go over the end of a line
    parts = [f"`{part}`" if number % 2 else MARKUP.sub(r"\\\1", part) for number, part in enumerate(SPAN.split(text))]
    yield from "".join(parts).split("\n")
