"""Finds the line of a value in a TOML file, since validation reports keys and people look for lines."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

from pydantic import ValidationError

from safeloc.runtime.outside import quoted

Place = Sequence[str | int]

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


def refusal(error: ValidationError, where: Callable[[Place], str]) -> str:
    """Return why a file is refused: place, key and message of its first flaw; `where` turns the path of a value into words."""
    found = error.errors(include_url=False)
    wrong = [one for one in found if not any(_within(other["loc"], one["loc"]) for other in found)]
    first = wrong[0]
    key = ".".join(str(part) for part in first["loc"])
    message = first["msg"].removeprefix("Value error, ")
    text = f"{where(first['loc'])}: {key}: {message}" if key else f"{where(())}: {message}"
    more = f" ({len(wrong) - 1} more)" if len(wrong) > 1 else ""
    got = f" (got {quoted(first['input'])})" if key and not isinstance(first["input"], (dict, list)) else ""
    return f"{text.rstrip('.')}{got}.{more}"


def _within(inner: tuple[int | str, ...], outer: tuple[int | str, ...]) -> bool:
    """Return whether one key lies within the other; a list with a wrong entry is also reported as too short."""
    return len(inner) > len(outer) and inner[: len(outer)] == outer
