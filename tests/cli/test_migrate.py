"""`safeloc migrate`: beside or in place, all of the files or none, and what is said of each."""

from __future__ import annotations

from pathlib import Path

import pytest

from safeloc.catalogue import load_target
from safeloc.runtime.embedding import Controller, Program
from tests.cli.calling import Call

OLD = '{"source_over_mm": 3}\n'
NEW = '{"source_margin_above_mm": 3}\n'


@pytest.fixture
def stream(tmp_path: Path) -> Path:
    """A stream of version 0.1.0."""
    path = tmp_path / "run.jsonl"
    path.write_text(OLD, encoding="utf-8")
    return path


def test_beside(call: Call, stream: Path) -> None:
    """The old file stays, the new one has its name with `migrated` in it; what is changed is told."""
    called = call("migrate", str(stream))
    beside = stream.with_name("run.migrated.jsonl")
    assert (0, OLD, NEW) == (called.code, stream.read_text(), beside.read_text())
    assert [
        f"{stream} -> {beside}",
        "  source_over_mm -> source_margin_above_mm (line 1)",
    ] == called.out.replace(" \n", " ").splitlines()
    assert {"run.jsonl", "run.migrated.jsonl"} == {one.name for one in stream.parent.iterdir()}


def test_in_place(call: Call, stream: Path) -> None:
    """The old file is kept under another name; a second time there is nothing left to do."""
    assert 0 == call("migrate", "--in-place", str(stream)).code
    assert (NEW, OLD) == (stream.read_text(), stream.with_name("run.jsonl.bak").read_text())
    again = call("migrate", "--in-place", str(stream))
    assert (0, True) == (again.code, "has the current names; unchanged" in again.out)


@pytest.mark.parametrize(("option", "name"), [((), "run.migrated.jsonl"), (("--in-place",), "run.jsonl.bak")])
def test_nothing_is_written_over(call: Call, stream: Path, option: tuple[str, ...], name: str) -> None:
    """Neither an earlier result nor an earlier copy."""
    stream.with_name(name).write_text("mine", encoding="utf-8")
    called = call("migrate", *option, str(stream))
    assert (2, OLD, "mine") == (called.code, stream.read_text(), stream.with_name(name).read_text())
    assert "already exists and would be overwritten; move it away." in called.err.replace("\n", " ")


def test_all_or_none(call: Call, stream: Path) -> None:
    """Where one file is refused none is written, also not those before it."""
    wrong = stream.with_name("wrong.jsonl")
    wrong.write_text('{"kind": "smoke"}\n', encoding="utf-8")
    called = call("migrate", str(stream), str(wrong))
    assert (2, {"run.jsonl", "wrong.jsonl"}) == (called.code, {one.name for one in stream.parent.iterdir()})
    assert "wrong.jsonl:1: a line of kind 'smoke'" in called.err.replace("\n", "")


def test_a_failed_write_leaves_the_file_as_it_was(call: Call, stream: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing half is left behind."""

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("safeloc.runtime.migration.os.fsync", full)
    called = call("migrate", str(stream))
    assert (2, {"run.jsonl"}) == (called.code, {one.name for one in stream.parent.iterdir()})
    assert "No space left on device" in called.err


@pytest.mark.parametrize(("name", "told"), [("run.csv", "files of kind '.csv'"), ("gone.jsonl", "no such file")])
def test_other_files_are_refused(call: Call, tmp_path: Path, name: str, told: str) -> None:
    """By name and with the kinds that are known."""
    (tmp_path / "run.csv").write_text("over_mm\n3\n", encoding="utf-8")
    called = call("migrate", str(tmp_path / name))
    assert (2, True) == (called.code, told in called.err.replace("\n", " "))


def test_snapshots(call: Call, tmp_path: Path) -> None:
    """A snapshot of this very build stays unchanged; a damaged one is refused."""
    path = tmp_path / "vehicle.json"
    path.write_bytes(Controller(Program(load_target("delocalized")), period_ms=100).snapshot())
    assert "unchanged" in call("migrate", str(path)).out
    path.write_bytes(path.read_bytes().replace(b'"machine":"delocalized"', b'"machine":"somewhere"'))
    assert "wrong checksum" in call("migrate", str(path)).err.replace("\n", " ")
