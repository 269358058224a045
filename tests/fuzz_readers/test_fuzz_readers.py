"""Seconds of what `python -m tests.fuzz_readers` does for minutes: nothing raises but documented refusals."""

from __future__ import annotations

import subprocess
import sys
from random import Random

import pytest

from tests.fuzz_readers.changes import changed
from tests.fuzz_readers.kept import KEPT
from tests.fuzz_readers.readers import FUZZED, Fuzzed

EACH = pytest.mark.parametrize("fuzzed", FUZZED, ids=lambda fuzzed: fuzzed.name)
INPUTS = 150


def examples_of(fuzzed: Fuzzed) -> list[bytes]:
    """Sound examples; skips where the extra is missing."""
    return list(fuzzed.examples()) or pytest.skip("its extra is not installed")


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


def test_the_long_run_is_called_as_documented() -> None:
    """Random changes for a moment, with an exit code."""
    command = [sys.executable, "-m", "tests.fuzz_readers", "--seconds", "0.2", "--plain", "--reader", "NMEA"]
    done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=120)
    assert "NMEA: " in done.stdout
