"""Conversion of configurations: fields have new names, and times are durations in ms, no longer numbers of cycles."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from safeloc.errors import InputError
from safeloc.language.renamed import FIELDS, TIMES
from safeloc.runtime.migration.changes import Change
from safeloc.runtime.outside import quoted, read_text

_PERIOD_MS = 1_000
"""Cycle length of an area whose configuration has none: the default in both versions."""


@dataclass(frozen=True)
class _Field:
    """A field of the old version: its name, its value, and the value of the field of today."""

    name: str
    value: int
    value_now: int


def migrated(path: Path) -> tuple[str, tuple[Change, ...]]:
    """Return the text with the current fields, and the changes. InputError for a file that is no configuration."""
    text = read_text(path)
    read, form = (tomllib.loads, _TOML) if path.suffix == ".toml" else (json.loads, _JSON)
    content = _content(path, text, read)
    changes: list[Change] = []
    for field in _old_fields(path, content):
        text, change = _rewritten(path, text, field, form)
        changes.append(change)
    if _content(path, text, read) != _with(content):
        raise InputError(f"{path}: the fields {_names(changes)} are ambiguous in the text; change them by hand.")
    return text, tuple(changes)


def _names(changes: list[Change]) -> str:
    return ", ".join(change.old for change in changes)


def _content(path: Path, text: str, read: Callable[[str], Any]) -> dict[str, Any]:
    try:
        content = read(text)
    except (ValueError, RecursionError) as error:  # the errors of both readers are ValueErrors, with line and column
        raise InputError(f"{path}: no {'TOML' if path.suffix == '.toml' else 'JSON'} ({error}).") from error
    if not isinstance(content, dict):
        raise InputError(f"{path}: expected a configuration, an object of fields; got {type(content).__name__}.")
    return content


def _old_fields(path: Path, content: Mapping[str, Any]) -> Iterator[_Field]:
    """Yield the old fields of all tables; their cycle length is that of the table's area."""
    area = content.get("area")
    period_ms = area.get("period_ms", _PERIOD_MS) if isinstance(area, dict) else _PERIOD_MS
    for name, value in content.items():
        if name in FIELDS:
            if type(value) is not int or type(period_ms) is not int:
                cycles = f" cycles of {quoted(period_ms)} ms" if name in TIMES else ""
                raise InputError(f"{path}: {name} is {quoted(value)}{cycles}; give whole numbers.")
            if FIELDS[name] in content:
                raise InputError(
                    f"{path}: has both {name!r} and {FIELDS[name]!r}, an old field and the new one; keep one."
                )
            yield _Field(name, value, _value_now(name, value, period_ms))
        elif isinstance(value, dict):
            yield from _old_fields(path, value)


def _value_now(name: str, value: int, period_ms: int) -> int:
    return value * period_ms if name in TIMES else value


_TOML = r"(?m)^(?P<before>\s*)(?P<name>{name})(?P<between>\s*=\s*)(?P<value>{value})(?P<after>\s*(?:#.*)?)$"
_JSON = r'(?P<before>")(?P<name>{name})(?P<between>"\s*:\s*)(?P<value>{value})(?P<after>(?=\s*[,}}]))'


def _rewritten(path: Path, text: str, field: _Field, form: str) -> tuple[str, Change]:
    wanted = re.compile(form.format(name=field.name, value=r"\+?[0-9_]+"))
    new, at = FIELDS[field.name], wanted.search(text)
    if at is None:
        raise InputError(f"{path}: {field.name} cannot be found in the text; change it by hand.")
    line = text.count("\n", 0, at.start("name")) + 1
    value = at["value"] if field.value_now == field.value else field.value_now
    made = f"{at['before']}{new}{at['between']}{value}{at['after']}"
    change = Change(f"{field.name} = {field.value}", f"{new} = {field.value_now}", line)
    return text[: at.start()] + made + text[at.end() :], change


def _with(content: Mapping[str, Any]) -> dict[str, Any]:
    area = content.get("area")
    period_ms = area.get("period_ms", _PERIOD_MS) if isinstance(area, dict) else _PERIOD_MS
    made: dict[str, Any] = {}
    for name, value in content.items():
        made[FIELDS.get(name, name)] = (
            _with(value) if isinstance(value, dict) else _value_now(name, value, period_ms) if name in FIELDS else value
        )
    return made
