"""What files of records and files of steps have in common: text, lines of JSON, and Parquet by way of pyarrow."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from safeloc.errors import StreamError

FORMATS = "use .jsonl, .csv or .parquet"
LONGEST_CELL = 1_000
"""Characters in a cell of CSV; what is longer is no number, truth value or name."""


def text_of(path: Path) -> str:
    """The file's text without a byte order mark; StreamError if it is none, or cannot be read."""
    try:
        return path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        raise StreamError(f"{path}: not UTF-8 text ({error.reason} at byte {error.start}).") from error
    except OSError as error:
        raise StreamError(f"{path}: cannot be read: {error.strerror}.") from error


def existing(path: Path) -> Path:
    """The path, if it is a file."""
    if not path.is_file():
        raise StreamError(f"{path}: {'a folder, not a file' if path.is_dir() else 'no such file'}.")
    return path


def unknown_kind(path: Path) -> StreamError:
    """What to raise for a suffix that says nothing."""
    return StreamError(f"{path}: unknown kind of file {path.suffix!r}; {FORMATS}.")


def json_object(path: Path, line: int, text: str) -> dict[str, Any]:
    """One line's object. NaN and infinities come through as such: whoever knows the field refuses them."""

    def once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        names = [name for name, _ in pairs]
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            raise StreamError(f"{path}:{line}: {twice} given twice in one line; keep one.")
        return dict(pairs)

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
    """Every row with its line in the file, the names of the columns first; StreamError for what is no table."""
    reader = csv.reader(io.StringIO(text_of(path), newline=""))
    try:
        for row in reader:
            longest = max(map(len, row), default=0)
            if longest > LONGEST_CELL:
                raise StreamError(
                    f"{path}:{reader.line_num}: a cell of {longest} characters; a cell is one number, truth value or name."
                )
            yield reader.line_num, row
    except csv.Error as error:
        raise StreamError(
            f"{path}:{reader.line_num}: not CSV ({error}); one row a line, commas between cells."
        ) from error


def truth_value(text: str) -> bool | None:
    """What `true` or `false` says, in any case (spreadsheets write TRUE); None for other text."""
    return {"true": True, "false": False}.get(text.lower())


def not_finite(value: object) -> bool:
    """Whether this is, or spells, a NaN or an infinity."""
    try:
        return isinstance(value, (float, str)) and not math.isfinite(float(value))
    except ValueError:
        return False


def read_parquet(path: Path) -> tuple[list[dict[str, Any]], Mapping[bytes, bytes]]:
    """Rows without their empty cells, and the metadata of the file."""
    pyarrow, parquet = _pyarrow(path)
    try:
        table = parquet.ParquetFile(path).read()  # read_table would make columns of `name=value` in the path
    except (pyarrow.ArrowException, OSError) as error:
        raise StreamError(f"{path}: not a Parquet file ({error}).") from error
    names = table.column_names
    if len(set(names)) < len(names):
        raise StreamError(f"{path}: every column needs a name of its own; got {names}.")
    rows = [{name: cell for name, cell in row.items() if cell is not None} for row in table.to_pylist()]
    return rows, table.schema.metadata or {}


def write_parquet(
    path: Path, rows: Sequence[Mapping[str, Any]], types: Mapping[str, str], metadata: Mapping[str, str] | None = None
) -> None:
    """Rows as a table with these columns, each of Arrow type `int64`, `bool_` or `string`; absent cells are empty."""
    pyarrow, parquet = _pyarrow(path)
    columns = [(name, getattr(pyarrow, kind)()) for name, kind in types.items()]
    try:
        table = pyarrow.Table.from_pylist(list(rows), schema=pyarrow.schema(columns, metadata=metadata))
    except (pyarrow.ArrowException, OverflowError) as error:
        raise StreamError(f"{path}: a number does not fit into 64 bits ({error}); write .jsonl.") from error
    parquet.write_table(table, path)


def _pyarrow(path: Path) -> tuple[Any, Any]:
    try:
        import pyarrow
        from pyarrow import parquet
    except ImportError as error:
        raise StreamError(f"{path}: Parquet needs pyarrow; install safeloc[parquet], or use .jsonl or .csv.") from error
    return pyarrow, parquet
