"""Dropped, doubled, swapped, late, cut, joined, renamed: a reported interval holds the truth of the stream."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import pytest

from tests.runtime.streams.oracle import MISHAPS, Outcome, main, one, run, search

HARMLESS = [mishap for mishap in MISHAPS if not mishap.breaks]
BREAKING = [mishap for mishap in MISHAPS if mishap.breaks]


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("mishap", HARMLESS, ids=lambda mishap: mishap.name)
def test_no_mishap_to_lines_gives_a_wrong_interval(mishap: object) -> None:
    """Each alone, rare and often; places are still reported, so that the test says something."""
    outcome = Outcome()
    for share in (0.005, 0.1):
        outcome.add(one(3, [mishap], share))  # type: ignore[list-item]
    assert {} == outcome.first
    assert [] == outcome.unforeseen
    assert outcome.located > 20


def test_nor_do_several_at_once() -> None:
    """All that break no assumption."""
    outcome = one(11, HARMLESS, 0.02)
    assert ({}, []) == (outcome.first, outcome.unforeseen)


@pytest.mark.parametrize("mishap", BREAKING, ids=lambda mishap: mishap.name)
def test_where_an_assumption_is_broken_it_is_named(mishap: object) -> None:
    """Wrong intervals are counted under the assumption, never under none."""
    outcome = one(5, [mishap], 0.1)  # type: ignore[list-item]
    assert "" not in outcome.first
    assert [] == outcome.unforeseen


def test_the_oracle_sees_what_is_wrong() -> None:
    """Where all units agree on half of the way, nearly every time, intervals are wrong: the oracle is not blind."""
    false = next(mishap for mishap in BREAKING if mishap.name == "false distance")
    outcome = one(1, [false], 0.99)
    assert outcome.wrong[false.breaks] > 100
    assert false.breaks in outcome.first


def test_the_stream_has_places_and_no_truth() -> None:
    """The lines carry neither truth nor ghosts."""
    lines, truth = run(1)
    assert len(lines) == len(truth) > 100
    assert not any("truth" in line for line in lines)


def test_a_search_goes_on_from_its_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Block by block, each once; what is read back is what was found, wrong intervals and all."""
    made: list[int] = []

    def made_block(number: int, seed: int) -> Outcome:
        made.append(number)
        return Outcome(100, 40, 2, number, Counter({"": number, "an assumption": 1}), {"": f"{seed}"}, [])

    monkeypatch.setattr("tests.runtime.streams.oracle.block", made_block)
    out = tmp_path / "oracle.jsonl"
    whole = search(400, 1)
    search(200, 1, out)
    made.clear()
    assert whole == search(400, 1, out)
    assert [2, 3] == made
    assert (8, 6, 6) == (whole.runs, whole.failed, whole.wrong[""])


def test_a_failed_run_fails_the_search(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """The last line and the exit code say it."""
    monkeypatch.setattr(
        "tests.runtime.streams.oracle.block", lambda number, seed: Outcome(100, 40, 3, 1, Counter({"": 1}))
    )
    assert main(["--lines", "100"]) == 1
    assert capsys.readouterr().out.splitlines()[-1] == "2 passed, 1 failed"


@pytest.mark.slow
def test_many_lines() -> None:
    """Each mishap alone, then each with others, over and over: no interval is wrong while every assumption is kept."""
    outcome = search(300_000, 2)
    assert ({}, []) == ({breaks: told for breaks, told in outcome.first.items() if not breaks}, outcome.unforeseen)
    assert outcome.failed == 0
    assert outcome.lines >= 300_000
    assert outcome.located > outcome.lines / 10
