"""The rule of every border: what comes from outside raises nothing but a located refusal, and our own faults are told."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from safeloc.catalogue import load_target, read_config
from safeloc.errors import InputError, StreamError, UnforeseenError
from safeloc.models.guard.variables import GuardConfig
from safeloc.proof.verification.replay import replay_stream
from safeloc.railway.guard.fields import Columns, delivery
from safeloc.railway.guard.nmea import nmea_deliveries
from safeloc.railway.map.imports.formats import FORMATS
from safeloc.railway.map.recorded_run import read_fixes
from safeloc.railway.map.toml_files import load_line
from safeloc.runtime.outside import (
    MOST_DIGITS,
    number,
    quoted,
    read_bytes,
    read_lines,
    read_text,
    reading,
    refusal,
    whole_number,
)
from safeloc.runtime.streams.record_files import read_raw, read_records
from safeloc.runtime.streams.steps import read_steps
from safeloc.sensing.satellite.almanac import read_almanac
from safeloc.sensing.satellite.android import read_android
from safeloc.sensing.satellite.corrected import read_corrected
from safeloc.sensing.satellite.navigation import read_navigation
from safeloc.sensing.satellite.observations import read_observations

Read = Callable[[Path], object]
READERS: dict[str, Read] = {
    **{f"{read.__name__}{suffix}": read for read in (read_records, read_steps) for suffix in (".jsonl", ".csv", ".parquet")},
    **{f"{form}.{suffix}": FORMATS[form] for form, suffix in
       (("railml", "railml"), ("geojson", "geojson"), ("balises", "xlsx"), ("ttobench", "json"))},
    "line.toml": load_line, "line.json": load_line, "fixes.csv": read_fixes, "rover.obs": read_observations,
    "base.nav": read_navigation, "current.alm": lambda path: read_almanac(path, 2), "log.txt": read_android, "ranges.csv": read_corrected, "config.toml": lambda path: read_config(GuardConfig, path),
}  # fmt: skip


@pytest.mark.parametrize("name", READERS)
@pytest.mark.parametrize("error", [OSError(5, "Input/output error"), MemoryError(), RuntimeError("a defect\nof ours")])
def test_nothing_raises_past_a_reader(
    name: str, error: Exception, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A disk that fails, memory that is gone, a defect of safeloc: an InputError that begins with the file."""
    path = tmp_path / name
    path.write_bytes(b"x")

    def fails(*_: object, **__: object) -> Any:
        raise error

    monkeypatch.setattr(Path, "open", fails)
    monkeypatch.setattr("pyarrow.parquet.ParquetFile", fails)
    with pytest.raises(InputError, match=f"^{path}") as told:
        READERS[name](path)
    assert isinstance(error, RuntimeError) is isinstance(told.value, UnforeseenError)
    assert (" Please report it" in str(told.value)) is isinstance(error, RuntimeError)


@pytest.mark.parametrize("name", READERS)
def test_folders_and_devices_are_no_files(name: str, tmp_path: Path) -> None:
    """Neither a folder, nor a device without end, nor a pipe that nobody writes to."""
    (tmp_path / name).mkdir()
    os.mkfifo(tmp_path / f"pipe-{name}")
    (tmp_path / f"zero-{name}").symlink_to("/dev/zero")
    for path in (tmp_path / name, tmp_path / f"pipe-{name}", tmp_path / f"zero-{name}"):
        with pytest.raises(InputError, match=f"^{path}: .*(folder|device|no such file)"):
            READERS[name](path)


@pytest.mark.parametrize("name", READERS)
def test_read_errors_are_told(name: str, tmp_path: Path) -> None:
    """A file that opens and cannot be read."""
    path = tmp_path / name
    path.symlink_to("/proc/self/mem")
    with pytest.raises(InputError, match=f"^{path}"):
        READERS[name](path)


def test_the_place_of_a_defect_is_told() -> None:
    """With kind, first line, and the line of safeloc that failed."""
    with pytest.raises(UnforeseenError) as told, reading("run.csv"):
        whole_number(None)  # type: ignore[arg-type]
    assert str(told.value).startswith("run.csv: not read: safeloc itself failed on it (TypeError: ")
    assert "safeloc/runtime/outside.py:" in str(told.value)


def test_errors_that_cannot_be_shown_are_told() -> None:
    """Also those of others whose text fails or never ends."""

    class Broken(Exception):
        def __str__(self) -> str:
            raise ValueError

    assert "(Broken, place unknown)" in refusal(Broken())
    assert len(refusal(KeyError("x" * 100_000))) < 500


def test_what_is_quoted_stays_short() -> None:
    """However long, deep or broken it is."""
    deep: list[Any] = []
    for _ in range(100_000):
        deep = [deep]
    for value in ("x" * 10**6, 10**4_000, deep, {"a" * 10**5: ["b"] * 10**5}, "\ud800", [None] * 10**6):
        assert len(quoted(value)) <= 240
        assert quoted(value).isascii()
    del deep


def test_numbers_have_ascii_digits() -> None:
    """Python's own conversions take digits of every script, blanks and `_`."""
    assert [12, -3, 7] == [whole_number(text) for text in ("12", "-3", "+7")]
    assert [1.5, -0.5, 1e3] == [number(text) for text in ("1.5", "-.5", "1e3")]
    for text in ("\u0661\u0662", "\uff11", "1_0", " 1", "", "nan", "1e9999", "1" * (MOST_DIGITS + 1), "0x1"):
        assert whole_number(text) is None
        assert number(text) is None


