"""The benchmark of one edit: what it runs, what it goes on from, and what it tells."""

from __future__ import annotations

import time
from itertools import count
from pathlib import Path

import pytest

from benchmarks import one_edit
from tests.edits.checkout import PARTS, ROOT, Checkout, Ran
from tests.kept_lines import kept_lines

SECONDS = {one_edit.COLD: 100.0, 0: 10.0, 1: 30.0, 2: 20.0}


class Runs:
    """Takes the place of runs of the package; keeps which source files differ in each, and how many files the cache holds."""

    def __init__(self) -> None:
        self.changed = list[list[str]]()
        self.found = list[int]()

    def __call__(self, checkout: Checkout, cache: Path) -> Ran:
        """Look at the checkout, and leave something in the cache."""
        time.sleep(0.1)
        sources = [path for part in PARTS for path in (checkout.folder / part).rglob("*.py")]
        self.changed.append(
            [
                path.name
                for path in sources
                if path.read_bytes() != (ROOT / path.relative_to(checkout.folder)).read_bytes()
            ]
        )
        cache.mkdir(exist_ok=True)
        self.found.append(len(list(cache.iterdir())))
        (cache / f"run-{len(self.found)}").write_text("")
        return Ran(0, {"emitter/property/one": "proved", "guard/property/one": "held"}, frozenset({"guard"}), "")


@pytest.fixture
def runs(monkeypatch: pytest.MonkeyPatch) -> Runs:
    """Runs that take a second of processor, and a tenth by the clock."""
    made = Runs()
    monkeypatch.setattr(one_edit, "processor_s", count(1).__next__)
    monkeypatch.setattr(Checkout, "all_verified", lambda checkout, cache, seconds: made(checkout, cache))
    return made


@pytest.mark.thorough
def test_each_edit_begins_with_what_the_unedited_run_left(runs: Runs, tmp_path: Path) -> None:
    """Nothing is edited at first and one file after that; no run finds what another edit's run left."""
    one_edit.main(["--edits", "2", "--out", str(tmp_path / "runs.jsonl")])
    assert [0, 1, 1] == [len(names) for names in runs.changed]
    assert [0, 1, 1] == runs.found
    lines = kept_lines(tmp_path / "runs.jsonl")
    assert [one_edit.COLD, 0, 1] == [line["number"] for line in lines]
    assert [["emitter"]] * 3 == [line["anew"] for line in lines]


@pytest.mark.thorough
def test_it_goes_on_where_it_was(runs: Runs, tmp_path: Path) -> None:
    """The first run is not made again: what it left is there."""
    out = str(tmp_path / "runs.jsonl")
    one_edit.main(["--edits", "1", "--out", out])
    one_edit.main(["--edits", "2", "--out", out])
    assert [0, 1, 1] == [len(names) for names in runs.changed]
    assert [0, 1, 1] == runs.found
    assert [one_edit.COLD, 0, 1] == [line["number"] for line in kept_lines(Path(out))]


def test_medians(capsys: pytest.CaptureFixture[str], runs: Runs, tmp_path: Path) -> None:
    """Of the edits, as a share of the run with nothing kept."""
    lines = [
        {"number": number, "clock_s": seconds, "processor_s": 2 * seconds, "code": 0}
        for number, seconds in SECONDS.items()
    ]
    told = one_edit.medians(lines)
    assert "clock_s: 100.0 cold, 20.0 after an edit (median of 3), 0.20" == told[0]
    assert "processor_s: 200.0 cold, 40.0 after an edit (median of 3), 0.20" == told[1]
    one_edit.main(["--edits", "0", "--out", str(tmp_path / "runs.jsonl")])
    assert capsys.readouterr().out.endswith("no edits\n")
    assert 1 == len(runs.found)


def test_runs_that_were_ended_count_as_the_longest() -> None:
    """However little of their processor time is known; if half of the runs were ended, there is no median."""
    cold = {"number": one_edit.COLD, "clock_s": 100.0, "processor_s": 200.0, "code": 0}
    edits = [{"number": n, "clock_s": 10.0 * n, "processor_s": 20.0 * n, "code": 0} for n in (1, 2)]
    ended = {"number": 3, "clock_s": 40.0, "processor_s": 1.0, "code": -1}
    assert [
        "clock_s: 100.0 cold, 20.0 after an edit (median of 3, 1 ended), 0.20",
        "processor_s: 200.0 cold, 40.0 after an edit (median of 3, 1 ended), 0.20",
    ] == one_edit.medians([cold, *edits, ended])
    assert "clock_s: 100.0 cold, no median, since 1 of 2 were ended" == one_edit.medians([cold, edits[0], ended])[0]
