"""Finds the line of a value in a TOML file, since validation reports keys and people look for lines."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from pydantic import ValidationError

from safeloc.language.renamed import hint
from safeloc.runtime.flaws import FlawsError
from safeloc.runtime.outside import quoted

Place = Sequence[str | int]

_HEADER = re.compile(r"""\s*(\[\[?)((?:[A-Za-z0-9_.\-\s]|"[^"]*"|'[^']*')+)\]""")
_NAME = re.compile(r"""[A-Za-z0-9_\-]+|"[^"]*"|'[^']*'""")
_KEY = re.compile(rf"^\s*((?:{_NAME.pattern})(?:\s*\.\s*(?:{_NAME.pattern}))*)\s*=")
_TOKEN = re.compile(r"""#[^\n]*|"(?:\\.|[^"\\\n])*"|'[^'\n]*'|[\[\]{},\n]""")
"""What divides an array that is written over several lines: brackets, commas and ends of lines outside strings and comments."""


def line_of(text: str, path: Place) -> int:
    """Return the line (from 1) of the value at a path such as ("edges", 3, "length_mm"), or of the nearest key above it."""
    best, best_depth, value_from = 1, 0, len(text)
    table: tuple[str | int, ...] = ()
    counts: dict[tuple[str | int, ...], int] = {}
    begin, open_arrays = 0, 0
    for number, content in enumerate(text.split("\n"), 1):
        here: tuple[str | int, ...] | None = None
        after = len(text)
        if open_arrays:
            open_arrays += _opened(content)
        elif header := _HEADER.match(content):
            here = table = _enter(header.group(2), header.group(1) == "[[", counts)
        elif key := _KEY.match(content):
            here, after = (*table, *_names(key.group(1))), begin + key.end()
            open_arrays = _opened(content[key.end() :]) if content[key.end() :].lstrip().startswith("[") else 0
        if here is not None and len(here) > best_depth and tuple(path[: len(here)]) == here:
            best, best_depth, value_from = number, len(here), after
        begin += len(content) + 1
    return best + _lines_down(text[value_from:], path[best_depth:])


def _opened(content: str) -> int:
    """Return how many brackets a line opens and does not close."""
    marks = _TOKEN.findall(content)
    return marks.count("[") + marks.count("{") - marks.count("]") - marks.count("}")


def _lines_down(value: str, path: Place) -> int:
    """Return how many lines below the start of an array the entry at a path begins; an entry may lie in an array of the array."""
    if not path or not isinstance(path[0], int) or not value.lstrip().startswith("["):
        return 0
    lines, depth, entry, begun, last = 0, 0, 0, False, 0
    for token in _TOKEN.finditer(value):
        mark, between, last = token.group(), value[last : token.start()].strip(), token.end()
        if depth == 1 and not begun and (between or mark[0] in "[{\"'"):
            begun = True
            if entry == path[0]:
                return lines + _lines_down(value[token.start() :], path[1:])
        depth += (mark in ("[", "{")) - (mark in ("]", "}"))
        lines += mark == "\n"
        if depth == 1 and mark == ",":
            entry, begun = entry + 1, False
        if depth == 0 and mark == "]":
            break
    return 0


def _names(dotted: str) -> list[str]:
    """Return the parts of a key such as `areas."west:1".sections_mm`."""
    return [name.strip("\"'") for name in _NAME.findall(dotted)]


def _enter(header: str, repeated: bool, counts: dict[tuple[str | int, ...], int]) -> tuple[str | int, ...]:
    """Return the path of a table header; `[[...]]` begins one more entry of its list, parts before it mean the last entry."""
    path: tuple[str | int, ...] = ()
    names = _names(header)
    for name in names[:-1]:
        path = (*path, name)
        if path in counts:
            path = (*path, counts[path])
    path = (*path, names[-1])
    if repeated:
        counts[path] = counts.get(path, -1) + 1
        path = (*path, counts[path])
    return path


def refusal(error: ValidationError, where: Callable[[Place], str], within: tuple[str | int, ...] = ()) -> str:
    """Return why a file is refused: place, key, message and value of its first flaw; `where` turns the path of a value into words.

    within  the table of the file that was validated, if it is not the whole file
    """
    found = error.errors(include_url=False)
    wrong = [one for one in found if not any(_within(other["loc"], one["loc"]) for other in found)]
    first = wrong[0]
    across = first.get("ctx", {}).get("error")
    if isinstance(across, FlawsError):
        return f"{across.told(where).rstrip('.')}."
    place = (*within, *first["loc"])
    key = ".".join(str(part) for part in place)
    message = _in_words(first)
    text = f"{where(place)}: {key}: {message}" if key else f"{where(())}: {message}"
    more = f" ({len(wrong) - 1} more)" if len(wrong) > 1 else ""
    got = f" (got {quoted(first['input'])})" if key and not isinstance(first["input"], (dict, list)) else ""
    end = "" if text.endswith("?") and not got else "."
    return f"{text.rstrip('.')}{got}{end}{more}"


def _in_words(error: Mapping[str, Any]) -> str:
    """Return what is wrong with a value; an unknown kind of a table is told with the kinds that there are."""
    if error["type"] == "union_tag_invalid":
        what, named, expected = (error["ctx"][one] for one in ("discriminator", "tag", "expected_tags"))
        known = expected.replace("'", "").split(", ")
        what = what.strip("'")
        return f"there is no {what} {named!r}; there are {', '.join(known)}.{hint(named, known)}"
    return str(error["msg"]).removeprefix("Value error, ")


def _within(inner: tuple[int | str, ...], outer: tuple[int | str, ...]) -> bool:
    """Return whether one key lies within the other; a list with a wrong entry is also reported as too short."""
    return len(inner) > len(outer) and inner[: len(outer)] == outer