ARABIC = "\u0661\u0662"


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("run.csv", f"kind,time_ms,position_nm\ntruth,1,{ARABIC}\n"),
        ("run.csv", f"kind,time_ms,position_nm\ntruth,{ARABIC},1\n"),
        ("run.jsonl", f'{{"kind": "truth", "time_ms": 1, "position_nm": {ARABIC}}}\n'),
    ],
)
def test_other_digits_are_no_measurement(name: str, text: str, tmp_path: Path) -> None:
    """In records; the line is named."""
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    with pytest.raises(StreamError, match=rf"run\.{path.suffix[1:]}:\d: "):
        read_records(path)


def test_a_value_in_other_digits_is_text(tmp_path: Path) -> None:
    """Of a value record it is a name, which no number input has."""
    path = tmp_path / "run.csv"
    path.write_text(f"kind,time_ms,name,value\nvalue,1,a,{ARABIC}\n", encoding="utf-8")
    assert {"a": ARABIC} == read_raw(path)[0].inputs()  # type: ignore[union-attr]


def test_other_digits_are_no_step(tmp_path: Path) -> None:
    """In CSV of steps."""
    path = tmp_path / "run.csv"
    path.write_text(f"a\n{ARABIC}\n", encoding="utf-8")
    with pytest.raises(StreamError, match=r"run\.csv:2: a is '.*'; steps hold whole numbers"):
        read_steps(path)


def test_other_digits_are_no_position() -> None:
    """In streams of positions: numbers, times, and NMEA."""
    columns = Columns(time="t", x="x", y="y")
    for row in ({"t": ARABIC, "x": "1", "y": "1"}, {"t": "1", "x": ARABIC, "y": "1"}, {"t": "1_0", "x": "1", "y": "1"}):
        assert "no number in ASCII digits" in delivery(1, row, columns).wrong
    pytest.importorskip("pynmeagps")
    (found,) = nmea_deliveries([f"$GPRMC,{ARABIC}2726.20,A,5053.19,N,00427.88,E,10.0,,150322,,,A*00"])
    assert found.wrong == "not ASCII, as NMEA is"


@pytest.mark.parametrize("text", [f"length = {ARABIC}", "a = 1_0"])
def test_configurations_have_toml_digits(text: str, tmp_path: Path) -> None:
    """TOML has ASCII digits, and `_` between them is its own."""
    path = tmp_path / "vehicle.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=r"cannot be read as TOML|1 field is wrong"):
        read_config(GuardConfig, path)


def test_lines_are_numbered_as_editors_do(tmp_path: Path) -> None:
    """LF, CR LF and CR end lines; a byte order mark is no text, and what is not UTF-8 is told with its line."""
    path = tmp_path / "a.txt"
    path.write_bytes(b"\xef\xbb\xbfone\r\ntwo\rthree\n\nfive")
    assert [(1, "one"), (2, "two"), (3, "three"), (4, ""), (5, "five")] == list(read_lines(path, 100))
    path.write_bytes(b"one\ntwo\n\xff")
    with pytest.raises(InputError, match=r"a\.txt:3: not UTF-8 text"):
        list(read_lines(path, 100))
    with pytest.raises(InputError, match=r"a\.txt:3: not UTF-8 text \(invalid start byte at byte 8\)"):
        read_text(path)
    path.write_bytes(b"one\n" + b"x" * 101)
    with pytest.raises(InputError, match=r"a\.txt:2: a line of more than 100 bytes; break it up\.$"):
        list(read_lines(path, 100))


def test_files_that_tell_no_size_are_read_whole() -> None:
    """Those of the system say that they are empty."""
    assert read_bytes(Path("/proc/self/cmdline"))


@pytest.mark.parametrize("empty", ["", "null"])
def test_an_unknown_column_with_nothing_in_it_is_refused(empty: str, tmp_path: Path) -> None:
    """A misspelt name is told before the sensor says something for the first time."""
    target = load_target("odometry")
    path = tmp_path / ("run.jsonl" if empty else "run.csv")
    text = '{"front_wheel_mm": 1}\n{"front_weel_mm": null}\n' if empty else "front_wheel_mm,front_weel_mm\n1,\n"
    path.write_text(text)
    line = 2 if empty else 1
    with pytest.raises(
        StreamError, match=rf":{line}: odometry has no input 'front_weel_mm'; .* Did you mean 'front_wheel_mm'\?"
    ):
        replay_stream(target, path)


@pytest.mark.parametrize("name", ["run.csv", "run.parquet"])
def test_an_unknown_column_of_records_is_refused(name: str, tmp_path: Path) -> None:
    """In tables of records likewise."""
    path = tmp_path / name
    if path.suffix == ".csv":
        path.write_text("kind,time_ms,position_nm,postion_mm\ntruth,1,1,\n")
    else:
        pyarrow = pytest.importorskip("pyarrow")
        from pyarrow import parquet

        row = {"kind": "truth", "time_ms": 1, "position_nm": 1, "postion_mm": None}
        parquet.write_table(pyarrow.Table.from_pylist([row]), path)
    with pytest.raises(StreamError, match=r":1: no record has a column 'postion_mm'; .* Did you mean 'position_mm'\?$"):
        read_raw(path)
