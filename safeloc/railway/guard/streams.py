"""Reads position streams line by line: CSV with a header row, and JSON with one object in each line."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterable, Iterator

from safeloc.errors import StreamError
from safeloc.railway.guard.deliveries import Delivery
from safeloc.railway.guard.fields import Columns, delivery
from safeloc.runtime.outside import shortened

_LONGEST_LINE = 100_000


def csv_deliveries(lines: Iterable[str], columns: Columns, name: str) -> Iterator[Delivery]:
    """Yield a delivery for every row; StreamError if columns are missing. `name` stands for the stream in messages."""
    rows = csv.reader(_checked(lines))
    header = [one.strip().removeprefix("\ufeff") for one in next(rows, [])]
    missing = [column for column in columns.named if column not in header]
    if missing:
        raise StreamError(f"{name}:1: column {missing[0]!r} is missing; there are {', '.join(header) or 'none'}.")
    twice = sorted({column for column in columns.named if header.count(column) > 1})
    if twice:
        raise StreamError(f"{name}:1: column {twice[0]!r} is there twice.")
    while True:
        try:
            row = next(rows, None)
        except csv.Error as error:
            yield Delivery(rows.line_num, wrong=f"not CSV ({error})")
            continue
        if row is None:
            return
        if row:
            yield _of_row(rows.line_num, header, row, columns)


def _of_row(number: int, header: list[str], row: list[str], columns: Columns) -> Delivery:
    if len(row) != len(header):
        return Delivery(number, wrong=f"{len(row)} cells under {len(header)} columns")
    return delivery(number, dict(zip(header, row, strict=True)), columns)


def jsonl_deliveries(lines: Iterable[str], columns: Columns) -> Iterator[Delivery]:
    """Yield a delivery for every line that is not empty."""
    for number, line in enumerate(_checked(lines), 1):
        if line.strip():
            yield _of_object(number, line, columns)


def _of_object(number: int, line: str, columns: Columns) -> Delivery:
    try:
        found = json.loads(line)
    except (ValueError, RecursionError) as error:
        return Delivery(number, wrong=f"not JSON ({shortened(error)})")
    if not isinstance(found, dict):
        return Delivery(number, wrong=f"expected an object, got {type(found).__name__}")
    return delivery(number, found, columns)


def _checked(lines: Iterable[str]) -> Iterator[str]:
    """Cut lines that are too long or contain NUL to something that the reader refuses."""
    for line in lines:
        yield line.replace("\0", "\N{REPLACEMENT CHARACTER}")[:_LONGEST_LINE]
