"""Conversion of step streams and records to the current names."""

from __future__ import annotations

import json
from collections.abc import Collection, Iterator, Mapping
from pathlib import Path
from typing import Any, get_args

from safeloc.errors import StreamError
from safeloc.language.renamed import name_now, parted, wired_from
from safeloc.runtime.migration.changes import Change, summed, with_names
from safeloc.runtime.outside import quoted
from safeloc.runtime.streams.files import json_object, lines_of, streaming
from safeloc.runtime.streams.records import Record
from safeloc.runtime.streams.steps import SCHEMA

KINDS = frozenset(kind.model_fields["kind"].default for kind in get_args(Record)) | {"cycle"}
"""Kinds of records, and of the line that ends a cycle."""
_OWN_FIELDS = frozenset({"step_mm"})
"""Former fields of records themselves."""
_REPORT = ("interval_mm", "event", "outputs")
"""A line with one of these fields is a report of a process, and no input."""


def migrated(path: Path, ships: Collection[str]) -> tuple[str, tuple[Change, ...]]:
    """Return the text with the current names, and the changes.

    StreamError with file and line if the file is no stream of steps or records.

    ships   names of machines whose inputs were renamed; inputs of other machines keep their names
    """
    lines: list[str] = []
    changes: list[Change] = []
    seen: dict[str, int] = {}
    with streaming(path):
        for number, text in lines_of(path):
            line = json_object(path, number, text)
            seen |= {name: number for name in line if name not in seen}
            names = _old_names(path, number, line, ships)
            lines.append(_renamed(path, number, text, names) if names else text)
            changes += (Change(old, new, number) for old, new in names.items())
    _refuse_wired(path, seen)
    return "".join(f"{line}\n" for line in lines), summed(changes)


_BESIDE = {"reflector": "balise", "taking": "giving"}
"""Machine -> the one beside which it has inputs no more that are its own without it."""


def _refuse_wired(path: Path, seen: Mapping[str, int]) -> None:
    """Refuse a stream with inputs that other machines give now, where it has the machines that say so.

    seen    the names in the stream, each with its first line
    """
    machines = {name.partition(".")[0] for name in seen}
    for name, number in seen.items():
        giver = wired_from(name)
        if giver and _BESIDE.get(name.partition(".")[0]) in machines:
            raise StreamError(
                f"{path}:{number}: has {name!r}, which is no input any more: {giver} gives it. Record the stream again (docs/migrating.md)."
            )


def _old_names(path: Path, number: int, line: Mapping[str, Any], ships: Collection[str]) -> dict[str, str]:
    """Return the old names in a line, each with its new name."""
    found = list(_names(path, number, line))
    names = {old: new for old in found if (new := name_now(old)) != old}
    if gone := [
        f"{name!r}, which is now {' and '.join(map(repr, parts))}" for name in found if (parts := parted(name))
    ]:
        raise StreamError(
            f"{path}:{number}: has {gone[0]}: these cannot be derived from the old figure. Record the stream again."
        )
    both = [f"{old!r} and {new!r}" for old, new in names.items() if new in found]
    if both:
        raise StreamError(f"{path}:{number}: has both {both[0]}, an old name and the new one; keep one of them.")
    machine = line.get("machine", "")
    if names and "schema" in line and machine not in ("", *ships):
        raise StreamError(
            f"{path}:{number}: a stream of {quoted(machine)}, which is no shipped machine, so its names are unknown here. "
            f"Take `machine` out if they are the names of a shipped machine."
        )
    return names


def _names(path: Path, number: int, line: Mapping[str, Any]) -> Iterator[str]:
    """Yield the names of inputs and state variables in a line: a header, a record or a step."""
    if "schema" in line:
        yield from _of_a_header(path, number, line)
    elif "kind" in line:
        if line["kind"] not in KINDS:
            raise StreamError(f"{path}:{number}: a line of kind {quoted(line['kind'])}; known are {sorted(KINDS)}.")
        yield from [line["name"]] if isinstance(line.get("name"), str) else []
        yield from _OWN_FIELDS & line.keys()
    elif any(name in line for name in _REPORT):
        raise StreamError(f"{path}:{number}: a report of a process; nothing reads it, so it is not converted.")
    else:
        yield from line


def _of_a_header(path: Path, number: int, line: Mapping[str, Any]) -> Iterator[str]:
    if line["schema"] != SCHEMA:
        raise StreamError(f"{path}:{number}: schema is {quoted(line['schema'])}; only {SCHEMA!r} can be converted.")
    first, kept = line.get("first", {}), line.get("kept", [])
    if not isinstance(first, dict) or not isinstance(kept, list) or not all(isinstance(name, str) for name in kept):
        raise StreamError(f"{path}:{number}: `first` must be an object of initial values, and `kept` a list of inputs.")
    yield from first
    yield from (name for name in kept if name not in first)


def _renamed(path: Path, number: int, text: str, names: dict[str, str]) -> str:
    """Return the line with other names; StreamError if a value would change as well."""
    found = with_names(text, names)
    if json.loads(found) != _with(json.loads(text), names):
        raise StreamError(f"{path}:{number}: has {quoted(sorted(names))} as a value as well; change the line by hand.")
    return found


def _with(line: dict[str, Any], names: Mapping[str, str]) -> dict[str, Any]:
    made = {names.get(name, name): value for name, value in line.items()}
    if "schema" in line:
        made["first"] = {names.get(name, name): value for name, value in line.get("first", {}).items()}
        made["kept"] = [names.get(name, name) for name in line.get("kept", [])]
        return {name: value for name, value in made.items() if name in line}
    value_record = "kind" in line and isinstance(line.get("name"), str)
    return {**made, "name": names.get(line["name"], line["name"])} if value_record else made
