"""A record that carries a field of another kind: harmless where it is null, refused with place and reason otherwise."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from safeloc.errors import InputError, StreamError
from safeloc.runtime.border import Reason
from safeloc.runtime.service.lines import Line
from safeloc.runtime.service.messages import Message, Reader, RecordLine, Refused
from safeloc.runtime.streams.record_files import FIELDS, MEASURED, OWN, read_raw, read_records, record_or_fault
from safeloc.runtime.streams.records import RECORD, Record, Unusable
from tests.runtime.embedding.driving import shipped

SOUND: dict[str, dict[str, object]] = {
    "distance": {"kind": "distance", "time_ms": 100, "end": "front", "unit": "wheel", "distance_mm": 1200},
    "pulses": {"kind": "pulses", "time_ms": 100, "end": "front", "unit": "wheel", "pulses": 3},
    "marker": {"kind": "marker", "time_ms": 100, "end": "front", "marker": 7},
    "value": {"kind": "value", "time_ms": 100, "name": "door", "value": 1},
    "truth": {"kind": "truth", "time_ms": 100, "position_nm": 5},
}
FOREIGN = [(kind, name) for kind in SOUND for name in FIELDS if name not in OWN[kind]]
MEASURED_FOREIGN = [pair for pair in FOREIGN if pair[1] in MEASURED]
VALUES = (7, -1, 0, True, "x", "7", "nan", 1.5, float("nan"), float("inf"), [1], {"a": 1}, 10**30)
Read = Callable[[Path], tuple[object, ...]]
BOTH = pytest.mark.parametrize("read", [read_records, read_raw])


@pytest.fixture(scope="module")
def reader() -> Reader:
    """The reader of a process with the odometry machine."""
    return Reader(shipped("odometry"), {}, inputs=False, numbered=False, first={})


def heard(reader: Reader, row: dict[str, object]) -> Message:
    """What a process makes of the row as a line."""
    return reader.read(Line(1, json.dumps(row).encode()))


def sound(kind: str) -> Record:
    """The record without anything foreign."""
    return RECORD.validate_python(SOUND[kind])


def test_every_pair_is_tried() -> None:
    """Eight measured fields, eight of them at home: 32 pairs remain; with names and ends there are more."""
    assert 5 * len(MEASURED) - 8 == len(MEASURED_FOREIGN) == 32
    assert set(FOREIGN) >= set(MEASURED_FOREIGN)


@pytest.mark.parametrize(("kind", "name"), FOREIGN)
def test_null_is_harmless(kind: str, name: str) -> None:
    """A flat record class writes all its fields: what is null says nothing."""
    assert sound(kind) == record_or_fault({**SOUND[kind], name: None})


@pytest.mark.parametrize("kind", SOUND)
def test_all_nulls_of_a_flat_record_are_harmless(kind: str, tmp_path: Path, reader: Reader) -> None:
    """In files and in a process alike."""
    flat = {**dict.fromkeys(FIELDS), **SOUND[kind]}
    path = tmp_path / "flat.jsonl"
    path.write_text(json.dumps(flat) + "\n", encoding="utf-8")
    assert (sound(kind),) == read_records(path) == read_raw(path)
    said = heard(reader, flat)
    assert isinstance(said, RecordLine)
    assert sound(kind) == said.record


@pytest.mark.parametrize(("kind", "name"), FOREIGN)
def test_a_value_is_refused_and_never_raises(kind: str, name: str, reader: Reader) -> None:
    """Whatever the value is: of which kind the record is, is not certain, so it is none of either."""
    for value in VALUES:
        with pytest.raises(InputError, match=rf"^field {kind}\.{name}: a {kind} record has no such field"):
            record_or_fault({**SOUND[kind], name: value})
        told = heard(reader, {**SOUND[kind], name: value})
        assert isinstance(told, Refused)
        assert told.reason.startswith(f"field {kind}.{name}: ")


@pytest.mark.parametrize(("kind", "name"), FOREIGN)
def test_a_measurement_that_is_none_does_not_hide_a_foreign_field(kind: str, name: str) -> None:
    """Both wrong at once is no fault of a channel, but no record."""
    own = next(field for field in MEASURED if field in SOUND[kind])
    with pytest.raises(InputError, match=rf"^field {kind}\.{name}: "):
        record_or_fault({**SOUND[kind], own: float("nan"), name: 7})
    assert record_or_fault({**SOUND[kind], own: None, name: None}) == Unusable(
        100, sound(kind).channel, Reason.WRONG_TYPE, f"{own}: None"
    )


@BOTH
@pytest.mark.parametrize(("kind", "name"), FOREIGN)
def test_a_filled_cell_of_another_kind_is_refused_with_its_line(
    kind: str, name: str, read: Read, tmp_path: Path
) -> None:
    """In CSV, with file and line; an empty cell there is ordinary."""
    path = tmp_path / "run.csv"
    names = [*SOUND[kind], name]
    cells = ",".join(str(cell) for cell in SOUND[kind].values())
    path.write_text(f"{','.join(names)}\n{cells},\n", encoding="utf-8")
    assert (sound(kind),) == read(path)
    path.write_text(f"{','.join(names)}\n{cells},\n{cells},7\n", encoding="utf-8")
    with pytest.raises(StreamError, match=rf"run\.csv:3: field {kind}\.{name}: a {kind} record has no such field"):
        read(path)


@BOTH
@pytest.mark.parametrize(("kind", "name"), MEASURED_FOREIGN)
def test_the_same_in_parquet(kind: str, name: str, read: Read, tmp_path: Path) -> None:
    """With its row."""
    pyarrow = pytest.importorskip("pyarrow")
    from pyarrow import parquet

    path = tmp_path / "run.parquet"
    value = "7" if name == "value" else 7
    rows = [{**SOUND[kind], name: None}, {**SOUND[kind], name: value}]
    texts = [{**row, "value": str(row["value"])} if row.get("value") is not None else row for row in rows]
    parquet.write_table(pyarrow.Table.from_pylist(texts[:1]), path)
    assert (sound(kind),) == read(path)
    parquet.write_table(pyarrow.Table.from_pylist(texts), path)
    with pytest.raises(StreamError, match=rf"run\.parquet:2: field {kind}\.{name}: "):
        read(path)


def test_a_line_of_thousands_of_fields_is_refused_at_once(reader: Reader) -> None:
    """With an answer of one sentence, however many there are."""
    told = heard(reader, {**SOUND["distance"], **{f"x{number}": 1 for number in range(5_000)}})
    assert isinstance(told, Refused)
    assert told.reason == "5005 names in one line; at most 1000 are read"


@pytest.mark.parametrize("name", ["\ud800", "x" * 60_000, "nan", "\n", "'"])
def test_answers_stay_short(name: str, reader: Reader) -> None:
    """A long or broken name or value is not sent back whole."""
    for row in ({name: 1}, {"kind": name}, {**SOUND["value"], "value": [name]}, {**SOUND["value"], name: [name]}):
        told = heard(reader, row)
        detail = told.reason if isinstance(told, Refused) else f"{told}"
        assert len(detail) < 1_000
        assert "itself failed" not in detail


def test_what_nobody_foresaw_is_told_as_our_own_fault(reader: Reader, monkeypatch: pytest.MonkeyPatch) -> None:
    """A defect of safeloc does not end the process, and is not taken for a flaw of the line."""

    def broken(_: object) -> Record:
        raise ZeroDivisionError("a defect")

    monkeypatch.setattr("safeloc.runtime.service.messages.record_or_fault", broken)
    told = heard(reader, {"vehicle": "7", **SOUND["distance"]})
    assert isinstance(told, Refused)
    assert told.vehicle == "7"
    assert told.reason.startswith("not read: safeloc itself failed on it (ZeroDivisionError: a defect, safeloc/")
    assert told.reason.endswith("Please report it with the input.")
