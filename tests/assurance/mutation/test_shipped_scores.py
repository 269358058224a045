"""Mutation results that ship: shown for the version of the machine that they are about, and for no other."""

from __future__ import annotations

import json
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import pytest

from safeloc.assurance.margins import makers
from safeloc.assurance.mutation.kept_score import SCORES
from safeloc.assurance.mutation.shipped_scores import (
    KIND,
    ShippedScore,
    scores_of,
    shipped_score,
    strengths_of,
    write_shipped_score,
)
from safeloc.assurance.mutation.strength import STRENGTHS, Strength
from safeloc.catalogue import ENTRIES
from safeloc.errors import InputError
from safeloc.models.transmission import TransmissionConfig
from safeloc.proof.cache.store import Store
from safeloc.target import MODELS, Target
from tests.shipped import shipped

FILES = {path.name.removesuffix(f".{KIND}"): path for path in sorted(MODELS.rglob(f"*.{KIND}"))}
SCORE = {
    "mutants": 9, "judged": 8, "wrong": 6, "by_proof": 5, "with_reason": 1, "open": 0, "since": "2026-11-29",
}  # fmt: skip
STRENGTH = Strength("transmission", 8, 9, 4, 3, 2, {"a claim": 1})


@pytest.fixture(name="transmission")
def _transmission() -> Target:
    return shipped("transmission")


@pytest.fixture(name="path")
def _path(transmission: Target, tmp_path: Path) -> Path:
    return write_shipped_score(transmission, SCORE, {"FVA-1": STRENGTH}, tmp_path / "transmission.mutation.json")


def kept(store: Store, target: Target, judged: int) -> None:
    """Keep a score and a strength that a run of `mutate` found."""
    SCORES.keep(store, target, {**SCORE, "judged": judged})
    STRENGTHS.keep(store, target, {"FVA-1": asdict(replace(STRENGTH, judged=judged, by_its_own=0))})


def test_what_is_written_comes_back(transmission: Target, path: Path) -> None:
    """With the day alone, and the numbers of the score in each strength."""
    assert ShippedScore(SCORE, {"FVA-1": STRENGTH}) == shipped_score(transmission, path)
    again = write_shipped_score(transmission, {**SCORE, "since": "2026-11-29T12:00:00Z"}, {"FVA-1": STRENGTH}, path)
    assert shipped_score(transmission, again) == ShippedScore(SCORE, {"FVA-1": STRENGTH})


def test_another_version_of_the_machine_has_none(
    transmission: Target, path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A claim less, and other code that makes the machine."""
    assert shipped_score(replace(transmission, properties=transmission.properties[1:]), path) is None
    monkeypatch.setattr(makers, "making_code_digest", lambda _: "edited")
    assert shipped_score(transmission, path) is None


def test_other_figures_than_the_defaults_have_none(transmission: Target, path: Path) -> None:
    """Nor has a machine of a user, whatever it is called."""
    other = replace(ENTRIES["transmission"].make(TransmissionConfig(period_ms=200)), spec="transmission")
    assert shipped_score(other, path) is None
    assert shipped_score(replace(transmission, spec="own.py:machine"), path) is None


@pytest.mark.parametrize(("judged", "of_the_run"), [(7, False), (8, True), (9, True)])
def test_the_run_that_judged_more_is_told(
    transmission: Target, path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, judged: int, of_the_run: bool
) -> None:
    """One that judged as many as the file says is newer."""
    monkeypatch.setattr("safeloc.assurance.mutation.shipped_scores.shipped_file", lambda *_: path)
    store = Store(tmp_path / "cache")
    assert {"transmission": SCORE} == scores_of(store, [transmission])
    assert {"FVA-1": [STRENGTH]} == strengths_of(store, [transmission]) == strengths_of(None, [transmission])
    kept(store, transmission, judged)
    assert (judged if of_the_run else 8) == scores_of(store, [transmission])["transmission"]["judged"]
    assert [0 if of_the_run else 2] == [one.by_its_own for one in strengths_of(store, [transmission])["FVA-1"]]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"schema": "other"}, r"written as 'other', not as 'safeloc-shipped-mutation/1'"),
        ({"score": {**SCORE, "judged": "8"}}, r"no file of mutation results: .*score\.judged"),
        ({"more": 1}, r"no file of mutation results: .*more"),
    ],
)
def test_a_file_of_another_form_is_refused(
    transmission: Target, path: Path, change: dict[str, Any], message: str
) -> None:
    """With its path."""
    path.write_text(json.dumps(json.loads(path.read_text(encoding="utf-8")) | change), encoding="utf-8")
    with pytest.raises(InputError, match=rf"(?s)transmission\.mutation\.json: {message}"):
        shipped_score(transmission, path)


@pytest.mark.parametrize("name", FILES)
def test_the_file_is_of_the_machine_as_it_is(name: str) -> None:
    """All of its mutants were judged, and each that no proof notices has a written reason. Otherwise: python -m tests.mutation_scores."""
    found = shipped_score(shipped(name))
    assert found is not None
    assert found.score["judged"] == found.score["mutants"]
    assert (0, found.score["wrong"]) == (found.score["open"], found.score["by_proof"] + found.score["with_reason"])
    assert all(one.by_its_own <= one.by_proof <= one.wrong for one in found.strengths.values())
