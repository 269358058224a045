"""Files of records: what is written is read back; what is no record is refused with file, line and field."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import pytest

from safeloc.errors import StreamError
from safeloc.runtime.border import Reason
from safeloc.runtime.streams.record_files import FIELDS, read_raw, read_records, write_records
from safeloc.runtime.streams.records import (
    DistanceRecord,
    MarkerRecord,
    PulseRecord,
    Record,
    TruthRecord,
    Unusable,
    ValueRecord,
)

EVERY_KIND: tuple[Record, ...] = (
    DistanceRecord(time_ms=100, end="front", unit="wheel", distance_mm=-12),
    PulseRecord(time_ms=100, end="rear", pulses=3),
    MarkerRecord(time_ms=90, end="rear", marker=7, position_mm=-500, accuracy_mm=200, since_mm=3),
    MarkerRecord(time_ms=90, end="front", marker=8),
    ValueRecord(time_ms=90, name="door_closed", value=True),
    ValueRecord(time_ms=90, name="doors", value=1),
    ValueRecord(time_ms=90, name="state", value="OPEN"),
    TruthRecord(time_ms=100, position_nm=123_456_789_012_345),
)


@pytest.mark.parametrize("suffix", [".jsonl", ".ndjson", ".csv", ".parquet", ".jsonl.gz", ".ndjson.gz", ".csv.gz"])
def test_records_come_back_as_written(tmp_path: Path, suffix: str) -> None:
    """Every kind, in the order given, times out of order and repeated included; True stays apart from 1."""
    path = tmp_path / f"run{suffix}"
    write_records(path, EVERY_KIND)
    back = read_records(path)
    assert back == EVERY_KIND
    assert [repr(record) for record in EVERY_KIND] == [repr(record) for record in back]


def test_columns_of_a_table_are_all_fields_of_all_kinds() -> None:
    """A field added to a record must not be lost in a table."""
    assert set(FIELDS) == {name for record in EVERY_KIND for name in type(record).model_fields}


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ('{"kind": "truth", "time_ms": 1, "position_nm": NaN}', "run.jsonl:2: position_nm is nan, no measurement"),
        (
            '{"kind": "truth", "time_ms": 1, "position_nm": -Infinity}',
            "run.jsonl:2: position_nm is -inf, no measurement",
        ),
        ('{"kind": "truth", "time_ms": 1, "position_nm": 1.5}', "run.jsonl:2: field truth.position_nm: "),
        ('{"kind": "truth", "time_ms": 1, "position_nm": "1"}', "run.jsonl:2: field truth.position_nm: "),
        ('{"kind": "truth", "time_ms": 1, "position_nm": true}', "run.jsonl:2: field truth.position_nm: "),
        ('{"kind": "truth", "time_ms": -1, "position_nm": 1}', "run.jsonl:2: field truth.time_ms: "),
        ('{"kind": "truth", "position_nm": 1}', "run.jsonl:2: field truth.time_ms: Field required"),
        ('{"kind": "truth", "time_ms": 1, "position_nm": 1, "x": 1}', "run.jsonl:2: field truth.x: Extra inputs"),
        ('{"kind": "balise", "time_ms": 1}', "run.jsonl:2: field kind: Input tag 'balise'"),
        ('{"time_ms": 1}', "run.jsonl:2: field kind: Unable to extract tag"),
        ('{"time_ms": 1, "time_ms": 2}', "run.jsonl:2: ['time_ms'] given twice in one line; keep one."),
        ("[1]", "run.jsonl:2: expected an object, got list."),
        ("{", "run.jsonl:2: not JSON ("),
    ],
)
def test_a_line_that_is_no_record_is_refused(tmp_path: Path, line: str, message: str) -> None:
    """The message names file, line and field; nothing is converted, and lines after blank ones count right."""
    path = tmp_path / "run.jsonl"
    path.write_text("\n" + line + "\n")
    with pytest.raises(StreamError, match=re.escape(message)):
        read_records(path)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("kind,time_ms,position_nm\ntruth,1,nan\n", "run.csv:2: position_nm is nan, no measurement"),
        ("kind,time_ms,position_nm\ntruth,1,1e3\n", "run.csv:2: field truth.position_nm: "),
        ("kind,time_ms,position_nm\ntruth,,3\n", "run.csv:2: field truth.time_ms: Field required"),
        ("kind,time_ms,position_nm\ntruth,1\n", "run.csv:2: 2 cells, expected 3."),
        ("time_ms,position_nm\n1,1\n", "run.csv:1: the first line must name every column once, `kind` among them"),
        ("kind,kind\ntruth,truth\n", "run.csv:1: the first line must name every column once"),
        ("", "run.csv:1: the first line must name every column once"),
    ],
)
def test_a_row_that_is_no_record_is_refused(tmp_path: Path, text: str, message: str) -> None:
    """An empty cell is an absent field, and an absent field that is needed is an error."""
    path = tmp_path / "run.csv"
    path.write_text(text)
    with pytest.raises(StreamError, match=re.escape(message)):
        read_records(path)


def test_without_pyarrow_the_extra_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Parquet is an extra."""
    path = tmp_path / "run.parquet"
    path.write_bytes(b"")
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(
        StreamError, match=r"Parquet needs pyarrow; install safeloc\[parquet\], or use \.jsonl or \.csv\.$"
    ):
        read_records(path)


