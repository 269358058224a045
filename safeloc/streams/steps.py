"""Step streams: the inputs of a machine, one mapping a step. What `replay` reads and what traces are saved as.

JSONL   optional first line {"schema": "safeloc-stream/1", "machine": ..., "first": {...}}, then one object a step
CSV     one column an input; an empty cell is an absent input; `true` and `false` are truth values

Columns that the machine does not have (such as `truth_mm`) are kept apart as remarks, never passed to it.
"""

from __future__ import annotations

import csv
import io
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from safeloc.errors import StreamError
from safeloc.nodes import Value

SCHEMA = "safeloc-stream/1"
Cell = Value | str
WHOLE = re.compile(r"[+-]?[0-9]+")


@dataclass(frozen=True)
class StepStream:
    """Steps in order, each with its line in the file; `first` chooses values of open initial state variables."""

    steps: tuple[Mapping[str, Cell], ...]
    lines: tuple[int, ...]
    first: Mapping[str, Value] = field(default_factory=dict)
    machine: str = ""


def read_steps(path: Path) -> StepStream:
    """Read a .jsonl or .csv file; StreamError with file and line for anything that is not a step."""
    if not path.is_file():
        raise StreamError(f"{path}: no such file.")
    if path.suffix == ".csv":
        return _read_csv(path)
    if path.suffix in (".jsonl", ".ndjson"):
        return _read_jsonl(path)
    raise StreamError(f"{path}: unknown kind of file {path.suffix!r}; use .jsonl or .csv.")


def write_steps(
    path: Path, steps: Sequence[Mapping[str, Cell]], *, machine: str = "", first: Mapping[str, Value] | None = None
) -> None:
    """Write a .jsonl stream with its header, or a .csv one, which has no room for `machine` and `first`."""
    for number, step in enumerate(steps, 1):
        for key, value in step.items():
            _cell(path, number, key, value)
    if path.suffix == ".csv":
        _write_csv(path, steps, first or {})
        return
    if path.suffix not in (".jsonl", ".ndjson"):
        raise StreamError(f"{path}: unknown kind of file {path.suffix!r}; use .jsonl or .csv.")
    header = {"schema": SCHEMA, "machine": machine, "first": dict(first or {})}
    text = "".join(json.dumps(line, separators=(", ", ": ")) + "\n" for line in (header, *map(dict, steps)))
    path.write_text(text, encoding="utf-8")


def _write_csv(path: Path, steps: Sequence[Mapping[str, Cell]], first: Mapping[str, Value]) -> None:
    if first:
        raise StreamError(f"{path}: a CSV stream cannot hold initial values {sorted(first)}; write .jsonl.")
    names = list(dict.fromkeys(name for step in steps for name in step))
    if len(names) < 2 and any(not step for step in steps):
        raise StreamError(f"{path}: a step without any input would be an empty line in CSV; write .jsonl.")
    with path.open("w", newline="", encoding="utf-8") as file:
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
    for number, text in enumerate(_text(path).split("\n"), 1):
        if not text.strip():
            continue
        record = _parsed(path, number, text)
        if not lines and "schema" in record:
            first, machine = _header(path, record)
            continue
        steps.append({key: _cell(path, number, key, value) for key, value in record.items() if value is not None})
        lines.append(number)
    return StepStream(tuple(steps), tuple(lines), first, machine)


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        raise StreamError(f"{path}: not UTF-8 text ({error.reason} at byte {error.start}).") from error


def _parsed(path: Path, number: int, text: str) -> dict[str, object]:
    def refuse(constant: str) -> float:
        raise StreamError(f"{path}:{number}: {constant} is no measurement; leave the input out where there is none.")

    try:
        record = json.loads(text, parse_constant=refuse, object_pairs_hook=lambda pairs: _once(path, number, pairs))
    except json.JSONDecodeError as error:
        raise StreamError(f"{path}:{number}: not JSON ({error.msg} at column {error.colno}).") from error
    if not isinstance(record, dict):
        raise StreamError(f"{path}:{number}: expected an object with one entry an input, got {type(record).__name__}.")
    return record


def _once(path: Path, number: int, pairs: list[tuple[str, object]]) -> dict[str, object]:
    names = [name for name, _ in pairs]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise StreamError(f"{path}:{number}: {twice} given twice in one step; keep one.")
    return dict(pairs)


def _header(path: Path, record: Mapping[str, object]) -> tuple[Mapping[str, Value], str]:
    if record["schema"] != SCHEMA:
        raise StreamError(f"{path}:1: schema is {record['schema']!r}; this version reads {SCHEMA!r}.")
    first = record.get("first", {})
    if not isinstance(first, dict):
        raise StreamError(f"{path}:1: `first` must be an object of initial values.")
    return first, str(record.get("machine", ""))


def _cell(path: Path, number: int, key: str, value: object) -> Cell:
    if isinstance(value, (bool, int, str)):
        return value
    raise StreamError(f"{path}:{number}: {key} is {value!r}; steps hold whole numbers, truth values and member names.")


def _read_csv(path: Path) -> StepStream:
    steps: list[Mapping[str, Cell]] = []
    lines: list[int] = []
    reader = csv.reader(io.StringIO(_text(path), newline=""))
    names = next(reader, [])
    if not names or len(set(names)) < len(names) or "" in names:
        raise StreamError(f"{path}:1: the first line must name every column once; got {names}.")
    for row in reader:
        if len(row) != len(names):
            raise StreamError(f"{path}:{reader.line_num}: {len(row)} cells, expected {len(names)}.")
        cells = zip(names, row, strict=True)
        steps.append({key: _from_text(path, reader.line_num, key, cell) for key, cell in cells if cell != ""})
        lines.append(reader.line_num)
    return StepStream(tuple(steps), tuple(lines))


def _from_text(path: Path, number: int, key: str, text: str) -> Cell:
    if text in ("true", "false"):
        return text == "true"
    if WHOLE.fullmatch(text):
        return int(text)
    try:
        float(text)
    except ValueError:
        return text
    raise StreamError(f"{path}:{number}: {key} is {text!r}; steps hold whole numbers. Convert units, rounding outward.")
