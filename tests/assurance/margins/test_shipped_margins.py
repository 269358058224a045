"""Margins that ship: shown for the version of the machine that they are about, and for no other."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from safeloc.assurance.margins import makers
from safeloc.assurance.margins.asking import UNMOVED, Answer
from safeloc.assurance.margins.figures import configured_figures, figures
from safeloc.assurance.margins.kept_margins import keep_margins
from safeloc.assurance.margins.limits_of_figures import Limit
from safeloc.assurance.margins.margin_data import row
from safeloc.assurance.margins.shipped_margins import KIND, Shipped, margins_of, shipped_margins, write_shipped
from safeloc.catalogue import ENTRIES, load_target
from safeloc.errors import InputError
from safeloc.models.transmission import TransmissionConfig
from safeloc.proof.cache.store import Store
from safeloc.target import MODELS, Target
from tests.margins import main as writing

SHIPPED = {path.name.removesuffix(f".{KIND}"): path for path in sorted(MODELS.rglob(f"*.{KIND}"))}
DAY = "2026-11-27"
FRONT = {
    "name": "a",
    "where": "world",
    "first": "x (mm)",
    "second": "y",
    "points": [[1, 2, "at 3 a run"], [2, 1, "at 2 a run"]],
}
MOST_BYTES = 150_000


@pytest.fixture(name="transmission", scope="module")
def _transmission() -> Target:
    return load_target("transmission")


def limits(target: Target) -> list[dict[str, Any]]:
    known = figures(target)
    run = Answer("broken", "a claim", inputs=({"x": 1}, {"x": 2}))
    return [
        row(Limit(known["age_limit_ms"], "up", 1_100, run, 1_101)),
        row(Limit(known["age_limit_ms"], "down", 900, Answer("undecided", "c"), 890, broken_at=850)),
        row(Limit(known["period_ms"], "down", 10, Answer("proved"), None, proved_why=UNMOVED)),
        row(Limit(known["period_ms"], "up", 200, Answer("refused", why="too much"), 201)),
        row(Limit(known["max_speed_mm_s"], "up", 50_000, Answer("vacuous", "c", "it never begins"), 50_001)),
    ]


def written(target: Target, path: Path) -> Path:
    return write_shipped(
        target, {"world": limits(target), "pairs": [FRONT]}, DAY, 10.0, path / "transmission.margins.json"
    )


def test_a_reason_names_no_folder_of_this_computer(transmission: Target, tmp_path: Path) -> None:
    """A refusal names the place in the machine's file, below the package."""
    said = "transition 'a' (/somewhere/else/safeloc/models/fibre/__init__.py:144): never changes, as 3/4 is no number"
    refused = Limit(figures(transmission)["period_ms"], "up", 200, Answer("refused", why=said), 201)
    path = write_shipped(transmission, {"world": [row(refused)]}, DAY, 10.0, tmp_path / "transmission.margins.json")
    [[*_, why]] = json.loads(path.read_text(encoding="utf-8"))["world"]
    assert why == "transition 'a' (safeloc/models/fibre/__init__.py:144): never changes, as 3/4 is no number"


def test_what_is_written_comes_back(transmission: Target, tmp_path: Path) -> None:
    found = shipped_margins(transmission, written(transmission, tmp_path))
    assert found == Shipped(DAY, True, {"world": limits(transmission), "pairs": [FRONT]})


