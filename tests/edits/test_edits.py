"""A sample of the long run of edits, and that it can fail."""

from __future__ import annotations

import ast
from dataclasses import replace
from pathlib import Path

import pytest

from safeloc.catalogue import ENTRIES
from tests.edits.__main__ import LARGE, cases
from tests.edits.checkout import Checkout, Ran
from tests.edits.edit import edits
from tests.edits.judge import Case, judged

TEXT = "a = (x <= 5) & (y > 2)\nb = -3 if flag else x + 1\nc = True\n"


def test_edits_of_a_text() -> None:
    """Numbers, comparisons, connectives and sums; each leaves a text that can be read, and is another one."""
    found = edits(TEXT)
    assert ["<=", "5", "&", ">", "2", "3", "+", "1"] == [one.before.strip(" ()") for one in found]
    texts = [one.made(TEXT) for one in found]
    assert len({*texts, TEXT}) == len(found) + 1
    assert all(ast.parse(text) for text in texts)


def test_the_long_run_covers_what_it_says() -> None:
    """Of 200 edits 10 of the localizer, 20 of the engine, and every machine that is not large among the others."""
    made = cases(200)
    assert 20 == sum(case.kind == "engine" for case in made)
    assert 10 == sum(case.machine == "localizer" for case in made)
    assert {case.machine for case in made} == {LARGE[0], *ENTRIES} - {*LARGE[1:]}


@pytest.fixture(scope="module")
def checkout(tmp_path_factory: pytest.TempPathFactory) -> Checkout:
    """A copy to edit."""
    return Checkout(tmp_path_factory.mktemp("checkout"))


@pytest.mark.thorough
def test_a_new_copy_keeps_what_it_finds(tmp_path: Path) -> None:
    """Otherwise warm and cold runs would be the same, and their comparison would show nothing."""
    copy, cache = Checkout(tmp_path / "copy"), tmp_path / "cache"
    assert [frozenset(), frozenset({"travel_direction"})] == [
        copy.verified("travel_direction", cache).kept for _ in range(2)
    ]


@pytest.mark.thorough
@pytest.mark.parametrize(
    "case", [Case(0, "machine", "emitter"), pytest.param(Case(1, "engine", "emitter"), marks=pytest.mark.slow)]
)
def test_an_edit_is_judged_alike_warm_and_cold(case: Case, checkout: Checkout, tmp_path: Path) -> None:
    """Of a declaration, and of the engine."""
    found = judged(checkout, tmp_path / "cache", case, seed=1)
    assert "" == found.wrong
    assert found.codes[0] == found.codes[1]


def test_a_cache_that_lies_is_noticed(checkout: Checkout, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A run that tells what was found before the edit fails the case."""
    monkeypatch.setattr(checkout, "loads", lambda _: True)
    right = Ran(0, {"p": "proved"}, frozenset(), "")
    wrong = replace(right, code=1, verdicts={"p": "violated"})
    told = iter([right, right, wrong])
    monkeypatch.setattr(checkout, "verified", lambda *_: next(told))
    assert "p: proved warm, violated cold" == judged(checkout, tmp_path, Case(0, "machine", "emitter"), 1).wrong
    told = iter([right, replace(right, kept=frozenset({"emitter"})), right])
    assert "with another engine" in judged(checkout, tmp_path, Case(0, "engine", "emitter"), 1).wrong
