"""Seconds of what `python -m tests.fuzz_readers` does for minutes: nothing raises but documented refusals."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from random import Random

import pytest

from tests.fuzz_readers.__main__ import main
from tests.fuzz_readers.changes import changed
from tests.fuzz_readers.kept import KEPT
from tests.fuzz_readers.readers import FUZZED, Fuzzed
from tests.kept_lines import kept_lines

EACH = pytest.mark.parametrize("fuzzed", FUZZED, ids=lambda fuzzed: fuzzed.name)
INPUTS = 150


def examples_of(fuzzed: Fuzzed) -> list[bytes]:
    """Sound examples; skips where the extra is missing."""
    return list(fuzzed.examples()) or pytest.skip("its extra is not installed")


@pytest.mark.thorough(ordinary=8)
@EACH
def test_changed_examples_are_read_or_refused(fuzzed: Fuzzed) -> None:
    """The same changes in every run."""
    examples, random = examples_of(fuzzed), Random(fuzzed.name)
    for data in (*examples, *KEPT.get(fuzzed.name, ()), b"", b"\0", b"\xff" * 100):
        fuzzed.read(data)
    for _ in range(INPUTS):
        fuzzed.read(changed(examples, random))


@EACH
def test_cut_examples_are_read_or_refused(fuzzed: Fuzzed) -> None:
    """Cut off anywhere."""
    for data in examples_of(fuzzed):
        for end in range(0, len(data), max(1, len(data) // 40)):
            fuzzed.read(data[:end])


def test_what_is_kept_is_of_a_reader() -> None:
    """A reader that was renamed loses nothing."""
    assert set(KEPT) <= {fuzzed.name for fuzzed in FUZZED}


def test_the_fuzzer_sees_a_defect() -> None:
    """What raises anything else than a refusal is no pass."""
    with pytest.raises(ZeroDivisionError):
        Fuzzed("broken", lambda data: 1 // len(data), lambda: [b"x"]).read(b"")


def test_the_long_run_is_called_as_documented(tmp_path: Path) -> None:
    """Random changes for a moment, with what passed in the last line; what has passed is not tried again."""
    out = tmp_path / "readers.jsonl"
    options = ["--seconds", "0.2", "--plain", "--out", str(out), "--reader", "NMEA", "--reader", "railML"]
    command = [sys.executable, "-m", "tests.fuzz_readers", *options]
    said = [subprocess.run(command, capture_output=True, text=True, check=True, timeout=120).stdout for _ in range(2)]
    assert ["2 passed, 0 failed"] * 2 == [one.splitlines()[-1] for one in said]
    assert ["2 readers, 0 of them in", "2 readers, 2 of them in"] == [
        one.splitlines()[1].removesuffix(f" {out}") for one in said
    ]
    assert ["NMEA", "railML"] == [line["reader"] for line in kept_lines(out)]


def test_a_defect_fails_the_run_and_is_tried_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The input that shows it is told; once it is mended the same file passes."""
    out = tmp_path / "readers.jsonl"
    broken = Fuzzed("broken", lambda data: 1 // len(data[:-1]), lambda: [b"x"])
    options = ["--plain", "--seconds", "0", "--out", str(out), "--reader", "broken"]
    monkeypatch.setattr("tests.fuzz_readers.readers.FUZZED", (broken,))
    assert main(options) == 1
    said = capsys.readouterr().out
    assert said.endswith("\n0 passed, 1 failed\n")
    assert "input 1 of seed 1: b'x'\n" in said
    monkeypatch.setattr("tests.fuzz_readers.readers.FUZZED", (Fuzzed("broken", len, lambda: [b"x"]),))
    assert main(options) == 0
    assert capsys.readouterr().out.endswith("\n1 passed, 0 failed\n")


def test_a_reader_without_its_extra_counts_as_neither(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """It is told, and has not passed."""
    monkeypatch.setattr("tests.fuzz_readers.readers.FUZZED", (Fuzzed("absent", len, list),))
    assert main(["--plain", "--seconds", "0"]) == 0
    assert "absent: skipped, its extra is not installed\n0 passed, 0 failed\n" in capsys.readouterr().out