@pytest.mark.parametrize("suffix", [".parquet", ".jsonl"])
def test_a_file_of_another_kind_is_refused(tmp_path: Path, suffix: str) -> None:
    """Bytes that are no such file are a StreamError, not a trace of somebody else's code."""
    path = tmp_path / f"run{suffix}"
    path.write_bytes(b"\xff\xfe\x00garbage")
    with pytest.raises(StreamError, match=r"not a Parquet file|not UTF-8 text"):
        read_records(path)


@pytest.mark.parametrize("name", ["missing.jsonl", "run.txt"])
def test_unknown_files_are_refused(tmp_path: Path, name: str) -> None:
    """A missing file and an unknown suffix."""
    (tmp_path / "run.txt").write_text("")
    with pytest.raises(
        StreamError,
        match=r"no such file\.$|unknown kind of file '.txt'; use \.jsonl, \.csv, either of them also with \.gz, or \.parquet\.$",
    ):
        read_records(tmp_path / name)


RAW = {
    '{"kind": "truth", "time_ms": 1, "position_nm": NaN}': ("truth", Reason.NOT_FINITE, "position_nm: nan"),
    '{"kind": "distance", "time_ms": 1, "end": "rear", "unit": "radar", "distance_mm": -Infinity}': (
        "rear_radar", Reason.NOT_FINITE, "distance_mm: -inf"),
    '{"kind": "distance", "time_ms": 1, "end": "rear", "unit": "radar", "distance_mm": 1.5}': (
        "rear_radar", Reason.WRONG_TYPE, "distance_mm: 1.5"),
    '{"kind": "pulses", "time_ms": 1, "end": "front", "pulses": "3"}': (
        "front_wheel", Reason.WRONG_TYPE, "pulses: '3'"),
    '{"kind": "pulses", "time_ms": 1, "end": "front", "pulses": "nan"}': (
        "front_wheel", Reason.NOT_FINITE, "pulses: 'nan'"),
    '{"kind": "marker", "time_ms": 1, "end": "front", "marker": -1, "accuracy_mm": -2}': (
        "front_marker", Reason.OUT_OF_RANGE, "accuracy_mm: -2, marker: -1"),
    '{"kind": "value", "time_ms": 1, "name": "door", "value": NaN}': ("door", Reason.NOT_FINITE, "value: nan"),
    '{"kind": "value", "time_ms": 1, "name": "door", "value": [1]}': ("door", Reason.WRONG_TYPE, "value: [1]"),
}  # fmt: skip


@pytest.mark.parametrize("line", RAW)
def test_a_measurement_that_is_none_is_a_fault_of_its_channel(tmp_path: Path, line: str) -> None:
    """Read raw, it is no end of the recording: who spoke, when, and why it is not used."""
    path = tmp_path / "run.jsonl"
    path.write_text(line + "\n")
    channel, reason, detail = RAW[line]
    assert read_raw(path) == (Unusable(1, channel, reason, detail),)


def test_raw_and_sound_are_the_same_where_nothing_is_wrong(tmp_path: Path) -> None:
    """Only what cannot be used differs."""
    path = tmp_path / "run.csv"
    write_records(path, EVERY_KIND)
    assert read_raw(path) == EVERY_KIND


@pytest.mark.parametrize(
    "line",
    [
        '{"kind": "truth", "time_ms": NaN, "position_nm": 1}',
        '{"kind": "truth", "time_ms": 1}',
        '{"kind": "balise", "time_ms": 1, "value": NaN}',
        '{"kind": "pulses", "time_ms": 1, "end": "middle", "pulses": NaN}',
        '{"kind": "pulses", "time_ms": 1, "end": "front", "pulses": NaN, "x": 1}',
    ],
)
def test_what_tells_not_who_spoke_and_when_is_refused_raw_as_well(tmp_path: Path, line: str) -> None:
    """It is a fault of no channel."""
    path = tmp_path / "run.jsonl"
    path.write_text(line + "\n")
    with pytest.raises(StreamError, match=r"run\.jsonl:1: "):
        read_raw(path)
