"""Files of records: JSONL (one record per line), CSV (one column per field, empty if not given), Parquet (same columns).

JSONL and CSV may be packed with gzip (`gzipped`).

Records are returned in the order of the file. Nothing is sorted, repaired or left out: the cycle builder (`cycles`) checks
for late, repeated and disordered records. A row that is no record raises a StreamError with file and line. An invalid
measurement (NaN, text, a fraction) is refused in the same way by `read_records`; `read_raw` returns it as `Unusable`, a
fault of its channel.
"""

from __future__ import annotations

import csv
import difflib
import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar, get_args

from pydantic import ValidationError

from safeloc.errors import InputError, StreamError, UnforeseenError
from safeloc.runtime.border import Reason
from safeloc.runtime.outside import quoted, refusal, shown, whole_number
from safeloc.runtime.streams.files import (
    bounded,
    csv_rows,
    existing,
    json_object,
    lines_of,
    not_finite,
    streaming,
    truth_value,
    unknown_kind,
)
from safeloc.runtime.streams.gzipped import created, kind_of
from safeloc.runtime.streams.parquet import read_parquet, write_parquet
from safeloc.runtime.streams.records import RECORD, Record, Unusable

FIELDS: tuple[str, ...] = (
    "kind", "time_ms", "end", "unit", "distance_mm", "pulses", "marker", "position_mm", "accuracy_mm", "since_mm", "name",
    "value", "position_nm",
)  # fmt: skip
"""Columns of a table of records; each row fills the columns of its kind."""

_TEXT_FIELDS = ("kind", "end", "unit", "name")
MEASURED = ("distance_mm", "pulses", "marker", "position_mm", "accuracy_mm", "since_mm", "value", "position_nm")
"""Fields with measured values; the others identify the device and give the time."""

OWN: Mapping[str, frozenset[str]] = {
    kind.model_fields["kind"].default: frozenset(kind.model_fields) for kind in get_args(Record)
}
"""Kind -> the fields that its records have."""

_Row = Mapping[str, Any]

_VALIDATED: Callable[[_Row], Record] = RECORD.validator.validate_python
"""A direct call of the validator: that of the adapter takes a quarter longer."""


def read_records(path: Path) -> tuple[Record, ...]:
    """Return all records of a .jsonl, .ndjson, .csv (these also with .gz) or .parquet file, in order; StreamError for an
    invalid measurement."""
    return tuple(_each(path, _record))


def read_raw(path: Path) -> tuple[Record | Unusable, ...]:
    """Return the same records, with `Unusable` for a record with an invalid measurement."""
    return tuple(_each(path, record_or_fault))


_Result = TypeVar("_Result")


def _each(path: Path, read: Callable[[_Row], _Result]) -> Iterator[_Result]:
    """Yield every row of the file, as `read` returns it. StreamError with file and line for a row that cannot be read."""
    with streaming(path):
        for line, row in bounded(path, _rows(path)):
            yield _located(path, line, row, read)


def _located(path: Path, line: int, row: _Row, read: Callable[[_Row], _Result]) -> _Result:
    try:
        return read(row)
    except InputError as error:
        raise StreamError(f"{path}:{line}: {error}") from error
    except (OSError, MemoryError):
        raise
    except Exception as error:
        raise UnforeseenError(f"{path}:{line}: {refusal(error)}") from error


def _rows(path: Path) -> Iterator[tuple[int, _Row]]:
    match kind_of(existing(path)):
        case ".jsonl" | ".ndjson":
            return _jsonl_rows(path)
        case ".csv":
            return _csv_rows(path)
        case ".parquet":
            return _parquet_rows(path)
        case _:
            raise unknown_kind(path)


def write_records(path: Path, records: Sequence[Record]) -> None:
    """Write records in the given order; the suffix chooses the format."""
    rows = [record.model_dump(exclude_none=True) for record in records]
    match kind_of(path):
        case ".jsonl" | ".ndjson":
            with created(path) as file:
                file.writelines(json.dumps(row) + "\n" for row in rows)
        case ".csv":
            _write_csv(path, rows)
        case ".parquet":
            _write_parquet(path, rows)
        case _:
            raise unknown_kind(path)


def record_or_fault(row: _Row) -> Record | Unusable:
    """Return one row of any origin as a record, or as a fault of its channel; InputError if it is no record.

    A field of another kind of record is accepted if it is null: programs with one flat class for all records write such fields.
    If it has a value, the row is no record, since its kind and so its device are uncertain.
    """
    try:
        return _VALIDATED(_narrow(row))
    except ValidationError as error:
        plain = _of_its_kind(row)
        if len(plain) < len(row):
            return record_or_fault(plain)
        unusable = _unusable(row, error)
        if unusable is None:
            raise InputError(_flaw(row, error)) from error
        return unusable


def _record(row: _Row) -> Record:
    """Return one row as a record; InputError if it is none, or has an invalid measurement."""
    try:
        return _VALIDATED(_narrow(row))
    except ValidationError as error:
        plain = _of_its_kind(row)
        if len(plain) < len(row):
            return _record(plain)
        raise InputError(_flaw(row, error)) from error


