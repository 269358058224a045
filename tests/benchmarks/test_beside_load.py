"""The runs beside a load: each is made once, and a verdict that differs is named."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import count
from pathlib import Path

import pytest

from benchmarks import beside_load
from tests.edits.checkout import Checkout, Ran
from tests.kept_lines import kept_lines

SAME = {"balise/property/one": "proved", "balise/property/two": "held"}
OTHER = {**SAME, "balise/property/one": "unknown"}


@pytest.fixture
def verdicts(monkeypatch: pytest.MonkeyPatch) -> list[dict[str, str]]:
    """What the runs give, in turn; the last ones all the same."""
    given: list[dict[str, str]] = []

    def verified(_: Checkout, cache: Path, *machines: str) -> Ran:
        assert machines == ("balise",)
        assert list(cache.iterdir()) == []
        found = given.pop(0) if given else SAME
        return Ran(3 if "unknown" in found.values() else 0, found, frozenset(), "")

    def ticks() -> Iterator[float]:
        return map(float, count(1))

    monkeypatch.setattr(beside_load, "processor_s", ticks().__next__)
    monkeypatch.setattr(Checkout, "__init__", lambda *_: None)
    monkeypatch.setattr(Checkout, "all_verified", verified)
    return given


def run(out: Path, runs: int) -> int:
    """The exit code of so many idle runs, and as many beside two processes."""
    return beside_load.main(["balise", "--runs", str(runs), "--busy", "2", "--out", str(out)])


def test_equal_runs(verdicts: list[dict[str, str]], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """One set; what stands in the file is not run again."""
    out = tmp_path / "runs.jsonl"
    assert (0, []) == (run(out, 1), verdicts)
    assert "2 runs, 1 different sets of verdicts" in capsys.readouterr().out
    assert run(out, 2) == 0
    assert [(0, 0), (2, 0), (0, 1), (2, 1)] == [(line["beside"], line["number"]) for line in kept_lines(out)]
    told = capsys.readouterr().out
    assert "4 runs, 1 different sets of verdicts" in told
    assert "2 runs with 2 beside: 0.0 s, 1.0 s of processor (medians)" in told


def test_a_verdict_that_differs(
    verdicts: list[dict[str, str]], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """It is named, with what each set has."""
    verdicts += [SAME, OTHER]
    assert run(tmp_path / "runs.jsonl", 1) == 1
    told = capsys.readouterr().out
    assert "2 runs, 2 different sets of verdicts\n  balise/property/one: proved, unknown\n  exit code: 0, 3\n" in told


def test_the_load_ends_with_the_runs() -> None:
    """No process is left that never rests."""
    with beside_load.busy(2) as running:
        assert [None, None] == [one.poll() for one in running]
    assert all(one.poll() is not None for one in running)
