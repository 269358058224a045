"""Step streams: what is written is read back with its lines; what is no step is refused."""

from __future__ import annotations

import json
import math
import re
import sys
from pathlib import Path

import pyarrow.parquet
import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.errors import StreamError
from safeloc.runtime.streams.steps import Cell, read_steps, write_steps

STEPS: list[dict[str, Cell]] = [
    {"speed": -3, "door_closed": True, "state": "OPEN"},
    {"speed": 4},
    {"door_closed": False},
]


@pytest.mark.parametrize("suffix", [".jsonl", ".ndjson", ".csv", ".parquet", ".jsonl.gz", ".ndjson.gz", ".csv.gz"])
def test_steps_come_back_as_written(tmp_path: Path, suffix: str) -> None:
    """Absent inputs stay absent; True stays apart from 1; each step knows its line."""
    path = tmp_path / f"run{suffix}"
    write_steps(path, STEPS)
    stream = read_steps(path)
    assert [repr(step) for step in stream.steps] == [repr(step) for step in STEPS]
    assert stream.lines == ((1, 2, 3) if suffix == ".parquet" else (2, 3, 4))


@pytest.mark.parametrize("suffix", [".jsonl", ".jsonl.gz", ".parquet"])
def test_a_saved_trace_keeps_machine_and_initial_values(tmp_path: Path, suffix: str) -> None:
    """So that a counterexample can be replayed."""
    path = tmp_path / f"trace{suffix}"
    write_steps(path, STEPS, machine="door", first={"truth_nm": 5})
    stream = read_steps(path)
    assert (stream.machine, stream.first) == ("door", {"truth_nm": 5})


def test_a_csv_stream_cannot_keep_initial_values(tmp_path: Path) -> None:
    """They are refused, not lost."""
    with pytest.raises(StreamError, match=r"a CSV stream cannot hold initial values \['truth_nm'\]; write \.jsonl\.$"):
        write_steps(tmp_path / "trace.csv", STEPS, first={"truth_nm": 5})


def test_an_empty_step_is_not_lost_in_csv(tmp_path: Path) -> None:
    """With one column it would be an empty line."""
    with pytest.raises(StreamError, match=r"would be an empty line in CSV; write \.jsonl\.$"):
        write_steps(tmp_path / "run.csv", [{"speed": 1}, {}])


@pytest.mark.parametrize("value", [1.5, float("nan"), None])
def test_what_is_no_cell_is_not_written(tmp_path: Path, value: object) -> None:
    """A stream that cannot be read back is not made."""
    with pytest.raises(StreamError, match=r":1: speed is (.*; steps hold whole numbers|nan, no measurement; leave)"):
        write_steps(tmp_path / "run.jsonl", [{"speed": value}])  # type: ignore[dict-item]


