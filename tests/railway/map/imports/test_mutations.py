"""Every value of a document counts, and no damage to it does more than an error that names the file."""

from __future__ import annotations

import copy
import json
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from safeloc.errors import InputError
from safeloc.railway.map.imports.formats import FORMATS
from safeloc.railway.map.imports.notes import Imported
from tests.railway.map.imports.documents import STATION, Read
from tests.railway.map.imports.test_geojson import SWITCH
from tests.railway.map.imports.test_ttobench import TRACK

ATTRIBUTE = re.compile(r' ([A-Za-z]+)="([^"]*)"')
NO_MATTER = frozenset({"id", "version", "encoding", "xmlns", "keepsOrientation", "sequence"})
"""Identities of things that nobody refers to are the only values that may change without a trace, besides order and
orientation of the pieces of a location, which say nothing of a tunnel's or a speed limit's place."""

DAMAGE = ["", "?", "-1", "NaN", "1e999", "9" * 40, "a", "\u00e9", "true"]


def attributes() -> Iterator[tuple[int, int, str]]:
    """Where each attribute's value begins and ends, and its name."""
    for found in ATTRIBUTE.finditer(STATION):
        yield found.start(2), found.end(2), found.group(1)


def told(imported: Imported) -> tuple[object, ...]:
    """What an import says, without the lines of the file."""
    return imported.line, tuple(re.sub(r"line \d+", "", str(note)) for note in imported.notes)


def test_every_attribute_counts(railml: Read) -> None:
    """Whatever value is changed, the line changes, or the notes do, or the document is refused."""
    before, silent = told(railml(STATION)), set()
    for start, end, name in attributes():
        changed = STATION[:start] + _other(STATION[start:end]) + STATION[end:]
        try:
            if told(railml(changed)) == before and name not in NO_MATTER:
                silent.add((name, STATION[:start].count("\n") + 1))
        except InputError:
            continue
    assert {line for _, line in silent} <= _of_switches() | _unread()


def _other(value: str) -> str:
    """Another value of the same kind."""
    if re.fullmatch(r"[0-9.]+", value):
        return "0" if float(value) else "1"
    return {"true": "false", "normal": "reverse", "reverse": "normal", "both": "normal", "Both": "None"}.get(
        value, "zz"
    )


def _of_switches() -> set[int]:
    """Lines of the places of switches: those follow from the relations."""
    return {number for number, line in enumerate(STATION.splitlines(), 1) if "w1_l" in line}


def _unread() -> set[int]:
    """Lines whose attributes are noted whatever their value, and those that mirror the relations."""
    marks = ("<switchIS", "<name", "<track ", "<border ", "<linearPositioningSystem ", "<networkResource", "<relation")
    return {number for number, line in enumerate(STATION.splitlines(), 1) if line.strip().startswith(marks)}


@pytest.mark.thorough(ordinary=3)
@pytest.mark.parametrize("value", DAMAGE)
def test_damaged_railml_is_imported_or_refused(railml: Read, tmp_path: Path, value: str) -> None:
    """Any attribute with any nonsense in it: never another error, and every error names the file."""
    for start, end, _ in attributes():
        _survives(lambda text=STATION[:start] + value + STATION[end:]: railml(text), tmp_path)


def test_railml_without_any_one_line_is_imported_or_refused(railml: Read, tmp_path: Path) -> None:
    """As after a bad cut."""
    lines = STATION.splitlines(keepends=True)
    for number in range(len(lines)):
        _survives(lambda number=number: railml("".join(lines[:number] + lines[number + 1 :])), tmp_path)


@pytest.mark.thorough(ordinary=8)
@pytest.mark.parametrize(("form", "document"), [("geojson", SWITCH), ("ttobench", TRACK)])
@pytest.mark.parametrize("value", [None, True, -1, 1e300, 10**400, "?", "", [], {}, [[]], [None], [1, 2, 3]])
def test_damaged_json_is_imported_or_refused(
    tmp_path: Path, form: str, document: dict[str, Any], value: object
) -> None:
    """Any member or item replaced by anything."""
    path = tmp_path / "damaged.json"
    for change in _replacements(document, value):
        damaged = copy.deepcopy(document)
        change(damaged)
        path.write_text(json.dumps(damaged), encoding="utf-8")
        _survives(lambda: FORMATS[form](path), tmp_path)


def _replacements(node: Any, value: object, path: tuple[Any, ...] = ()) -> Iterator[Callable[[Any], None]]:
    """One change for every place in the document."""
    places = list(node.items()) if isinstance(node, dict) else list(enumerate(node)) if isinstance(node, list) else []
    for key, inner in places:

        def change(document: Any, key: Any = key) -> None:
            for step in path:
                document = document[step]
            document[key] = value

        yield change
        yield from _replacements(inner, value, (*path, key))


def _survives(read: Callable[[], Imported], folder: Path) -> None:
    assert _refusal(read, str(folder)).startswith(str(folder))


def _refusal(read: Callable[[], Imported], otherwise: str) -> str:
    try:
        read()
    except InputError as refused:
        return str(refused)
    return otherwise
