"""Builds records of the map from a file; a record that is refused becomes an error with the place in the file."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from safeloc.errors import EngineError, InputError
from safeloc.runtime.outside import quoted, read_bytes, reading_file

LARGEST_MAP = 200_000_000
"""Bytes of a map file; enough for the micro topology of a country."""

Record = TypeVar("Record", bound=BaseModel)


def made(record: type[Record], place: str, **fields: Any) -> Record:
    """Return the record; InputError with the place and the first wrong field."""
    try:
        return record(**fields)
    except ValidationError as error:
        first = error.errors()[0]
        field = ".".join(str(part) for part in first["loc"])
        reason = first["msg"].removeprefix("Value error, ")
        if not field:
            raise InputError(f"{place}: {reason}.") from error
        raise InputError(f"{place}: field {field}: {reason} (got {quoted(first['input'])}).") from error


def missing(package: str, purpose: str) -> EngineError:
    """Return the error for a missing package of the extra `geo`."""
    return EngineError(f"{purpose} needs {package}; install safeloc[geo].")


@contextmanager
def within(path: Path) -> Iterator[None]:
    """Apply the rule of the border (`safeloc.runtime.outside`) to maps; errors about the content name the file."""
    with reading_file(path):
        yield


def content(path: Path) -> bytes:
    """Return the file's bytes; InputError if it cannot be read, or is larger than `LARGEST_MAP`."""
    return read_bytes(path, LARGEST_MAP)
