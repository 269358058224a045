"""The picture of deviation over distance: every mark stands where the run has it."""

from __future__ import annotations

import pytest

from safeloc.report.deviation import deviation_picture
from safeloc.report.recorded_run import Broken, RecordedRun
from tests.report.drawing_reader import Drawing, across, begin, drawing, end, kinds, points, upright, words
from tests.report.gauge import PICTURE, TOLERANCE_MM, drive

PLACES = range(0, 100_000, 1_000)
"""A drive over 100 m in steps of 1 m."""


def drawn(told: RecordedRun) -> Drawing:
    """The picture of a run."""
    return drawing(deviation_picture(PICTURE, told))


def level(off_mm: int = 500, **more: int) -> RecordedRun:
    """A drive that reports its place with a steady deviation."""
    return drive([{"given_position": place + off_mm, **more} for place in PLACES], PLACES)


def test_the_curve_is_reported_less_true_position() -> None:
    """Each point of the curve reads as place and deviation, in metres."""
    of = drawn(level())
    place, deviation = across(of), upright(of)
    (line, *_) = kinds(of, "deviation")
    assert [round(deviation(y), 1) for _, y in points(line)] == [0.5] * len(points(line))
    assert [round(place(x)) for x, _ in points(line)] == [metre for metre in range(100)]


def test_the_interval_is_what_the_deviation_must_keep_to() -> None:
    """From the margin above, downwards, to the margin below, upwards: that is where the true position lies within the reported interval."""
    of = drawn(level())
    deviation = upright(of)
    (band, *_) = kinds(of, "interval")
    heights = {round(deviation(y), 1) for _, y in points(band)}
    assert heights == {-2.0, 1.0}


def test_the_tolerable_error_is_two_lines() -> None:
    """At the configured error above and below."""
    of = drawn(level())
    deviation = upright(of)
    heights = [float(str(line.get("d")).split(" ")[1].split("H")[0]) for line in kinds(of, "tolerable")]
    assert [round(deviation(y), 1) for y in heights] == [TOLERANCE_MM / 1_000, -TOLERANCE_MM / 1_000]


def test_an_enlarged_panel_shows_small_deviations() -> None:
    """Where the interval is narrow the same curve is drawn a second time at its own scale, cut to its panel."""
    of = drawn(level())
    lines = kinds(of, "deviation")
    assert len(lines) == 2
    assert round(upright(of, 1)(points(lines[1])[0][1]), 2) == 0.5
    assert len(of.findall(".//{*}clipPath")) == 1
    wide = drawn(level(given_margin_below=20_000, given_margin_above=20_000))
    assert len(kinds(wide, "deviation")) == 1


def test_an_interval_that_misses_the_truth_is_marked() -> None:
    """A cross at the place and deviation of the first such step, and the number of steps in the legend."""
    steps = [{"given_position": place + (9_000 if place in (40_000, 41_000) else 0)} for place in PLACES]
    of = drawn(drive(steps, PLACES))
    crosses = [mark for mark in kinds(of, "wrong") if upright(of)(points(mark)[0][1] + 6) > 5]
    (x, y) = points(crosses[0])[0]
    assert round(across(of)(x + 6)) == 40
    assert round(upright(of)(y + 6)) == 9
    assert "interval misses the truth: 2 steps from 41 on" in words(of)
    assert not kinds(drawn(level()), "wrong")


@pytest.mark.parametrize("off", [-2_000, 1_000])
def test_the_ends_of_the_interval_belong_to_it(off: int) -> None:
    """A truth at the very end of the interval is no failure."""
    assert not kinds(drawn(level(off)), "wrong")
    assert kinds(drawn(level(off - 1 if off < 0 else off + 1)), "wrong")


