"""Step streams: the inputs of a machine, one mapping per step. `replay` reads them, and traces are saved as such.

JSONL     optional first line {"schema": "safeloc-stream/1", "machine": ..., "first": {...}, "kept": [...]}, then one object
          a step; a step contains an input named in `kept` only if it changed since the step before
CSV       one column per input; an empty cell is an absent input; `true` and `false` (in any case) are truth values

Parquet   one column per input, of whole numbers, truth values or text; an empty cell is an absent input; the file's metadata
          may contain the object of JSONL's first line under `safeloc`

JSONL and CSV may be packed with gzip, as `NAME.jsonl.gz` and `NAME.csv.gz` (`gzipped`).
Columns that the machine does not have (such as `truth_mm`) are kept apart as remarks, never passed to it.
"""

from __future__ import annotations

import csv
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from safeloc.errors import StreamError
from safeloc.language.nodes import Value
from safeloc.runtime.outside import quoted, shown, whole_number
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

SCHEMA = "safeloc-stream/1"
Cell = Value | str
_METADATA = b"safeloc"
_ARROW: Mapping[type, str] = {int: "int64", bool: "bool_", str: "string"}


@dataclass(frozen=True)
class StepStream:
    """Steps in order, each with its line in the file (Parquet: its row).

    first    values for state variables whose first value is open
    columns  all names in the file, empty ones too, each with the line where it first occurs
    """

    steps: tuple[Mapping[str, Cell], ...]
    lines: tuple[int, ...]
    first: Mapping[str, Value] = field(default_factory=dict)
    machine: str = ""
    columns: Mapping[str, int] = field(default_factory=dict)


def read_steps(path: Path) -> StepStream:
    """Read a .jsonl, .csv (either also with .gz) or .parquet file; StreamError with file and line for anything that is not a step."""
    with streaming(path):
        match kind_of(existing(path)):
            case ".jsonl" | ".ndjson":
                return _read_jsonl(path)
            case ".csv":
                return _read_csv(path)
            case ".parquet":
                return _read_parquet(path)
            case ".js":
                raise StreamError(f"{path}: holds runs of a report; choose one with --run and the id of its result.")
            case _:
                raise unknown_kind(path)


def write_steps(
    path: Path,
    steps: Sequence[Mapping[str, Cell]],
    *,
    machine: str = "",
    first: Mapping[str, Value] | None = None,
    short: bool = False,
) -> None:
    """Write a .jsonl or .parquet stream with its header, or a .csv stream, which cannot hold `machine` and `first`.

    A path that ends in .jsonl.gz or .csv.gz is written packed.

    short  in .jsonl, write an input that every step has only if it changed
    """
    for number, step in enumerate(steps, 1):
        for key, value in step.items():
            _cell(path, number, key, value)
    header = {"schema": SCHEMA, "machine": machine, "first": dict(first or {})}
    match kind_of(path):
        case ".jsonl" | ".ndjson":
            kept = _in_every(steps) if short else []
            lines = (
                {**header, **({"kept": kept} if kept else {})},
                *(_changed(steps, kept) if kept else map(dict, steps)),
            )
            with created(path) as file:
                file.writelines(json.dumps(line, separators=(", ", ": ")) + "\n" for line in lines)
        case ".csv":
            _write_csv(path, steps, first or {})
        case ".parquet":
            _write_parquet(path, steps, header)
        case _:
            raise unknown_kind(path)


def _in_every(steps: Sequence[Mapping[str, Cell]]) -> list[str]:
    return [name for name in steps[0] if all(name in step for step in steps)] if steps else []


def _changed(steps: Sequence[Mapping[str, Cell]], kept: Sequence[str]) -> Iterator[dict[str, Cell]]:
    """Yield each step without the values in `kept` that are as in the step before; 1 and true differ."""
    always, before = set(kept), dict[str, Cell]()
    for step in steps:
        yield {name: cell for name, cell in step.items() if name not in always or not _same(before.get(name), cell)}
        before.update(step)


def _same(one: Cell | None, other: Cell) -> bool:
    return type(one) is type(other) and one == other


def _write_csv(path: Path, steps: Sequence[Mapping[str, Cell]], first: Mapping[str, Value]) -> None:
    if first:
        raise StreamError(f"{path}: a CSV stream cannot hold initial values {sorted(first)}; write .jsonl.")
    names = list(dict.fromkeys(name for step in steps for name in step))
    if len(names) < 2 and any(not step for step in steps):
        raise StreamError(f"{path}: a step without any input would be an empty line in CSV; write .jsonl.")
    with created(path) as file:
        writer = csv.writer(file)
        writer.writerow(names)
        writer.writerows([_to_text(step.get(name, "")) for name in names] for step in steps)


def _to_text(value: Cell) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)


