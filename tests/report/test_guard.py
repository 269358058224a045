"""The page of a guarded run: every mark is there, it stands alone, and odd runs make a page too."""

from __future__ import annotations

import re
from pathlib import Path
from xml.etree import ElementTree

import pytest

from safeloc.errors import InputError
from safeloc.models.guard.positions import csv_text, junction
from safeloc.models.guard.variables import JUDGED
from safeloc.railway.guard.deliveries import Delivery
from safeloc.railway.guard.fields import Columns
from safeloc.railway.guard.figures import find_vehicle, guard_config
from safeloc.railway.guard.guard import Guard, Judgement
from safeloc.railway.guard.streams import csv_deliveries
from safeloc.railway.guard.tracks import Tracks
from safeloc.railway.map.imports.geojson_path import route_over
from safeloc.railway.map.topology import Topology
from safeloc.report.guard_folder import guard_page, write_guard_folder
from safeloc.report.guard_map import Spot, guard_map
from safeloc.report.guard_plot import Moment, guard_plot
from safeloc.report.guard_words import WORDS
from safeloc.report.style_sheet import style_sheet

pytest.importorskip("shapely")
pytest.importorskip("pyproj")
CONFIG = guard_config(find_vehicle("metro"))


def run(deliveries: list[Delivery] | None = None) -> tuple[list[Judgement], Tracks]:
    """The made-up receiver, or other deliveries, guarded on the junction."""
    line = junction()
    route = route_over(["stem", "main"], Topology(line))
    tracks = Tracks(line, clear_mm=CONFIG.track_clearance_mm, reach_mm=CONFIG.tolerance_mm, route=route)
    if deliveries is None:
        columns = Columns(speed="speed_m_s", flag="quality")
        deliveries = list(csv_deliveries(csv_text().splitlines(keepends=True), columns, "made-up"))
    return list(Guard(CONFIG, tracks).judge_all(deliveries)), tracks


def drawings(page: str) -> list[ElementTree.Element]:
    """The drawings of a page, each a well-formed tree."""
    return [ElementTree.fromstring(text) for text in re.findall(r"<svg.*?</svg>", page, re.DOTALL)]


def marked(drawing: ElementTree.Element, kind: str) -> int:
    """Marks of a class, the legend's own apart."""
    return sum(kind in (one.get("class") or "").split() for one in drawing.iter())


def test_every_reason_has_words() -> None:
    """A reader finds every reason of the machine explained."""
    assert {reason.label for reason in JUDGED} == set(WORDS)


def test_the_page_stands_alone() -> None:
    """Map and intervals are in it; nothing is fetched from elsewhere."""
    page = guard_page(*run(), CONFIG, "made-up.csv")
    assert 2 == len(drawings(page))
    assert [] == re.findall(r'(?:src|href)="(?!#)', page)
    assert "http" not in page.replace("http://www.w3.org/2000/svg", "")
    assert style_sheet() in page and "font:15px" in page and "{%" not in page and "{{" not in page


def test_the_map_shows_what_was_withheld() -> None:
    """Dots for what is passed on, crosses for what is withheld, and all three tracks."""
    judgements, tracks = run()
    drawing = drawings(guard_page(judgements, tracks, CONFIG, "made-up.csv"))[0]
    assert marked(drawing, "passed") > 50
    assert marked(drawing, "withheld") > 20
    assert 3 <= marked(drawing, "track")
    words = " ".join(drawing.itertext())
    assert f"PASSED: {sum(one.passed for one in judgements)}" in words
    assert "OFF_TRACK: 12" in words


def test_marks_of_one_place_are_drawn_once() -> None:
    """A vehicle that stands for an hour is one dot, and its number stands in the legend."""
    spots = [Spot(0.0, 0.0, "PASSED")] * 9_000
    text = guard_map({"a": ((-50.0, 0.0), (50.0, 0.0))}, (), spots, "still")
    assert text.count("<circle") == 2
    assert "PASSED: 9000" in text


def test_silence_is_shaded() -> None:
    """Where no interval is reported the plot says so."""
    moments = [
        Moment(0, "PASSED", 0, (-1_000, 1_000)),
        Moment(1_000, "NO_FIX", None, None),
        Moment(3_000, "JUMP", 9_000, None),
    ]
    (drawing,) = drawings(guard_plot(moments, 30_000, "gap"))
    assert 2 == marked(drawing, "silent")
    assert 2 == marked(drawing, "interval")


@pytest.mark.parametrize(
    "deliveries",
    [[], [Delivery(1, wrong="cut off")], [Delivery(1, 5)], [Delivery(1, 5, 9.0, 48.0)], [Delivery(1, 5, 9.0, 10.0)]],
    ids=["nothing", "no line", "no fix", "one fix", "far away"],
)
def test_odd_runs_make_a_page(deliveries: list[Delivery]) -> None:
    """Runs without a place, a time or any delivery."""
    page = guard_page(*run(deliveries), CONFIG, "<odd>.csv")
    assert "&lt;odd&gt;.csv" in page
    drawings(page)


def test_a_folder_that_cannot_be_written(tmp_path: Path) -> None:
    """Is told by name."""
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be written here"):
        write_guard_folder(tmp_path / "file", *run([]), CONFIG, "s.csv")
