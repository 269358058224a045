"""What files of steps and of records have in common: spreadsheets' habits are read, hostile files are refused."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from safeloc.errors import StreamError
from safeloc.runtime.streams.record_files import FIELDS, read_raw
from safeloc.runtime.streams.steps import read_steps

Reader = Callable[[Path], object]
BOTH = pytest.mark.parametrize("read", [read_steps, read_raw])


def refused(read: Reader, path: Path, text: str) -> str:
    """What a person reads."""
    path.write_text(text, encoding="utf-8")
    with pytest.raises(StreamError) as error:
        read(path)
    return str(error.value).removeprefix(str(path))


def test_steps_from_a_spreadsheet(tmp_path: Path) -> None:
    """Excel saves CSV with a byte order mark, TRUE and FALSE, and CRLF."""
    path = tmp_path / "excel.csv"
    path.write_bytes(b"\xef\xbb\xbfspeed,closed\r\n3,TRUE\r\n4,FALSE\r\n")
    assert [repr(step) for step in read_steps(path).steps] == [
        repr(step) for step in ({"speed": 3, "closed": True}, {"speed": 4, "closed": False})
    ]


def test_records_from_a_spreadsheet(tmp_path: Path) -> None:
    """The same of single records."""
    path = tmp_path / "excel.csv"
    path.write_bytes(b"\xef\xbb\xbfkind,time_ms,name,value\r\nvalue,10,closed,TRUE\r\n")
    (record,) = read_raw(path)
    assert getattr(record, "value", None) is True


def test_jsonl_with_a_byte_order_mark(tmp_path: Path) -> None:
    """It is no part of the first line."""
    path = tmp_path / "run.jsonl"
    path.write_bytes(b'\xef\xbb\xbf{"speed": 3}\n')
    assert read_steps(path).steps == ({"speed": 3},)


@BOTH
def test_deep_nesting(read: Reader, tmp_path: Path) -> None:
    """A line nested deeper than Python recurses is refused by its line."""
    deep = '{"a": ' + "[" * 100_000 + "]" * 100_000 + "}"
    assert refused(read, tmp_path / "deep.jsonl", deep).startswith(":1: nested too deeply")


@BOTH
@pytest.mark.parametrize(("cell", "message"), [("9" * 5_000, "a cell of 5000 characters"), ("x" * 200_000, "not CSV")])
def test_giant_cells(read: Reader, tmp_path: Path, cell: str, message: str) -> None:
    """Neither csv's limit nor that of Python's whole numbers ends in a traceback."""
    assert refused(read, tmp_path / "giant.csv", f"kind,value\nvalue,{cell}\n").startswith(f":2: {message}")


@BOTH
def test_a_name_given_twice_is_said_once(read: Reader, tmp_path: Path) -> None:
    """File and line stand there once, and it is not called something that is no JSON."""
    told = refused(read, tmp_path / "dup.jsonl", '{"a": 1, "a": 2}')
    assert told == ":1: ['a'] given twice in one line; keep one."


@pytest.mark.parametrize("machine", ["3", "null", "[]"])
def test_the_machine_of_a_header_is_a_name(tmp_path: Path, machine: str) -> None:
    """Anything else is refused, not turned into text."""
    header = f'{{"schema": "safeloc-stream/1", "machine": {machine}}}\n'
    assert re.match(r":1: `machine` must be the name", refused(read_steps, tmp_path / "run.jsonl", header))


def test_the_sample_of_the_documentation(tmp_path: Path) -> None:
    """The recording in docs/records.md is read as it stands, and every column of a table is described there."""
    text = (Path(__file__).parents[3] / "docs" / "records.md").read_text(encoding="utf-8")
    path = tmp_path / "records.csv"
    path.write_text(text.split("```")[1].lstrip(), encoding="utf-8")
    assert [record.channel for record in read_raw(path)] == ["front_wheel", "front_radar", "front_marker"]
    described = "\n".join(line.split("|")[1] for line in text.splitlines() if line.startswith("|"))
    assert [name for name in FIELDS if f"`{name}`" not in described] == []