def _read_jsonl(path: Path) -> StepStream:
    steps: list[Mapping[str, Cell]] = []
    lines: list[int] = []
    first: Mapping[str, Value] = {}
    machine = ""
    kept: list[str] = []
    columns: dict[str, int] = {}
    objects = ((number, json_object(path, number, text)) for number, text in lines_of(path))
    for number, record in bounded(path, objects):
        if not lines and "schema" in record:
            first, machine = _header(path, record)
            kept = _kept(path, record)
            continue
        for name in record:
            columns.setdefault(name, number)
        step = {key: _cell(path, number, key, value) for key, value in record.items() if value is not None}
        left_out = [name for name in kept if name not in record]
        steps.append(_filled(path, number, step, steps[-1] if steps else {}, left_out))
        lines.append(number)
    return StepStream(tuple(steps), tuple(lines), first, machine, columns)


def _header(path: Path, record: Mapping[str, object]) -> tuple[Mapping[str, Value], str]:
    if record.get("schema") != SCHEMA:
        raise StreamError(f"{path}:1: schema is {record.get('schema')!r}; this version reads {SCHEMA!r}.")
    first = record.get("first", {})
    if not isinstance(first, dict):
        raise StreamError(f"{path}:1: `first` must be an object of initial values.")
    machine = record.get("machine", "")
    if not isinstance(machine, str):
        raise StreamError(f"{path}:1: `machine` must be the name of a machine, or left out.")
    return first, machine


def _kept(path: Path, record: Mapping[str, object]) -> list[str]:
    names = record.get("kept", [])
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        raise StreamError(f"{path}:1: `kept` must be a list of inputs that are in every step.")
    return names


def _filled(
    path: Path, number: int, step: Mapping[str, Cell], before: Mapping[str, Cell], left_out: Sequence[str]
) -> Mapping[str, Cell]:
    """Return the step with the values that it leaves out because they are as in the step before."""
    unknown = [name for name in left_out if name not in before]
    if unknown:
        raise StreamError(f"{path}:{number}: {unknown[0]} is left out as kept, but the step before has no value of it.")
    return {**{name: before[name] for name in left_out}, **step}


def _cell(path: Path, number: int, key: str, value: object) -> Cell:
    if isinstance(value, (bool, int, str)):
        return value
    if not_finite(value):
        raise StreamError(
            f"{path}:{number}: {shown(key)} is {value}, no measurement; leave the input out if there is none."
        )
    raise StreamError(
        f"{path}:{number}: {shown(key)} is {quoted(value)}; steps hold whole numbers, truth values and member names."
    )


def _read_csv(path: Path) -> StepStream:
    steps: list[Mapping[str, Cell]] = []
    lines: list[int] = []
    rows = bounded(path, csv_rows(path))
    _, names = next(rows, (1, []))
    if not names or len(set(names)) < len(names) or "" in names:
        raise StreamError(f"{path}:1: the first line must name every column once; got {quoted(names)}.")
    for line, row in rows:
        if len(row) != len(names):
            raise StreamError(f"{path}:{line}: {len(row)} cells, expected {len(names)}.")
        cells = zip(names, row, strict=True)
        steps.append({key: _from_text(path, line, key, cell) for key, cell in cells if cell != ""})
        lines.append(line)
    return StepStream(tuple(steps), tuple(lines), columns=dict.fromkeys(names, 1))


def _from_text(path: Path, number: int, key: str, text: str) -> Cell:
    truth = truth_value(text)
    if truth is not None:
        return truth
    integer = whole_number(text)
    if integer is not None:
        return integer
    try:
        float(text)
    except ValueError:
        return text
    raise StreamError(
        f"{path}:{number}: {shown(key)} is {quoted(text)}; steps hold whole numbers. Convert units, rounding outward."
    )


def _read_parquet(path: Path) -> StepStream:
    rows, names, metadata = read_parquet(path)
    first, machine = _header(path, _metadata(path, metadata))
    steps = tuple(
        {key: _cell(path, number, key, value) for key, value in row.items()} for number, row in enumerate(rows, 1)
    )
    return StepStream(steps, tuple(range(1, len(rows) + 1)), first, machine, dict.fromkeys(names, 1))


def _metadata(path: Path, metadata: Mapping[bytes, bytes]) -> Mapping[str, object]:
    if _METADATA not in metadata:
        return {"schema": SCHEMA}
    try:
        text = metadata[_METADATA].decode()
    except UnicodeDecodeError as error:
        raise StreamError(
            f"{path}: its metadata `{_METADATA.decode()}` is no UTF-8 text; the file is damaged."
        ) from error
    return json_object(path, 1, text)


def _write_parquet(path: Path, steps: Sequence[Mapping[str, Cell]], header: Mapping[str, object]) -> None:
    kinds: dict[str, str] = {}
    for number, step in enumerate(steps, 1):
        for name, value in step.items():
            if kinds.setdefault(name, _ARROW[type(value)]) != _ARROW[type(value)]:
                raise StreamError(f"{path}:{number}: {name} has values of different types; write .jsonl.")
    if steps and not kinds:
        raise StreamError(f"{path}: steps without any input make no table; write .jsonl.")
    write_parquet(path, steps, kinds, {_METADATA.decode(): json.dumps(header)})
