"""Finds the line of a value in a TOML file, since validation reports keys and people look for lines."""

from __future__ import annotations

import re
from collections.abc import Sequence

_HEADER = re.compile(r"\s*(\[\[?)([A-Za-z0-9_.\-\s]+)\]")
_KEY = re.compile(r"^\s*([A-Za-z0-9_-]+)\s*=")


def line_of(text: str, path: Sequence[str | int]) -> int:
    """Return the line (from 1) of the value at a path such as ("edges", 3, "length_mm"), or of the nearest key above it."""
    best, best_depth = 1, 0
    table: tuple[str | int, ...] = ()
    counts: dict[tuple[str | int, ...], int] = {}
    for number, content in enumerate(text.splitlines(), 1):
        here: tuple[str | int, ...] | None = None
        if header := _HEADER.match(content):
            here = table = _enter(header.group(2).strip(), header.group(1) == "[[", counts)
        elif key := _KEY.match(content):
            here = (*table, key.group(1))
        if here is not None and len(here) > best_depth and tuple(path[: len(here)]) == here:
            best, best_depth = number, len(here)
    return best


def _enter(header: str, repeated: bool, counts: dict[tuple[str | int, ...], int]) -> tuple[str | int, ...]:
    """Return the path of a table header; `[[...]]` begins one more entry of its list, parts before it mean the last entry."""
    path: tuple[str | int, ...] = ()
    names = [name.strip() for name in header.split(".")]
    for name in names[:-1]:
        path = (*path, name)
        if path in counts:
            path = (*path, counts[path])
    path = (*path, names[-1])
    if repeated:
        counts[path] = counts.get(path, -1) + 1
        path = (*path, counts[path])
    return path
