"""From what a file says to records of the map: their refusals become errors that name the place in the file."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from safeloc.errors import EngineError, InputError
from safeloc.runtime.outside import quoted, read_bytes, reading_file

LARGEST_MAP = 200_000_000
"""Bytes of a map file: a country's micro topology."""

Record = TypeVar("Record", bound=BaseModel)


def made(record: type[Record], place: str, **fields: Any) -> Record:
    """Return the record; InputError with the place and the first field that does not fit."""
    try:
        return record(**fields)
    except ValidationError as error:
        first = error.errors()[0]
        field = ".".join(str(part) for part in first["loc"])
        told = first["msg"].removeprefix("Value error, ")
        if not field:
            raise InputError(f"{place}: {told}.") from error
        raise InputError(f"{place}: field {field}: {told} (got {quoted(first['input'])}).") from error


def missing(package: str, purpose: str) -> EngineError:
    """Make the error for a missing package of the extra `geo`."""
    return EngineError(f"{purpose} needs {package}; install safeloc[geo].")


@contextmanager
def within(path: Path) -> Iterator[None]:
    """The rule of the border (`safeloc.runtime.outside`) for maps; errors about what is in the file name the file."""
    with reading_file(path):
        yield


def content(path: Path) -> bytes:
    """Return the file's bytes; InputError if it cannot be read, or is larger than `LARGEST_MAP`."""
    return read_bytes(path, LARGEST_MAP)
