"""Reads JSON strictly: exact decimal numbers, no name twice, no NaN, and errors with the place in the file."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from decimal import Decimal
from pathlib import Path
from typing import Any

from safeloc.errors import InputError
from safeloc.railway.map.imports.building import content
from safeloc.runtime.outside import decoded, quoted, refuse_beyond, shortened

MOST_VALUES = 10_000_000
"""Numbers, texts, lists and objects in one file; an empty list of three bytes takes seventy bytes of memory."""


def read_object(path: Path) -> dict[str, Any]:
    """Return the object in the file. InputError for other content, for a name given twice, and for NaN."""
    data = content(path)
    refuse_beyond(path, sum(map(data.count, (b",", b"[", b"{"))), MOST_VALUES, "values")
    text = decoded(path, data)

    def once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        found = dict(pairs)
        if len(found) < len(pairs):
            counts = Counter(name for name, _ in pairs)
            twice = next(name for name, count in counts.items() if count > 1)
            raise InputError(f"{path}: {quoted(twice)} is given twice in one object; keep one.")
        return found

    def refuse(constant: str) -> Any:
        raise InputError(f"{path}: {constant} is no number of JSON.")

    try:
        found = json.loads(text, object_pairs_hook=once, parse_float=Decimal, parse_constant=refuse)
    except json.JSONDecodeError as error:
        raise InputError(f"{path}:{error.lineno}: not JSON ({error.msg} at column {error.colno}).") from error
    except RecursionError as error:
        raise InputError(f"{path}: nested too deeply to be a map.") from error
    except ValueError as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{path}: a number has thousands of digits ({shortened(error)}); mend it.") from error
    return mapping(found, str(path))


def mapping(value: object, place: str) -> dict[str, Any]:
    """Return the value as an object; InputError otherwise."""
    if not isinstance(value, dict):
        raise InputError(f"{place}: expected an object, got {_kind(value)}.")
    return value


def sequence(value: object, place: str) -> list[Any]:
    """Return the value as a list; InputError otherwise."""
    if not isinstance(value, list):
        raise InputError(f"{place}: expected a list, got {_kind(value)}.")
    return value


def text(value: object, place: str) -> str:
    """Return the value as text that is not empty; InputError otherwise."""
    if not isinstance(value, str) or not value.strip():
        raise InputError(f"{place}: expected text, got {_kind(value)}.")
    return value.strip()


def required(found: Mapping[str, Any], name: str, place: str) -> Any:
    """Return the member of that name; InputError if there is none."""
    if name not in found:
        raise InputError(f"{place}: {name!r} is missing.")
    return found[name]


def others(found: Mapping[str, Any], known: Sequence[str]) -> Iterator[str]:
    """Yield the names that are not among the known ones."""
    return (name for name in found if name not in known)


def _kind(value: object) -> str:
    return {"dict": "an object", "list": "a list", "NoneType": "null", "bool": f"{value}"}.get(
        type(value).__name__, quoted(value)
    )
