"""A seeded sample of mutants of shipped machines, and the long run over all of them (python -m tests.mutants)."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from safeloc.assurance.mutation.results import QUESTIONS, Judged, Outcome
from tests import mutants
from tests.assurance.mutation.shop import outcome

WHY = "Nothing safe rests on what is counted here."


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize(("name", "most"), [("axle_head", 16), ("delocalized", 30)])
def test_a_sample_of_a_shipped_machine(name: str, most: int, tmp_path: Path) -> None:
    """Every mutant of a sample is noticed by a proof, is no wrong machine, or has a written reason; most are noticed."""
    own = mutants.loaded(name)
    lines = mutants.of_target(own, most, 0, 1, tmp_path / "mutants.jsonl")
    assert [] == [line for line in lines if line["wrong"]]
    assert most == len(lines)
    assert 0.8 * most < sum(line["fate"] not in ("equivalent", "conservative", *QUESTIONS) for line in lines)


def test_an_ended_run_goes_on(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """What stands in the file is not judged again: what it says counts, and the last line counts all of the sample."""
    file, asked = tmp_path / "mutants.jsonl", ["--machine", "delocalized", "--sample", "1", "--jobs", "1"]
    assert 0 == mutants.main([*asked, "--out", str(file)])
    assert f"{mutants.LEAST} passed, 0 failed" == capsys.readouterr().out.splitlines()[-1]
    first, second, *others = file.read_text().splitlines()
    some = [json.dumps({**json.loads(line), "wrong": "survived"}) for line in (first, second)]
    file.write_text("\n".join([*some, *others[2:]]) + "\n")
    assert 1 == mutants.main([*asked, "--out", str(file)])
    assert f"{mutants.LEAST - 2} passed, 2 failed" == capsys.readouterr().out.splitlines()[-1]
    assert mutants.LEAST == len(file.read_text().splitlines())


def test_shares() -> None:
    """Each machine has its share of the sample, some mutants at least, and no more than there are; 0 asks for all."""
    counts = {"great": 9_000, "small": 990, "tiny": 5}
    assert {"great": 900, "small": 99, "tiny": 5} == mutants.shares(counts, 1_000)
    assert {"great": 90, "small": 10, "tiny": 5} == mutants.shares(counts, 100)
    assert counts == mutants.shares(counts, 0)


@pytest.mark.parametrize(
    ("fate", "reason", "wrong"),
    [
        ("survived", "", "survived"),
        ("survived", WHY, ""),
        ("a recording comes out otherwise", "", "a recording comes out otherwise"),
        ("refuted by a run", "", ""),
        ("equivalent", "", ""),
    ],
)
def test_what_fails(fate: str, reason: str, wrong: str) -> None:
    """What no proof notices fails, unless a reason is written down."""
    one = outcome("update skipped", "brakings keeps its value")
    judged = Judged(**{**one.__dict__, "everywhere": Outcome(fate)})
    assert wrong == mutants.line_of("brake", judged, {one.id: reason} if reason else {})["wrong"]


def test_the_closing_line(capsys: pytest.CaptureFixture[str]) -> None:
    """Each that failed is told with its place, then how many."""
    line = {"id": "brake-1", "place": "brake.py:1", "words": "< becomes >", "wrong": "survived"}
    assert 1 == mutants.closing([line, {**line, "wrong": ""}])
    assert 0 == mutants.closing([{**line, "wrong": ""}])
    told = capsys.readouterr().out.splitlines()
    assert ["brake-1 (brake.py:1: < becomes >): survived, and no written reason", "1 passed, 1 failed"] == told[:2]
    assert "1 passed, 0 failed" == told[-1]


@pytest.mark.slow
def test_a_sample_of_a_composition_is_of_its_machines_and_wires() -> None:
    """The sample of a composition can be judged in parts: nothing is left to do where all of it is done."""
    own = mutants.loaded("supervised_odometry")
    wanted, judge = mutants.parts_of_sample(own, 12, 0, 1)
    assert 12 == len(wanted) <= len(own.ids)
    assert set(wanted) <= set(own.ids)
    assert judge([], lambda _: None) is None
