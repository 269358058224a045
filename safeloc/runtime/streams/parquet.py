"""Tables in Parquet, read and written with pyarrow (extra `parquet`): columns of whole numbers, truth values and text.

A Parquet file of some kilobytes may unpack to gigabytes, since equal values are stored once. So the sizes in its metadata are
checked before it is read, rows are read in batches, equal texts of a batch are stored once, and cells are counted.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from safeloc.errors import StreamError
from safeloc.runtime.outside import LARGEST_FILE, quoted, refuse_beyond, shortened
from safeloc.runtime.streams.files import LONGEST_CELL, MOST_CELLS, MOST_ROWS

_BATCH_ROWS = 10_000
_MOST_COLUMNS = 10_000

_Row = dict[str, Any]


def read_parquet(path: Path) -> tuple[list[_Row], Sequence[str], Mapping[bytes, bytes]]:
    """Return the rows without their empty cells, the names of all columns, and the metadata of the file.

    StreamError for a file that is no Parquet file, has columns of other types, or is too large.
    """
    pyarrow, parquet = _pyarrow(path)
    try:
        with parquet.ParquetFile(path) as file:  # read_table would turn `name=value` in the path into columns
            names = _names(path, file.schema_arrow)
            _refuse_large(path, file.metadata, len(names))
            _refuse_kinds(path, pyarrow, file.schema_arrow)
            metadata = file.schema_arrow.metadata or {}
        return list(_rows(path, pyarrow, parquet, names)), names, metadata
    except (pyarrow.ArrowException, OSError, UnicodeDecodeError) as error:
        raise StreamError(f"{path}: not a Parquet file ({shortened(error)}).") from error


def _names(path: Path, schema: Any) -> list[str]:
    try:
        names: list[str] = schema.names
    except UnicodeDecodeError as error:
        raise StreamError(f"{path}: the name of a column is not UTF-8 text; the file is damaged.") from error
    if len(set(names)) < len(names):
        raise StreamError(f"{path}: every column needs a name of its own; got {quoted(names)}.")
    return names


def _refuse_large(path: Path, metadata: Any, columns: int) -> None:
    """Refuse a file whose metadata exceed a limit; other sizes are checked while the file is read."""
    refuse_beyond(path, columns, _MOST_COLUMNS, "columns")
    refuse_beyond(path, metadata.num_rows, MOST_ROWS, "rows")
    refuse_beyond(path, metadata.num_rows * columns, MOST_CELLS, "cells")
    size = sum(metadata.row_group(group).total_byte_size for group in range(metadata.num_row_groups))
    refuse_beyond(path, size, LARGEST_FILE, "bytes in its columns")


def _refuse_kinds(path: Path, pyarrow: Any, schema: Any) -> None:
    plain = pyarrow.types
    for field in schema:
        kind = field.type.value_type if plain.is_dictionary(field.type) else field.type
        if not (_is_text(pyarrow, kind) or plain.is_primitive(kind) or plain.is_null(kind)):
            raise StreamError(
                f"{path}: column {quoted(field.name)} holds {quoted(str(kind))}; "
                "a column holds whole numbers, truth values or text."
            )


def _is_text(pyarrow: Any, kind: Any) -> bool:
    return bool(pyarrow.types.is_string(kind) or pyarrow.types.is_large_string(kind))


def _rows(path: Path, pyarrow: Any, parquet: Any, names: Sequence[str]) -> Iterator[_Row]:
    """Yield the rows, read in batches; equal texts of a batch are one object in memory."""
    count = 0
    with parquet.ParquetFile(path, read_dictionary=names) as file:
        for batch in file.iter_batches(_BATCH_ROWS, use_threads=False):
            batch.validate(full=True)  # indices in a damaged file may point beyond its texts
            refuse_beyond(path, count + batch.num_rows, min(MOST_ROWS, MOST_CELLS // max(1, len(names))), "rows")
            columns = [_cells(path, pyarrow, name, column) for name, column in zip(names, batch.columns, strict=True)]
            rows = zip(*columns, strict=True) if columns else ((),) * batch.num_rows
            for cells in rows:
                count += 1
                yield {name: cell for name, cell in zip(names, cells, strict=True) if cell is not None}


def _cells(path: Path, pyarrow: Any, name: str, column: Any) -> list[Any]:
    if not (pyarrow.types.is_dictionary(column.type) and _is_text(pyarrow, column.type.value_type)):
        return list(column.to_pylist())
    texts = column.dictionary
    longest = pyarrow.compute.max(pyarrow.compute.binary_length(texts)).as_py() or 0
    if longest > LONGEST_CELL:
        raise StreamError(f"{path}: column {quoted(name)} has a cell of {longest} bytes; a cell is one number or name.")
    values = texts.to_pylist()
    return [None if at is None else values[at] for at in column.indices.to_pylist()]


def write_parquet(
    path: Path, rows: Sequence[Mapping[str, Any]], types: Mapping[str, str], metadata: Mapping[str, str] | None = None
) -> None:
    """Write rows as a table; `types` are its columns, each of Arrow type `int64`, `bool_` or `string`; absent cells are empty."""
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
        import pyarrow.compute
        from pyarrow import parquet
    except ImportError as error:
        raise StreamError(f"{path}: Parquet needs pyarrow; install safeloc[parquet], or use .jsonl or .csv.") from error
    return pyarrow, parquet
