"""Files of records: JSONL (one record a line), CSV (one column a field, empty: not given), Parquet (same columns).

Records come back in the order of the file. Nothing is sorted, repaired or left out: late, repeated and disordered
records are for the cycle builder to judge (`cycles`); what is no record at all is a StreamError with file and line.
`read_records` refuses a measurement that is none (NaN, text, a fraction) in the same way; `read_raw` hands it over as
`Unusable`, a fault of its channel.
"""

from __future__ import annotations

import csv
import json
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from safeloc.border import Reason
from safeloc.errors import InputError, StreamError
from safeloc.streams.files import (
    csv_rows,
    existing,
    json_object,
    not_finite,
    read_parquet,
    text_of,
    truth_value,
    unknown_kind,
    write_parquet,
)
from safeloc.streams.records import RECORD, Record, Unusable

WHOLE = re.compile(r"[+-]?\d+")
FIELDS: tuple[str, ...] = (
    "kind", "time_ms", "end", "unit", "step_mm", "pulses", "marker", "position_mm", "accuracy_mm", "since_mm", "name",
    "value", "position_nm",
)  # fmt: skip
"""Columns of a table of records; each row fills those its kind has."""

TEXT_FIELDS = ("kind", "end", "unit", "name")
MEASURED = ("step_mm", "pulses", "marker", "position_mm", "accuracy_mm", "since_mm", "value", "position_nm")
"""Fields that say what was measured; the others say who speaks, and when."""

Row = Mapping[str, Any]

_VALIDATED: Callable[[Row], Record] = RECORD.validator.validate_python
"""The adapter's own call has arguments that are not used here, and takes a quarter longer."""


def read_records(path: Path) -> tuple[Record, ...]:
    """All records of a .jsonl, .ndjson, .csv or .parquet file, in order; StreamError for what is no measurement."""
    return tuple(_record(path, line, row) for line, row in _rows(path))


def read_raw(path: Path) -> tuple[Record | Unusable, ...]:
    """The same, with `Unusable` where a device spoke but what it said is no measurement."""
    return tuple(_record_or_fault(path, line, row) for line, row in _rows(path))


def _rows(path: Path) -> Iterator[tuple[int, Row]]:
    match existing(path).suffix:
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
    match path.suffix:
        case ".jsonl" | ".ndjson":
            path.write_text("".join(json.dumps(row) + "\n" for row in rows), encoding="utf-8")
        case ".csv":
            _write_csv(path, rows)
        case ".parquet":
            _write_parquet(path, rows)
        case _:
            raise unknown_kind(path)


def record_or_fault(row: Row) -> Record | Unusable:
    """What one row of any origin says; InputError where it is no record at all."""
    try:
        return _VALIDATED(row)
    except ValidationError as error:
        unusable = _unusable(row, error)
        if unusable is None:
            raise InputError(_flaw(row, error)) from error
        return unusable


def _record(path: Path, line: int, row: Row) -> Record:
    try:
        return RECORD.validate_python(row)
    except ValidationError as error:
        raise StreamError(f"{path}:{line}: {_flaw(row, error)}") from error


def _record_or_fault(path: Path, line: int, row: Row) -> Record | Unusable:
    try:
        return record_or_fault(row)
    except InputError as error:
        raise StreamError(f"{path}:{line}: {error}") from error


def _flaw(row: Row, error: ValidationError) -> str:
    strange = [f"{name} is {value}" for name, value in row.items() if not_finite(value)]
    if strange:
        return f"{strange[0]}, no measurement; leave the record out where there is none."
    first = error.errors()[0]
    where = ".".join(str(part) for part in first["loc"]) or "kind"
    return f"field {where}: {first['msg']} (got {first['input']!r}); mend the record or take it out."


def _unusable(row: Row, error: ValidationError) -> Unusable | None:
    """The fault, if nothing but what was measured is wrong; zeros stand there only to learn who speaks."""
    wrong = {str(place) for one in error.errors() for place in one["loc"][1:2]}
    if not wrong or not wrong <= set(MEASURED) & set(row):
        return None
    speaker = RECORD.validate_python({**row, **dict.fromkeys(wrong, 0)})
    detail = ", ".join(f"{name}: {row[name]!r}" for name in sorted(wrong))
    return Unusable(speaker.time_ms, speaker.channel, _reason(row, wrong, error), detail)


def _reason(row: Row, wrong: set[str], error: ValidationError) -> Reason:
    if any(not_finite(row[name]) for name in wrong):
        return Reason.NOT_FINITE
    below = all(one["type"] == "greater_than_equal" for one in error.errors())
    return Reason.OUT_OF_RANGE if below else Reason.WRONG_TYPE


def _jsonl_rows(path: Path) -> Iterator[tuple[int, Row]]:
    for line, text in enumerate(text_of(path).split("\n"), 1):
        if text.strip():
            yield line, json_object(path, line, text)


def _csv_rows(path: Path) -> Iterator[tuple[int, Row]]:
    rows = csv_rows(path)
    _, names = next(rows, (1, []))
    if "kind" not in names or len(set(names)) < len(names):
        raise StreamError(f"{path}:1: the first line must name every column once, `kind` among them; got {names}.")
    for line, cells in rows:
        if len(cells) != len(names):
            raise StreamError(f"{path}:{line}: {len(cells)} cells, expected {len(names)}.")
        filled = {name: cell for name, cell in zip(names, cells, strict=True) if cell != ""}
        yield line, {name: _value(name, cell) for name, cell in filled.items()}


def _value(name: str, text: str) -> int | bool | str:
    """Whole numbers and truth values; all else stays text, which a number field then refuses."""
    if name in TEXT_FIELDS:
        return text
    truth = truth_value(text)
    if truth is not None:
        return truth
    return int(text) if WHOLE.fullmatch(text) else text


def _write_csv(path: Path, rows: Sequence[Row]) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, FIELDS)
        writer.writeheader()
        writer.writerows({name: _cell(value) for name, value in row.items()} for row in rows)


def _cell(value: object) -> object:
    return str(value).lower() if isinstance(value, bool) else value


def _parquet_rows(path: Path) -> Iterator[tuple[int, Row]]:
    for line, row in enumerate(read_parquet(path)[0], 1):
        yield line, {name: _value(name, cell) if name == "value" else cell for name, cell in row.items()}


def _write_parquet(path: Path, rows: Sequence[Row]) -> None:
    text = (*TEXT_FIELDS, "value")
    cells = [{**row, "value": str(_cell(row["value"]))} if "value" in row else row for row in rows]
    write_parquet(path, cells, {name: "string" if name in text else "int64" for name in FIELDS})