def _narrow(row: _Row) -> _Row:
    """Return the row; InputError if it has more fields than any record, since the message would name each of them."""
    if len(row) > len(FIELDS):
        raise InputError(f"{len(row)} fields, but a record has at most {len(FIELDS)}; correct it or take it out.")
    return row


def _of_its_kind(row: _Row) -> _Row:
    """Return the row without the empty fields of other kinds. InputError if such a field has a value."""
    kind = row.get("kind")
    fields = OWN.get(kind) if isinstance(kind, str) else None
    if fields is None:
        return row
    foreign = [name for name in row if name not in fields and name in FIELDS]
    for name in foreign:
        if row[name] is not None:
            others = " and ".join(other for other, names in OWN.items() if name in names)
            raise InputError(
                f"field {kind}.{name}: a {kind} record has no such field, only {others} has "
                f"(got {quoted(row[name])}); leave it empty, or correct the kind."
            )
    return {name: value for name, value in row.items() if name not in foreign}


def _flaw(row: _Row, error: ValidationError) -> str:
    strange = [f"{shown(name)} is {value}" for name, value in row.items() if not_finite(value)]
    if strange:
        return f"{strange[0]}, no measurement; leave the record out if there is none."
    first = error.errors(include_url=False)[0]
    where = ".".join(shown(str(part)) for part in first["loc"]) or "kind"
    return f"field {where}: {first['msg'][:400]} (got {quoted(first['input'])}); correct the record or take it out."


def _unusable(row: _Row, error: ValidationError) -> Unusable | None:
    """Return the fault if only measured values are wrong, else None. Zeros replace them only to find the channel."""
    wrong = {str(place) for one in error.errors(include_url=False) for place in one["loc"][1:2]}
    if not wrong or not wrong <= set(MEASURED) & set(row):
        return None
    sender = RECORD.validate_python({**row, **dict.fromkeys(wrong, 0)})
    detail = ", ".join(f"{name}: {quoted(row[name])}" for name in sorted(wrong))
    return Unusable(sender.time_ms, sender.channel, _reason(row, wrong, error), detail)


def _reason(row: _Row, wrong: set[str], error: ValidationError) -> Reason:
    if any(not_finite(row[name]) for name in wrong):
        return Reason.NOT_FINITE
    below = all(one["type"] == "greater_than_equal" for one in error.errors())
    return Reason.OUT_OF_RANGE if below else Reason.WRONG_TYPE


def _jsonl_rows(path: Path) -> Iterator[tuple[int, _Row]]:
    return ((line, json_object(path, line, text)) for line, text in lines_of(path))


def _csv_rows(path: Path) -> Iterator[tuple[int, _Row]]:
    rows = csv_rows(path)
    _, names = next(rows, (1, []))
    if "kind" not in names or len(set(names)) < len(names):
        raise StreamError(
            f"{path}:1: the first line must name every column once, `kind` among them; got {quoted(names)}."
        )
    _refuse_unknown(path, names)
    for line, cells in rows:
        if len(cells) != len(names):
            raise StreamError(f"{path}:{line}: {len(cells)} cells, expected {len(names)}.")
        filled = {name: cell for name, cell in zip(names, cells, strict=True) if cell != ""}
        yield line, {name: _value(name, cell) for name, cell in filled.items()}


def _refuse_unknown(path: Path, names: Iterable[str]) -> None:
    """Refuse a column that no record has, even an empty one: its name is misspelt."""
    for name in names:
        if name not in FIELDS:
            close = difflib.get_close_matches(name, FIELDS, n=1)
            hint = f" Did you mean {close[0]!r}?" if close else ""
            raise StreamError(f"{path}:1: no record has a column {quoted(name)}; there are {', '.join(FIELDS)}.{hint}")


def _value(name: str, text: str) -> int | bool | str:
    """Return a whole number, a truth value or, for anything else, the text, which a field for numbers then refuses."""
    if name in _TEXT_FIELDS:
        return text
    truth = truth_value(text)
    if truth is not None:
        return truth
    integer = whole_number(text)
    return text if integer is None else integer


def _write_csv(path: Path, rows: Sequence[_Row]) -> None:
    with created(path) as file:
        writer = csv.DictWriter(file, FIELDS)
        writer.writeheader()
        writer.writerows({name: _cell(value) for name, value in row.items()} for row in rows)


def _cell(value: object) -> object:
    return str(value).lower() if isinstance(value, bool) else value


def _parquet_rows(path: Path) -> Iterator[tuple[int, _Row]]:
    rows, names, _ = read_parquet(path)
    _refuse_unknown(path, names)
    for line, row in enumerate(rows, 1):
        yield line, {name: _value(name, cell) if _is_text_value(name, cell) else cell for name, cell in row.items()}


def _is_text_value(name: str, cell: object) -> bool:
    """Return whether the cell is a `value`: its column is text, since it may be a number, a truth value or a name."""
    return name == "value" and isinstance(cell, str)


def _write_parquet(path: Path, rows: Sequence[_Row]) -> None:
    text = (*_TEXT_FIELDS, "value")
    cells = [{**row, "value": str(_cell(row["value"]))} if "value" in row else row for row in rows]
    write_parquet(path, cells, {name: "string" if name in text else "int64" for name in FIELDS})
