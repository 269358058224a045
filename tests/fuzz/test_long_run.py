"""The long run can be ended and goes on, tells what failed, and ends with its figures."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.fuzz import __main__ as long_run
from tests.fuzz.cases import KINDS
from tests.fuzz.tally import Tally

CASES = ["--machines", "3", "--compositions", "0", "--back-ends", "0", "--seed", "7"]


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Numbers of the cases that were really made; number 2 fails."""
    numbers: list[int] = []

    def case(_seed: int, number: int, _plan: object) -> Tally:
        numbers.append(number)
        one = Tally()
        one.judge("bmc", "it lies" if number == 2 else "")
        return one

    monkeypatch.setitem(KINDS, "machine", case)
    return numbers


@pytest.mark.usefixtures("asked")
def test_the_last_line_says_what_failed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Figures, the disagreement itself, `N passed, N failed`, and exit code 1."""
    assert 1 == long_run.main([*CASES, "--out", str(tmp_path / "cases.jsonl")])
    said = capsys.readouterr().out.splitlines()
    assert "2 passed, 1 failed" == said[-1]
    assert "WRONG machine 2 of seed 7: bmc: it lies" in said


def test_it_goes_on_where_it_was_ended(asked: list[int], tmp_path: Path) -> None:
    """Cases that stand in the file are not made again; a line that was cut off is, and so is another seed's."""
    file = tmp_path / "cases.jsonl"
    lines = [
        json.dumps({"kind": "machine", "seed": seed, "number": n, **Tally().data()}) for seed, n in ((7, 0), (8, 1))
    ]
    file.write_text("\n".join(lines) + '\n{"kind": "machine", "se', encoding="utf-8")
    long_run.main([*CASES, "--out", str(file)])
    assert [1, 2] == asked
    assert 4 == len([json.loads(line) for line in file.read_text(encoding="utf-8").splitlines()])


def test_what_the_fuzzer_cannot_do_is_a_failure(monkeypatch: pytest.MonkeyPatch) -> None:
    """An exception of the fuzzer's own is not taken for agreement."""
    monkeypatch.setitem(KINDS, "machine", lambda *_: 1 // 0)
    assert "ZeroDivisionError" in long_run._one(("machine", 1, 1, frozenset())).wrong[0]
