"""Bounded reading of text, lines of JSON and tables, for files of records and files of steps."""

from __future__ import annotations

import csv
import json
import math
from collections import Counter
from collections.abc import Iterable, Iterator, Sized
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar

from safeloc.errors import InputError, StreamError, UnforeseenError
from safeloc.runtime.outside import quoted, read_lines, reading, refuse_beyond
from safeloc.runtime.streams.gzipped import is_packed, unpacked_lines

_FORMATS = "use .jsonl, .csv, either of them also with .gz, or .parquet"
LONGEST_LINE = 1_000_000
"""Most bytes of a line of JSON or a row of CSV: enough for a step with ten thousand inputs."""
LONGEST_CELL = 1_000
"""Most characters in a cell of a table: a cell is a number, a truth value or a name."""
MOST_ROWS = 10_000_000
"""Most lines or rows of one file: eleven days of steps of 100 ms."""
MOST_CELLS = 100_000_000
"""Most cells or fields of one file."""

_Content = TypeVar("_Content", bound=Sized)


@contextmanager
def streaming(path: Path) -> Iterator[None]:
    """Apply the rule for external input (`safeloc.runtime.outside`) to streams: a flaw raises a StreamError, any other
    exception becomes an UnforeseenError."""
    try:
        with reading(path):
            yield
    except (StreamError, UnforeseenError):
        raise
    except InputError as error:
        raise StreamError(str(error)) from error


def bounded(path: Path, rows: Iterable[tuple[int, _Content]]) -> Iterator[tuple[int, _Content]]:
    """Yield the same rows; StreamError beyond `MOST_ROWS` or `MOST_CELLS`, so that the memory for a file is bounded."""
    cells = 0
    for count, (line, row) in enumerate(rows, 1):
        cells += len(row)
        if count > MOST_ROWS or cells > MOST_CELLS:
            refuse_beyond(f"{path}:{line}", count, MOST_ROWS, "rows")
            refuse_beyond(f"{path}:{line}", cells, MOST_CELLS, "cells")
        yield line, row


def lines_of(path: Path) -> Iterator[tuple[int, str]]:
    """Yield each line that is not blank with its number; only one is in memory at a time."""
    return ((number, text) for number, text in _lines(path) if text.strip())


def _lines(path: Path) -> Iterator[tuple[int, str]]:
    return unpacked_lines(path, LONGEST_LINE) if is_packed(path) else read_lines(path, LONGEST_LINE)


def existing(path: Path) -> Path:
    """Return the path if it is a file; StreamError otherwise."""
    if not path.is_file():
        there = "a folder, not a file" if path.is_dir() else "a device, pipe or socket, not a file"
        raise StreamError(f"{path}: {there if path.exists() else 'no such file'}.")
    return path


def unknown_kind(path: Path) -> StreamError:
    """Return the error for an unknown suffix."""
    return StreamError(f"{path}: unknown kind of file {path.suffix!r}; {_FORMATS}.")


def json_object(path: Path, line: int, text: str) -> dict[str, Any]:
    """Return the object of one line. NaN and infinities are kept: the reader of the field refuses them."""

    def once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        fields = dict(pairs)
        if len(fields) < len(pairs):
            twice = sorted(name for name, count in Counter(name for name, _ in pairs).items() if count > 1)
            raise StreamError(f"{path}:{line}: {quoted(twice)} given twice in one line; keep one.")
        return fields

    try:
        found = json.loads(text, object_pairs_hook=once)
    except StreamError:
        raise
    except RecursionError as error:
        raise StreamError(f"{path}:{line}: nested too deeply; a line is one object of plain values.") from error
    except ValueError as error:
        what = f"{error.msg} at column {error.colno}" if isinstance(error, json.JSONDecodeError) else str(error)
        raise StreamError(f"{path}:{line}: not JSON ({what}).") from error
    if not isinstance(found, dict):
        raise StreamError(f"{path}:{line}: expected an object, got {type(found).__name__}.")
    return found


def csv_rows(path: Path) -> Iterator[tuple[int, list[str]]]:
    """Yield every row with its line in the file, the names of the columns first; StreamError if the file is no table."""
    fed = _Fed(path)
    reader = csv.reader(fed)
    try:
        for row in reader:
            longest = max(map(len, row), default=0)
            if longest > LONGEST_CELL:
                raise StreamError(
                    f"{path}:{reader.line_num}: a cell of {longest} characters; a cell is one number, truth value or name."
                )
            fed.row_ends()
            yield reader.line_num, row
    except csv.Error as error:
        raise StreamError(
            f"{path}:{reader.line_num}: not CSV ({error}); write one row per line, with commas between cells."
        ) from error


class _Fed:
    """Lines for the CSV reader. Open quotes make it read on: StreamError for a row that becomes too long."""

    def __init__(self, path: Path) -> None:
        self._path, self._lines, self._size = path, _lines(path), 0

    def __iter__(self) -> Iterator[str]:
        return self

    def __next__(self) -> str:
        number, text = next(self._lines)
        self._size += len(text)
        if self._size > LONGEST_LINE:
            raise StreamError(f"{self._path}:{number}: a row of more than {LONGEST_LINE} characters; close its quotes.")
        return f"{text}\n"

    def row_ends(self) -> None:
        """Note that the next line begins a new row."""
        self._size = 0


def truth_value(text: str) -> bool | None:
    """Return the truth value of `true` or `false` in any case (spreadsheets write TRUE); None for other text."""
    return {"true": True, "false": False}.get(text.lower())


def not_finite(value: object) -> bool:
    """Return whether this is a NaN or an infinity, as a number or as text."""
    try:
        return isinstance(value, (float, str)) and not math.isfinite(float(value))
    except ValueError:
        return False