@given(steps=st.lists(st.dictionaries(st.sampled_from(["a", "b", "c"]), st.integers() | st.booleans(), min_size=1)))
def test_any_stream_survives(tmp_path_factory: pytest.TempPathFactory, steps: list[dict[str, Cell]]) -> None:
    """Numbers of any size, absent and present in any pattern."""
    folder = tmp_path_factory.mktemp("streams")
    for name in ("run.jsonl", "run.csv"):
        if steps or name == "run.jsonl":
            write_steps(folder / name, steps)
            assert [repr(dict(sorted(step.items()))) for step in read_steps(folder / name).steps] == [
                repr(dict(sorted(step.items()))) for step in steps
            ]


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("run.jsonl", '{"a": NaN}', "run.jsonl:1: a is nan, no measurement; leave the input out"),
        ("run.jsonl", '\n\n{"a": 1.5}', "run.jsonl:3: a is 1.5; steps hold whole numbers"),
        ("run.jsonl", '{"a": [1]}', "run.jsonl:1: a is [1]; steps hold"),
        ("run.jsonl", '{"a": 1, "a": 2}', "run.jsonl:1: ['a'] given twice in one line; keep one."),
        ("run.jsonl", "3", "run.jsonl:1: expected an object, got int."),
        ("run.jsonl", "{", "run.jsonl:1: not JSON ("),
        (
            "run.jsonl",
            '{"schema": "other/9"}',
            "run.jsonl:1: schema is 'other/9'; this version reads ",
        ),
        ("run.jsonl", '{"schema": "safeloc-stream/1", "first": 3}', "run.jsonl:1: `first` must be an object"),
        ("run.csv", "a,a\n1,2\n", "run.csv:1: the first line must name every column once; got ['a', 'a']."),
        ("run.csv", "", "run.csv:1: the first line must name every column once; got []."),
        ("run.csv", "a,b\n1\n", "run.csv:2: 1 cells, expected 2."),
        ("run.csv", "a,b\n1,nan\n", "run.csv:2: b is 'nan'; steps hold whole numbers."),
        ("run.csv", "a,b\n1,1e3\n", "run.csv:2: b is '1e3'; steps hold whole numbers."),
        ("run.csv", "a,b\n1,1_0\n", "run.csv:2: b is '1_0'; steps hold whole numbers."),
        (
            "run.txt",
            "",
            "run.txt: unknown kind of file '.txt'; use .jsonl, .csv, either of them also with .gz, or .parquet.",
        ),
    ],
)
def test_what_is_no_step_is_refused(tmp_path: Path, name: str, text: str, message: str) -> None:
    """With file and line, and the input where there is one."""
    path = tmp_path / name
    path.write_text(text)
    with pytest.raises(StreamError, match=re.escape(message)):
        read_steps(path)


@pytest.mark.parametrize("name", ["run.jsonl", "run.csv"])
def test_bytes_that_are_no_text_are_refused(tmp_path: Path, name: str) -> None:
    """As a StreamError."""
    path = tmp_path / name
    path.write_bytes(b"\xff\xfe")
    with pytest.raises(StreamError, match=r":1: not UTF-8 text \(invalid start byte at byte 0 of it\)\.$"):
        read_steps(path)


def test_a_missing_file_and_a_wrong_suffix_are_refused(tmp_path: Path) -> None:
    """Before anything is written or read."""
    with pytest.raises(StreamError, match=r"none\.jsonl: no such file\.$"):
        read_steps(tmp_path / "none.jsonl")
    with pytest.raises(
        StreamError,
        match=r"unknown kind of file '\.txt'; use \.jsonl, \.csv, either of them also with \.gz, or \.parquet\.$",
    ):
        write_steps(tmp_path / "run.txt", STEPS)
    assert not list(tmp_path.iterdir())


@given(st.lists(st.fixed_dictionaries({}, optional={"a": st.integers(-(2**63), 2**63 - 1), "b": st.booleans()})))
def test_any_table_survives(tmp_path_factory: pytest.TempPathFactory, steps: list[dict[str, Cell]]) -> None:
    """Parquet keeps every 64-bit number, truth value and absence, also a step with nothing in it."""
    path = tmp_path_factory.mktemp("streams") / "run.parquet"
    if not steps or any(steps):
        write_steps(path, steps)
        assert [repr(dict(sorted(step.items()))) for step in read_steps(path).steps] == [
            repr(dict(sorted(step.items()))) for step in steps
        ]


@pytest.mark.parametrize(
    ("steps", "message"),
    [
        ([{"a": 1}, {"a": True}], r"run\.parquet:2: a has values of different types; write \.jsonl\.$"),
        ([{}], r"run\.parquet: steps without any input make no table; write \.jsonl\.$"),
        ([{"a": 2**63}], r"run\.parquet: a number does not fit into 64 bits \(.*\); write \.jsonl\.$"),
    ],
)
def test_what_is_no_table_is_not_written(tmp_path: Path, steps: list[dict[str, Cell]], message: str) -> None:
    """Nothing is converted to fit into a column."""
    with pytest.raises(StreamError, match=message):
        write_steps(tmp_path / "run.parquet", steps)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("column", "message"),
    [
        ([1.0, math.nan], r"run\.parquet:1: a is 1\.0; steps hold whole numbers"),
        ([math.nan], r"run\.parquet:1: a is nan, no measurement; leave the input out if there is none\.$"),
        ([[1]], r"run\.parquet: column 'a' holds 'list<element: int64>'; a column holds whole numbers"),
    ],
)
def test_a_table_of_other_cells_is_refused(tmp_path: Path, column: list[object], message: str) -> None:
    """A float column is not rounded, and its NaN is not taken for an absent input."""
    path = tmp_path / "run.parquet"
    pyarrow.parquet.write_table(pyarrow.table({"a": column}), path)
    with pytest.raises(StreamError, match=message):
        read_steps(path)


