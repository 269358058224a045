"""Runs as tables, a row a step: CSV, and Parquet with pyarrow (extra `parquet`)."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from pathlib import Path

from safeloc.report.run_files.columns import Cell, RunColumns
from safeloc.runtime.streams.parquet import write_parquet

_STEP, _TIME, _TRUTH = "step", "time_ms", "truth_mm"
_TYPES = {"number": "int64", "truth": "bool_", "label": "string"}


def write_csv(path: Path, run: RunColumns) -> None:
    """Write the run as CSV; truth values are true and false, absent values are empty."""
    with path.open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(types_of(run))
        table.writerows([_text(cell) for cell in row.values()] for row in rows_of(run))


def write_parquet_table(path: Path, run: RunColumns) -> None:
    """Write the run as Parquet; absent values are null. StreamError without pyarrow."""
    write_parquet(path, list(rows_of(run)), types_of(run), {"machine": run.machine})


def types_of(run: RunColumns) -> dict[str, str]:
    """Return the columns of the table with their types in Arrow's names."""
    time = {_TIME: "int64"} if run.period_ms else {}
    truth = {_TRUTH: "int64"} if run.truth_mm else {}
    return {_STEP: "int64", **time, **{one.heading: _TYPES[one.kind] for one in run.columns}, **truth}


def rows_of(run: RunColumns) -> Iterator[dict[str, Cell]]:
    """Yield a row for each step, from 1; its time is that of the end of the step."""
    for number in range(run.steps):
        row: dict[str, Cell] = {_STEP: number + 1}
        if run.period_ms:
            row[_TIME] = (number + 1) * run.period_ms
        row |= {one.heading: one.values[number] for one in run.columns}
        if run.truth_mm:
            row[_TRUTH] = run.truth_mm[number]
        yield row


def _text(cell: Cell) -> str:
    if cell is None:
        return ""
    return str(cell).lower() if isinstance(cell, bool) else str(cell)