def test_another_version_of_the_machine_gets_nothing(
    transmission: Target, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A claim less, and other code that makes the machine, be it equal with these figures."""
    path = written(transmission, tmp_path)
    fewer = replace(transmission, properties=transmission.properties[1:])
    assert shipped_margins(fewer, path) == Shipped(DAY, False, {})
    monkeypatch.setattr(makers, "making_code_digest", lambda _: "edited")
    assert shipped_margins(transmission, path) == Shipped(DAY, False, {})


def test_other_figures_than_the_defaults_have_none(transmission: Target, tmp_path: Path) -> None:
    path = written(transmission, tmp_path)
    other = replace(ENTRIES["transmission"].make(TransmissionConfig(period_ms=200)), spec="transmission")
    assert shipped_margins(other, path) is None
    assert shipped_margins(replace(transmission, spec="own.py:machine"), path) is None


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"schema": "safeloc-shipped-margins/1", "digest": 3}'])
def test_a_file_of_another_form_is_refused(transmission: Target, tmp_path: Path, text: str) -> None:
    path = tmp_path / "transmission.margins.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=r"transmission.margins.json: no file of margins"):
        shipped_margins(transmission, path)


def test_what_is_found_since_comes_before_what_ships(
    transmission: Target, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path, store = written(transmission, tmp_path), Store(tmp_path / "cache")
    monkeypatch.setattr("safeloc.assurance.margins.shipped_margins.shipped_file", lambda *_: path)
    both = {"world": limits(transmission), "pairs": [FRONT]}
    assert margins_of(store, [transmission]) == {"transmission": {**both, "shipped": DAY}}
    keep_margins(store, transmission, "world", limits(transmission)[:1])
    assert margins_of(store, [transmission])["transmission"] == {
        "world": limits(transmission)[:1], "pairs": [FRONT], "shipped": DAY,
    }  # fmt: skip
    keep_margins(store, transmission, "pairs", [])
    assert margins_of(store, [transmission])["transmission"] == {"world": limits(transmission)[:1], "pairs": []}
    changed = replace(transmission, properties=transmission.properties[1:])
    assert margins_of(store, [changed]) == {"transmission": {"other_version": DAY}}


def test_what_was_not_asked_again_stays_in_the_file(
    transmission: Target, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """`python -m tests.margins` after `safeloc margins` without --pairs: the fronts that shipped are written again."""
    path, store = written(transmission, tmp_path), Store(tmp_path / "cache")
    monkeypatch.setattr("safeloc.assurance.margins.shipped_margins.shipped_file", lambda *_: path)
    monkeypatch.setattr("safeloc.assurance.margins.shipped_margins.place_of", lambda *_: path)
    with pytest.raises(SystemExit):
        writing(["--cache", str(store.folder), "transmission"])
    assert "nothing is kept of transmission" in capsys.readouterr().err
    keep_margins(store, transmission, "world", limits(transmission)[:1])
    writing(["--cache", str(store.folder), "transmission"])
    found = shipped_margins(transmission, path)
    assert found is not None
    assert found.parts == {"world": limits(transmission)[:1], "pairs": [FRONT]}


@pytest.mark.parametrize("name", SHIPPED)
def test_a_file_that_ships_is_of_a_machine_and_can_be_read(name: str) -> None:
    """Those of another version are told to be; the others have both directions of each figure."""
    found = shipped_margins(load_target(name))
    assert found is not None
    assert found.found >= DAY
    if found.is_current and "world" in found.parts:
        told = [(one["figure"], one["direction"]) for one in found.parts["world"]]
        known = [one.name for one in configured_figures(ENTRIES[name].config())]
        assert sorted(told) == sorted((one, way) for one in known for way in ("up", "down"))
        assert {one["name"] for one in found.parts.get("pairs", ())} <= {one.name for one in ENTRIES[name].pairs}


def test_they_stay_small() -> None:
    assert SHIPPED
    assert sum(path.stat().st_size for path in SHIPPED.values()) < MOST_BYTES
    assert all(json.loads(path.read_text(encoding="utf-8"))["world"] for path in SHIPPED.values())


@pytest.mark.thorough
@pytest.mark.parametrize("name", SHIPPED)
def test_margins_that_ship_are_of_the_present_version(name: str) -> None:
    """After an edit of the machine: `safeloc margins`, with --pairs too, then `python -m tests.margins`."""
    found = shipped_margins(load_target(name))
    assert found is not None
    assert found.is_current
