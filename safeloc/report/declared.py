"""Source lines in a report: where each transition, law and property is declared, and what stands there.

The report holds the text itself, since a reader may have neither the files nor the version from which it was made.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import safeloc
from safeloc.catalogue import Target

_PACKAGE = Path(safeloc.__file__).resolve().parent
_MOST_LINES = 60
"""Of a longer declaration the first lines are shown; a note says how many follow."""


def place(src: str) -> str:
    """Return `file:line` without the folders of the computer: from the package, or from the working folder, or the name alone."""
    file, _, line = src.rpartition(":")
    path = Path(file).resolve()
    for folder in (_PACKAGE.parent, Path.cwd()):
        if path.is_relative_to(folder):
            return f"{path.relative_to(folder).as_posix()}:{line}"
    return f"{path.name}:{line}"


def declarations(target: Target) -> list[dict[str, Any]]:
    """Return each place in which transitions, laws and properties of a target are declared, with its text and their names."""
    found: dict[str, dict[str, Any]] = {}
    for kind, machine, name, src in _declared(target):
        one = found.setdefault(src, {"place": place(src), "text": excerpt(src), "of": []})
        one["of"].append([kind, machine, name])
    return list(found.values())


def _declared(target: Target) -> Iterator[tuple[str, str, str, str]]:
    for machine in target.machines:
        yield from (("transition", machine.name, one.name, one.src) for one in machine.transitions)
        yield from (("law", machine.name, name, law.src) for name, law in machine.world.laws.items() if law.src)
    yield from (("property", target.name, one.name, one.src) for one in target.properties)


def excerpt(src: str) -> str:
    """Return the lines of the declaration that begins at `file:line`; nothing if the file cannot be read any more."""
    file, _, line = src.rpartition(":")
    lines, ends = _parsed(file)
    first = int(line) if line.isdigit() else 0
    if not 1 <= first <= len(lines):
        return ""
    last = ends.get(first, first)
    shown = lines[first - 1 : min(last, first - 1 + _MOST_LINES)]
    more = last - first + 1 - len(shown)
    return _dedented([*shown, *([f"... {more} more lines"] if more else [])])


def _dedented(lines: list[str]) -> str:
    """Return the lines without the indent of the first one; a line with less loses what it has."""
    indent = len(lines[0]) - len(lines[0].lstrip())
    return "\n".join(line[min(indent, len(line) - len(line.lstrip())) :].rstrip() for line in lines)


@cache
def _parsed(file: str) -> tuple[list[str], dict[int, int]]:
    """Return the lines of a file, and for each line on which a call begins the line on which the longest one ends."""
    try:
        text = Path(file).read_text(encoding="utf-8")
        tree = ast.parse(text)
    except (OSError, ValueError, SyntaxError):
        return [], {}
    ends: dict[int, int] = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and node.end_lineno is not None:
            ends[node.lineno] = max(ends.get(node.lineno, 0), node.end_lineno)
    return text.splitlines(), ends
