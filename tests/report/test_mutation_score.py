"""The mutation score on the report: in the table of machines and with the machine, or the command that measures it."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from safeloc.catalogue import load_target
from safeloc.report.changes import changes
from safeloc.report.data import report_data, schema
from safeloc.report.folder import render_folder, write_folder
from safeloc.report.mutation_words import score_words
from safeloc.report.page import to_html
from safeloc.report.stored import read_for_page
from safeloc.target import Target

SCORE: dict[str, Any] = {"mutants": 594, "judged": 594, "wrong": 588, "by_proof": 585, "with_reason": 2, "open": 1, "since": "2026-03-04T05:06:07Z"}  # fmt: skip


@pytest.fixture(name="transmission", scope="module")
def _transmission() -> Target:
    return load_target("transmission")


def plain(page: str) -> str:
    """The text of a page."""
    return " ".join(re.sub(r"<[^>]+>", "", page).split())


def test_a_share_is_never_rounded_up() -> None:
    """587 of 588 are 99 %, not 100 %; a sample says so; where all mutants are equivalent, none counts."""
    told = score_words({**SCORE, "by_proof": 587, "judged": 200})
    assert told is not None
    assert ("587 of 588 (99 %)", "a sample of 200 of 594") == (told["share"], told["judged"])
    none = score_words({**SCORE, "wrong": 0, "by_proof": 0})
    assert none is not None and "none counts" == none["share"]
    assert score_words(None) is None


def test_the_page_tells_share_sample_day_and_what_is_open(transmission: Target) -> None:
    """In the table of machines and with the machine; a machine without a score is named, with the command."""
    both = [transmission, replace(transmission, name="other")]
    page = to_html(report_data([], both, scores={"transmission": SCORE}))
    assert '<a href="#score-transmission">585 of 588 (99 %)</a><br><span class="soft">all 594 judged</span>' in page
    assert '<a class="soft" href="#mutation">not measured</a>' in page
    said = plain(page)
    assert (
        "a proof notices 585 of 588 (99 %): all 594 judged, on 2026-03-04; 6 of the judged are equivalent or conservative, and "
        "do not count; no proof notices 3: 2 with a written reason, 1 without." in said
    )
    assert "Not measured for other: safeloc mutate MACHINE --sample 100 measures it" in said


def test_a_page_without_scores_names_the_command(transmission: Target) -> None:
    """And has no column for them."""
    page = to_html(report_data([], [transmission]))
    assert "<code>safeloc mutate transmission --sample 100</code>" in page
    assert "wrong machines that a proof notices" not in page


def test_data_fit_the_schema_and_an_older_report_is_still_read(transmission: Target, tmp_path: Path) -> None:
    """A report that was written before there were scores has no such field; what changed since then names the score."""
    write_folder(tmp_path, [], [transmission], scores={"transmission": SCORE})
    new = read_for_page(tmp_path)
    jsonschema.validate(json.loads((tmp_path / "report.json").read_text(encoding="utf-8")), schema())
    write_folder(tmp_path, [], [transmission])
    path = tmp_path / "report.json"
    path.write_text(path.read_text(encoding="utf-8").replace(',"mutation":null', ""), encoding="utf-8")
    assert "safeloc mutate transmission" in render_folder(tmp_path).read_text(encoding="utf-8")
    old = read_for_page(tmp_path)
    assert "mutation" not in old["machines"][0]
    assert ("new: transmission = 585 of 588 (99 %), 594 of 594 judged",) == changes(old, new).sections[
        "mutation scores"
    ]
