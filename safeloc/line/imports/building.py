"""From what a file says to records of the map: their refusals become errors that name the place in the file."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from safeloc.errors import EngineError, InputError

Record = TypeVar("Record", bound=BaseModel)


def made(record: type[Record], place: str, **fields: Any) -> Record:
    """The record; InputError with the place and the first field that does not fit."""
    try:
        return record(**fields)
    except ValidationError as error:
        first = error.errors()[0]
        field = ".".join(str(part) for part in first["loc"])
        told = first["msg"].removeprefix("Value error, ")
        if not field:
            raise InputError(f"{place}: {told}.") from error
        raise InputError(f"{place}: field {field}: {told} (got {first['input']!r}).") from error


def missing(package: str, purpose: str) -> EngineError:
    """What to raise where a package of the extra `geo` is not installed."""
    return EngineError(f"{purpose} needs {package}; install safeloc[geo].")


@contextmanager
def within(path: Path) -> Iterator[None]:
    """Errors about what is in the file name the file."""
    try:
        yield
    except InputError as error:
        told = str(error)
        if told.startswith(str(path)):
            raise
        raise InputError(f"{path}: {told}") from error


def content(path: Path) -> bytes:
    """The file's bytes; InputError if it cannot be read."""
    try:
        return path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}.") from error
