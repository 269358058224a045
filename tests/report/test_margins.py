"""Margins on the report: of the present content of a target or not at all, as a table, as bars, and on the first page."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import jsonschema
import pytest

from safeloc.assurance.margins.asking import UNMOVED, Answer
from safeloc.assurance.margins.figures import Figure
from safeloc.assurance.margins.kept_margins import MARGINS, keep_margins
from safeloc.assurance.margins.limits_of_figures import Limit
from safeloc.assurance.margins.margin_data import row
from safeloc.catalogue import load_target
from safeloc.proof.cache.store import Store
from safeloc.report.data import report_data, schema
from safeloc.report.folder import render_folder, write_folder
from safeloc.report.margins import first_page_row, front_picture, margins_picture
from safeloc.report.page import to_html
from safeloc.target import Target

SPEED, AGE = Figure("max_speed_mm_s", 44_445, "mm/s", 1, 138_889), Figure("age_limit_ms", 1_000, "ms", 0, 60_000)
LENGTH = Figure("length_mm", 2, "mm", 0, 4)
RUN = Answer("broken", "the vehicle is where it says", first={"mode": 0}, inputs=({"x": 1}, {"x": 2}))
FRONT = {"name": "speed or age", "where": "world", "first": "max_speed_mm_s", "second": "age_limit_ms",
         "points": [[44_445, 1_200, "at 1201 a run"], [50_000, 1_000, "at 1001 a run"]]}  # fmt: skip


def limits() -> list[dict[str, Any]]:
    return [
        row(Limit(SPEED, "down", 1, Answer("proved"), None)),
        row(Limit(SPEED, "up", 48_000, RUN, 48_001)),
        row(Limit(AGE, "down", 1_000, replace(RUN, claim="<b>"), 999)),
        row(Limit(AGE, "up", 1_100, Answer("undecided", "c"), 1_101)),
        row(Limit(LENGTH, "down", 0, Answer("proved"), None, proved_why=UNMOVED)),
        row(Limit(LENGTH, "up", 4, Answer("proved"), None)),
        row(Limit(Figure("unread", 5, "", 0, 50), "down", 0, Answer("proved"), None, proved_why=UNMOVED)),
        row(Limit(Figure("unread", 5, "", 0, 50), "up", 50, Answer("proved"), None, proved_why=UNMOVED)),
    ]


@pytest.fixture(name="transmission", scope="module")
def _transmission() -> Target:
    return load_target("transmission")


def page_of(target: Target, margins: dict[str, Any]) -> str:
    return to_html(report_data([], [target], margins={target.name: margins} if margins else {}))


def test_kept_margins_are_of_this_content_alone(transmission: Target, tmp_path: Path) -> None:
    """A target with one property less has none: a stale margin is never shown."""
    store = Store(tmp_path)
    keep_margins(store, transmission, "world", limits())
    assert MARGINS.of_targets(store, [transmission]) == {"transmission": {"world": limits()}}
    assert MARGINS.of_targets(store, [replace(transmission, properties=transmission.properties[1:])]) == {}


def test_a_report_in_the_cache_is_not_used_once_margins_are_kept(transmission: Target, tmp_path: Path) -> None:
    store = Store(tmp_path)
    assert MARGINS.stamp(store) == ""
    keep_margins(store, transmission, "world", limits())
    first = MARGINS.stamp(store)
    keep_margins(store, transmission, "world", limits())
    assert MARGINS.stamp(store) == first
    keep_margins(store, transmission, "pairs", [FRONT])
    assert MARGINS.stamp(store) != first
    assert set(MARGINS.of_targets(store, [transmission])["transmission"]) == {"world", "pairs"}


def test_the_page_shows_each_limit_and_what_ends_it(transmission: Target) -> None:
    page = page_of(transmission, {"world": limits(), "pairs": [FRONT]})
    assert "at 48001 a run of 2 cycles breaks &#39;the vehicle is where it says&#39;" in page
    assert "Nothing in the world depends on unread." in page
    assert "breaks &#39;&lt;b&gt;&#39;" in page
    assert "speed or age: age_limit_ms beside max_speed_mm_s" in page
    assert "safeloc margins transmission" not in page


def test_a_page_without_margins_names_the_command(transmission: Target) -> None:
    page = page_of(transmission, {})
    assert "<code>safeloc margins transmission</code> finds it" in page
    assert 'id="margins"' not in page


def test_the_page_says_which_margins_ship_and_shows_none_of_another_version(transmission: Target) -> None:
    page = page_of(transmission, {"world": limits(), "shipped": "2026-11-27"})
    assert "Found on 2026-11-27 and shipped with this version of the machine" in page
    assert "Those of transmission were found before and ship with this version" in page
    stale = page_of(transmission, {"other_version": "2026-11-26"})
    assert "found on 2026-11-26 for another version of this machine, and are not shown" in stale
    assert "<code>safeloc margins transmission</code> finds it" in stale
    assert 'id="margins"' not in stale
    both = to_html(
        report_data(
            [],
            [transmission, replace(transmission, name="other")],
            margins={"transmission": {"world": limits()}, "other": {"other_version": "2026-11-26"}},
        )
    )
    assert "Those that ship with other are of another version of the machine, and are not shown." in both


def test_the_first_page_tells_what_has_no_margin_and_what_has_least() -> None:
    found = first_page_row("transmission", {"world": limits()})
    assert found["none"] == ["age_limit_ms down"]
    assert found["least"] == ["max_speed_mm_s +8 %"]
    assert found["undecided"] == ["age_limit_ms up"]
    both = [*limits(), row(Limit(AGE, "up", 1_000, RUN, 1_001))]
    assert first_page_row("transmission", {"world": both})["none"] == ["age_limit_ms down and up"]
    assert found["figures"] == 3
    assert not first_page_row("transmission", {"pairs": [FRONT]})["known"]


def test_the_first_page_names_machines_without_margins(transmission: Target) -> None:
    both = [transmission, replace(transmission, name="other")]
    page = to_html(report_data([], both, margins={"transmission": {"world": limits()}}))
    assert 'id="margins"' in page
    assert "Not found for other" in page


def test_data_fit_the_schema_and_an_older_report_is_still_read(transmission: Target, tmp_path: Path) -> None:
    data = report_data(
        [], [transmission], margins={"transmission": {"world": limits(), "pairs": [FRONT], "shipped": "2026-11-27"}}
    )
    jsonschema.validate(json.loads(json.dumps(data)), schema())
    write_folder(tmp_path, [], [transmission])
    path = tmp_path / "report.json"
    path.write_text(path.read_text(encoding="utf-8").replace(',"margins":null', ""), encoding="utf-8")
    assert "safeloc margins transmission" in render_folder(tmp_path).read_text(encoding="utf-8")


def test_bars_reach_from_limit_to_limit_and_say_how_they_end() -> None:
    drawn = margins_picture(limits(), "world")
    root = ElementTree.fromstring(drawn)
    assert root.get("aria-label") == "how far each figure may move, in factors of its configured value (world)"
    bars = [one for one in root.iter() if one.tag.endswith("rect") and list(one)]
    assert len(bars) == 3
    assert float(bars[0].get("width", 0)) > float(bars[1].get("width", 0))
    assert drawn.count('class="broken"') == 2
    assert ">?<" in drawn
    assert margins_picture([], "world") == ""


def test_a_front_goes_down_from_left_to_right_and_a_single_point_is_none() -> None:
    root = ElementTree.fromstring(front_picture(FRONT))
    points = [(float(one.get("cx", 0)), float(one.get("cy", 0))) for one in root.iter() if one.tag.endswith("circle")]
    (left, above), (right, below) = points
    assert left < right
    assert above < below
    assert front_picture({**FRONT, "points": FRONT["points"][:1]}) == ""