def test_a_table_with_a_name_twice_is_refused(tmp_path: Path) -> None:
    """One of the two columns would be lost."""
    path = tmp_path / "run.parquet"
    pyarrow.parquet.write_table(pyarrow.Table.from_arrays([pyarrow.array([1]), pyarrow.array([2])], ["a", "a"]), path)
    with pytest.raises(StreamError, match=r"every column needs a name of its own; got \['a', 'a'\]\.$"):
        read_steps(path)


@pytest.mark.parametrize("writes", [True, False])
def test_without_pyarrow_the_extra_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, writes: bool) -> None:
    """Parquet is an extra, for reading and for writing."""
    path = tmp_path / "run.parquet"
    write_steps(path, STEPS)
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(StreamError, match=r"Parquet needs pyarrow; install safeloc\[parquet\], or use \.jsonl or"):
        write_steps(path, STEPS) if writes else read_steps(path)


def test_a_folder_is_no_stream(tmp_path: Path) -> None:
    """The message says so."""
    with pytest.raises(StreamError, match=r": a folder, not a file\.$"):
        read_steps(tmp_path)


SHORT: list[dict[str, Cell]] = [
    {"a": 1, "b": True, "word": "UP"}, {"a": 1, "b": True, "word": "UP", "now and then": 7}, {"a": 0, "b": True, "word": "UP"},
    {"a": False, "b": True, "word": "DOWN"}, {"a": 0, "b": True, "word": "DOWN"},
]  # fmt: skip


def test_a_short_stream_says_only_what_changes(tmp_path: Path) -> None:
    """What is in every step stands where it changes, 0 is not false, and all of it comes back."""
    path = tmp_path / "short.jsonl"
    write_steps(path, SHORT, machine="m", first={"x": 3}, short=True)
    lines = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]
    assert ["a", "b", "word"] == lines[0]["kept"]
    assert [SHORT[0], {"now and then": 7}, {"a": 0}, {"a": False, "word": "DOWN"}, {"a": 0}] == lines[1:]
    stream = read_steps(path)
    assert SHORT == list(stream.steps)
    assert [repr(step["a"]) for step in SHORT] == [repr(step["a"]) for step in stream.steps]
    assert ({"x": 3}, "m") == (stream.first, stream.machine)


@given(steps=st.lists(st.dictionaries(st.sampled_from("abc"), st.integers() | st.booleans()), max_size=6))
def test_any_short_stream_survives(tmp_path_factory: pytest.TempPathFactory, steps: list[dict[str, Cell]]) -> None:
    """Also with inputs that are absent now and then."""
    path = tmp_path_factory.mktemp("short") / "stream.jsonl"
    write_steps(path, steps, short=True)
    assert repr([sorted(step.items()) for step in steps]) == repr(
        [sorted(one.items()) for one in read_steps(path).steps]
    )


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        (['{"schema": "safeloc-stream/1", "kept": ["a"]}', '{"b": 1}'], ":2: a is left out as kept, but the step before has no value of it"),
        (['{"schema": "safeloc-stream/1", "kept": ["a"]}', '{"a": 1}', '{"a": null}', "{}"], ":4: a is left out as kept"),
        (['{"schema": "safeloc-stream/1", "kept": "a"}', '{"a": 1}'], ":1: `kept` must be a list of inputs"),
    ],
)  # fmt: skip
def test_nothing_is_kept_that_was_not_said(tmp_path: Path, lines: list[str], message: str) -> None:
    """Left out at first, left out after it was absent, no list."""
    path = tmp_path / "kept.jsonl"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    with pytest.raises(StreamError, match=re.escape(message)):
        read_steps(path)
