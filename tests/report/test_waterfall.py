"""The waterfall: loudness as it was, trains, intervals and signals at their place and time, and the same in words."""

from __future__ import annotations

import base64
import struct
import zlib
from dataclasses import replace

import pytest

from safeloc.railway.pictures import LoudFibre, NamedInterval, Stretch, TrueEnds, Waterfall, unreadable
from safeloc.report.png import SIGNATURE
from safeloc.report.recorded_run import RecordedRun
from safeloc.report.waterfall import described, waterfall_picture, waterfall_table
from safeloc.reported import Reported
from tests.report.drawing_reader import Drawing, across, drawing, kinds, points, upright, words
from tests.report.gauge import drive, system
from tests.report.shipped_runs import picture
from tests.report.shipped_runs import told as shipped_run

STEPS, STEP_MS = 40, 500
LOUD = LoudFibre(
    title="A drive",
    says="Nothing goes wrong.",
    first_ms=STEP_MS,
    step_ms=STEP_MS,
    steps_per_column=2,
    row_mm=500_000,
    level_cdb=300,
    rows=("0" * 19 + "f", "5" * 20, "." * 20, "0123456789abcdef0000"),
    trains=(TrueEnds(tuple(range(0, 2_000_000, 100_000)), tuple(range(200_000, 2_200_000, 100_000))),),
    sections=(Stretch(900_000, 1_100_000, "raised, short"),),
    marks={"axle counter": 300_000},
)
PICTURE = Waterfall(
    "Fibre", lambda name: LOUD if name == "drive" else None, (NamedInterval("front", Reported()),), signals=("valid",)
)


def run(silent: range = range(0)) -> RecordedRun:
    """The front 200 m ahead of the step's place, with 50 m below and 80 m above; silent in some steps."""
    places = [200_000 + 50_000 * number for number in range(STEPS)]
    steps = [
        {
            "given_position": place,
            "given_margin_below": 50_000,
            "given_margin_above": 80_000,
            "told": number not in silent,
        }
        for number, place in enumerate(places)
    ]
    return drive(steps, places)


def drawn(told: RecordedRun) -> Drawing:
    """The picture."""
    return drawing(waterfall_picture(PICTURE, told))


def pixels(of: Drawing) -> list[bytes]:
    """Numbers of colours, rows from the top."""
    (image,) = kinds(of, "loudness")
    content = base64.b64decode(str(image.get("href")).split(",")[1])
    width, height = struct.unpack_from(">II", content, len(SIGNATURE) + 8)
    at = content.index(b"IDAT")
    (length,) = struct.unpack_from(">I", content, at - 4)
    rows = zlib.decompress(content[at + 4 : at + 4 + length])
    return [rows[row * (width + 1) + 1 : (row + 1) * (width + 1)] for row in range(height)]


def test_every_level_is_a_pixel() -> None:
    """The greatest place on top; what told nothing has a colour of its own."""
    rows = pixels(drawn(run()))
    assert bytes([*range(16), 0, 0, 0, 0]) == rows[0]
    assert bytes([16] * 20) == rows[1]
    assert bytes([5] * 20) == rows[2]
    assert bytes([0] * 19 + [15]) == rows[3]
    assert "no data" in words(drawn(run()))


def test_true_ends_stand_at_their_place_and_time() -> None:
    """Both ends of the train, a column apart 1 s."""
    of = drawn(run())
    high, low = kinds(of, "true-end")
    for path, first in ((high, 200_000), (low, 0)):
        for number, (x, y) in enumerate(points(path)):
            assert (number + 1) == pytest.approx(across(of)(x), abs=0.1)
            assert (first + 100_000 * number) / 1e6 == pytest.approx(upright(of)(y), abs=0.01)


def test_the_interval_is_where_it_was_reported() -> None:
    """From under to over, and nowhere where nothing was reported."""
    of = drawn(run(range(10, 20)))
    bands = kinds(of, "interval")
    assert 2 == len(bands)
    xs = [across(of)(x) for x, _ in points(bands[0])]
    assert pytest.approx([0.5, 5.0], abs=0.1) == [min(xs), max(xs)]
    heights = [upright(of)(y) for x, y in points(bands[0]) if across(of)(x) < 0.6]
    assert pytest.approx([0.15, 0.28], abs=0.01) == [min(heights), max(heights)]


def test_sections_and_marks_are_named_at_their_place() -> None:
    """A localization section, an axle counter; a mark for every position signal."""
    of = drawn(run(range(5, STEPS)))
    assert {"raised, short", "axle counter", "localization section"} <= set(words(of))
    low, high = kinds(of, "section")
    places = [upright(of)(float(str(path.get("d")).split("150 ")[1].split("H")[0])) for path in (low, high)]
    assert pytest.approx([0.9, 1.1], abs=0.01) == places
    assert 5 == len(kinds(of, "position-signal"))


def test_it_is_told_in_words_and_numbers_too() -> None:
    """The scene, the modes in time; a table of trains, intervals and modes."""
    told = run(range(10, STEPS))
    text = described(PICTURE, told)
    assert "2.0 km of fibre over 20 s. Nothing goes wrong. mode: TELLING from 0 s, SILENT from 6 s." in text
    assert text == drawn(told).get("aria-label")
    table = waterfall_table(PICTURE, told)
    assert table is not None
    assert ["time in s", "train in m", "front in m", "mode"] == table["head"]
    assert ["0.5", "0 to 200", "150 to 280", "TELLING"] == table["rows"][0]
    assert ["20.0", "1900 to 2100", "not reported", "SILENT"] != table["rows"][-1]
    assert "not reported" in table["rows"][-1]


def test_a_recording_of_which_nothing_was_kept_has_no_picture() -> None:
    """Nor words, nor numbers."""
    told = replace(run(), name="other")
    assert ("", "", None) == (
        waterfall_picture(PICTURE, told),
        described(PICTURE, told),
        waterfall_table(PICTURE, told),
    )


def test_a_signal_that_there_is_not_is_named() -> None:
    """Before anything is drawn."""
    assert [] == unreadable(PICTURE, system())
    assert ["no output or state 'bell'"] == unreadable(replace(PICTURE, signals=("bell",)), system())


def test_the_shipped_figures_are_drawn_small() -> None:
    """Figure 2 with two position signals, two sections, and less than 100 kB."""
    told = shipped_run("fibre", "fibre-figure-2-rising")
    text = waterfall_picture(picture("fibre", Waterfall), told)
    assert len(text) < 100_000
    of = drawing(text)
    assert 2 == len(kinds(of, "position-signal"))
    assert {"raised, short", "raised, long"} <= set(words(of))
    assert {"WAITING", "LOCATED"} <= set(words(of))
