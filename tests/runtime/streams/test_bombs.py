"""Small recordings that stand for large ones are refused with what to do; what is read is bounded in memory."""

from __future__ import annotations

import tracemalloc
from pathlib import Path

import pytest

from safeloc.errors import StreamError
from safeloc.runtime.streams import files
from safeloc.runtime.streams.files import LONGEST_LINE, csv_rows, json_object
from safeloc.runtime.streams.record_files import read_raw
from safeloc.runtime.streams.steps import read_steps


def refused(path: Path, *words: str) -> None:
    """As steps and as records: the file, these words."""
    for read in (read_steps, read_raw):
        with pytest.raises(StreamError) as told:
            read(path)
        assert str(told.value).startswith(f"{path}")
        assert all(word in str(told.value) for word in words), str(told.value)


@pytest.mark.parametrize("name", ["run.jsonl", "run.csv"])
def test_lines_without_end(name: str, tmp_path: Path) -> None:
    """One line of many MB is not taken into memory."""
    path = tmp_path / name
    with path.open("wb") as file:
        for _ in range(50):
            file.write(b"[" * 1_000_000)
    tracemalloc.start()
    refused(path, ":1: a line of more than 1000000 bytes")
    assert tracemalloc.get_traced_memory()[1] < 10_000_000
    tracemalloc.stop()


def test_rows_whose_quotes_never_close(tmp_path: Path) -> None:
    """A row takes as many lines as its quotes ask for, up to a bound."""
    path = tmp_path / "run.csv"
    path.write_text('kind\n"a\n' + '","\n' * 400_000)
    refused(path, "a row of more than 1000000 characters; close its quotes")
    assert LONGEST_LINE == 1_000_000


def test_rows_and_cells_are_counted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """With the line where it becomes too much."""
    path = tmp_path / "run.csv"
    path.write_text("kind,time_ms,position_nm\n" + "truth,1,1\n" * 50)
    monkeypatch.setattr(files, "MOST_ROWS", 40)
    refused(path, "more than 40 rows", "split it")
    monkeypatch.setattr(files, "MOST_ROWS", 100)
    monkeypatch.setattr(files, "MOST_CELLS", 60)
    refused(path, "more than 60 cells")


def test_names_given_twice_are_found_in_one_look(tmp_path: Path) -> None:
    """50 000 names in one line took the square of that."""
    text = ",".join(f'"n{number}":1' for number in [*range(50_000), 7])
    with pytest.raises(StreamError, match=r"run:1: \['n7'\] given twice in one line; keep one\.$"):
        json_object(tmp_path / "run", 1, f"{{{text}}}")


def test_numbers_of_thousands_of_digits(tmp_path: Path) -> None:
    """Are no JSON, and no cell."""
    path = tmp_path / "run.jsonl"
    path.write_text('{"kind": "truth", "time_ms": ' + "9" * 5_000 + "}\n")
    refused(path, ":1: not JSON (Exceeds the limit")


def test_equal_rows_in_parquet(tmp_path: Path) -> None:
    """20 million equal rows are 200 kB in the file."""
    pyarrow = pytest.importorskip("pyarrow")
    from pyarrow import parquet

    path = tmp_path / "run.parquet"
    table = pyarrow.table(
        {"kind": pyarrow.DictionaryArray.from_arrays(pyarrow.array([0] * 1_000_000, "int8"), ["truth"])}
    )
    with parquet.ParquetWriter(path, table.schema) as writer:
        for _ in range(11):
            writer.write_table(table)
    assert path.stat().st_size < 100_000
    tracemalloc.start()
    refused(path, "more than 10000000 rows")
    assert tracemalloc.get_traced_memory()[1] < 10_000_000
    tracemalloc.stop()


def test_long_texts_in_parquet(tmp_path: Path) -> None:
    """One text of 100 kB in 20 000 rows would be 2 GB; it is looked at once."""
    pyarrow = pytest.importorskip("pyarrow")
    from pyarrow import parquet

    path = tmp_path / "run.parquet"
    kind = pyarrow.DictionaryArray.from_arrays(pyarrow.array([0] * 20_000, "int8"), ["x" * 100_000])
    parquet.write_table(pyarrow.table({"kind": kind}), path)
    assert path.stat().st_size < 300_000
    before = pyarrow.default_memory_pool().bytes_allocated()
    refused(path, "column 'kind' has a cell of 100000 bytes")
    assert pyarrow.default_memory_pool().max_memory() - before < 400_000_000


def test_many_empty_columns_in_parquet(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Cells are counted, filled or not."""
    pyarrow = pytest.importorskip("pyarrow")
    from pyarrow import parquet

    path = tmp_path / "run.parquet"
    monkeypatch.setattr("safeloc.runtime.streams.parquet.MOST_CELLS", 1_000_000)
    parquet.write_table(pyarrow.table({f"c{at}": pyarrow.nulls(10_001, "int64") for at in range(100)}), path)
    refused(path, "more than 1000000 cells")


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("bits", [0x80, 0xFF])
def test_damaged_parquet_is_refused(tmp_path: Path, bits: int) -> None:
    """Any one byte of it changed, names of columns among them: a StreamError, or another recording."""
    pyarrow = pytest.importorskip("pyarrow")
    from pyarrow import parquet

    path, damaged = tmp_path / "run.parquet", tmp_path / "damaged.parquet"
    columns = {"kind": ["truth"] * 3, "time_ms": [1, 2, 3], "position_nm": [1, 2, 3]}
    parquet.write_table(pyarrow.table(columns), path)
    whole = path.read_bytes()
    for at in range(len(whole)):
        damaged.write_bytes(whole[:at] + bytes([whole[at] ^ bits]) + whole[at + 1 :])
        for read in (read_raw, read_steps):
            try:
                read(damaged)
            except StreamError as error:
                assert str(error).startswith(str(damaged))  # noqa: PT017 - most of them, not all, are refused


def test_csv_counts_lines_within_quotes(tmp_path: Path) -> None:
    """A row's line is its last one."""
    path = tmp_path / "run.csv"
    path.write_text('a,b\n"1\n2",3\n4,5\n')
    assert [(1, ["a", "b"]), (3, ["1\n2", "3"]), (4, ["4", "5"])] == list(csv_rows(path))