def test_what_is_not_reported_is_shown_as_such() -> None:
    """A grey stretch from the first to the last silent step, without curve and interval."""
    steps = [{"given_position": place, "told": not 20_000 <= place <= 50_000} for place in PLACES]
    of = drawn(drive(steps, PLACES))
    box = kinds(of, "silent")[0]
    assert [round(across(of)(x)) for x in (begin(box), end(box))] == [20, 50]
    curve = [round(across(of)(x)) for line in kinds(of, "deviation")[:2] for x, _ in points(line)]
    assert not [metre for metre in curve if 20 <= metre <= 50]
    modes = {" ".join(str(piece.get("class")).split()[1:]): piece for piece in kinds(of, "piece")}
    assert round(across(of)(begin(modes["SILENT"]))) == 20
    assert "1 SILENT" in words(of)
    assert "no position reported" in words(of)


def test_balises_and_reflectors_stand_where_the_map_has_them() -> None:
    """With identity, model and view zone; a name of the recording's own is text and goes before."""
    told: dict[str, int | str] = {"next_at": 80_000, "next_model": "B", "zone_from": 30_000, "zone_to": 5_000}
    first = {
        "next_at": 40_000,
        "next_model": "A",
        "zone_from": 10_000,
        "zone_to": 3_000,
        "balise": 106,
        "balise_at": 20_000,
    }
    seen: dict[bool, dict[str, int | str]] = {False: {}, True: told}
    steps = [{**seen[place > 50_000], **(first if place == 1_000 else {}), "given_position": place} for place in PLACES]
    of = drawn(drive(steps, PLACES))
    place = across(of)
    reflectors, zones = [mark for mark in kinds(of, "reflector")], kinds(of, "zone")
    assert [round(place(begin(mark))) for mark in kinds(of, "balise")] == [20]
    assert [round(place(begin(mark))) for mark in reflectors] == [40, 80]
    assert [(round(place(begin(zone))), round(place(end(zone)))) for zone in zones] == [(30, 37), (50, 75)]
    assert {"balise 106", "reflector R<1> (A)", "reflector B"} <= set(words(of))
    assert [round(place(begin(mark))) for mark in kinds(of, "at-reflector")] == [40, 80]


def test_a_violated_statement_is_a_line_at_its_step() -> None:
    """With its name and number, from the head down through the panels."""
    steps = [{"given_position": place} for place in PLACES]
    of = drawn(drive(steps, PLACES, [Broken("containment", 31), Broken("<tolerance>", 61)]))
    assert [round(across(of)(begin(mark))) for mark in kinds(of, "violated")] == [30, 60]
    said = [text for text in words(of) if "violated" in text]
    assert said == ["× violated at step 31: containment", "× violated at step 61: <tolerance>"]


def test_a_spike_of_one_step_in_a_long_run_is_seen() -> None:
    """10 000 steps are thinned to the width of the page, and the one that is 25 m off is still there."""
    places = range(0, 1_000_000, 100)
    off = {543_200: 25_000}
    wide = {"given_margin_below": 29_000, "given_margin_above": 29_000}
    of = drawn(drive([{"given_position": place + off.get(place, 0), **wide} for place in places], places))
    (line,) = kinds(of, "deviation")
    assert len(points(line)) < 4 * 840
    x, y = min(points(line), key=lambda point: point[1])
    assert round(upright(of)(y), 1) == 25.0
    assert abs(across(of)(x) - 543.2) < 1


def test_without_a_recorded_truth_nothing_is_made_up() -> None:
    """The interval is drawn at the reported place; no deviation, and the legend says so."""
    of = drawn(drive([{"given_position": place} for place in PLACES], [None] * 100))
    assert not kinds(of, "deviation")
    assert kinds(of, "interval")
    assert any("holds no truth" in text for text in words(of))


def test_a_run_without_any_place_has_no_picture() -> None:
    """Nothing reported and no truth: there is nothing to draw it over."""
    assert deviation_picture(PICTURE, drive([{"told": False}] * 3, [None] * 3)) == ""


def test_a_vehicle_that_stands_still_is_drawn() -> None:
    """Also where all steps have one place and the deviation is zero."""
    of = drawn(drive([{}] * 3, [0, 0, 0]))
    assert kinds(of, "interval")
