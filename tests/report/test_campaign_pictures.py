"""Pictures of campaigns show what was counted, and the band of a curve as steps."""

from __future__ import annotations

import re

import pytest

from safeloc.report.campaign_pictures import (
    availability_along_line,
    margins_of_situations,
    stanford_of_cells,
    times_until_silent,
    width_along_line,
    with_style,
)


def test_cells_keep_their_standing() -> None:
    """Counts go to their regions; a wrong interval on the diagonal stays below it, a contained one above."""
    cells = [(3, 3, "contained", 70), (3, 3, "wrong", 2), (90, 20, "wrong", 1), (0, 60, "contained", 4)]
    drawn = stanford_of_cells(cells, 5, 50_000, 50, "all")
    for words in (
        "nominal: 70",
        "misleading: 2",
        "hazardous: 1",
        "unavailable: 9",
        "nothing reported in 5 of 82 steps",
    ):
        assert words in drawn
    assert stanford_of_cells([], 5, 50_000, 50, "all") == ""


def test_the_curve_ends_at_those_that_withdrew_and_its_band_is_of_steps() -> None:
    """Three of four vehicles withdrew: at 1 s one, at 2 s two; the band has two corners for each corner of the curve."""
    drawn = times_until_silent({"a": [(-1, 1), (10, 1), (20, 2)]}, {"a": 100}, 0.95, "times")
    assert "a: 4 vehicles" in drawn
    [corners] = re.findall(r'<polygon points="([^"]*)"', drawn)
    assert 2 * 6 == len(corners.split())
    [path] = re.findall(r'<path d="M([^"]*)" fill="none"[^>]*class="withdrawn"', drawn)
    heights = [float(point.split()[1]) for point in path.split("L")]
    assert heights[0] > heights[-1] > 28
    assert times_until_silent({"a": []}, {"a": 100}, 0.95, "times") == ""


def test_widths_are_drawn_where_something_is_reported() -> None:
    """A stretch without a report is left out; without any there is no picture."""
    drawn = width_along_line(
        {"a": [(0, 10, 10, 4_000, 6_000), (1, 10, 0, 0, 0), (2, 10, 5, 5_000, 9_000)]}, 50_000, "w"
    )
    assert 2 == drawn.count('class="width"')
    assert "<style>" in with_style(drawn)
    assert width_along_line({"a": [(1, 10, 0, 0, 0)]}, 50_000, "w") == ""


def test_availability_falls_where_nothing_is_reported() -> None:
    """Stretches without a report are drawn too, at 0."""
    drawn = availability_along_line(
        {"a": [(0, 10, 10, 4_000, 6_000), (1, 10, 0, 0, 0), (2, 10, 5, 5_000, 9_000)]}, 50_000, "w"
    )
    [path] = re.findall(r'<path d="M([^"]*)" fill="none"[^>]*class="availability"', drawn)
    full, none, half = (float(point.split()[1]) for point in path.split("L"))
    assert full < half < none
    assert half == pytest.approx((full + none) / 2, abs=0.11)
    assert availability_along_line({"a": []}, 50_000, "w") == ""


def test_margins_stand_left_of_the_truth_where_an_interval_misses_it() -> None:
    """A row for each situation with a report; one with a wrong interval crosses the line at 0."""
    drawn = margins_of_situations({"a": [500, 700, 900, 4_000], "b": [-2_000, 10, 20, 30], "never reports": []}, "m")
    assert "never reports" not in drawn
    zero = float(re.findall(r'<path d="M([\d.]+) [^"]*"[^>]*class="truth"', drawn)[0])
    begins = [float(x) for x in re.findall(r'<path d="M([\d.]+) [^"]*" fill="none"[^>]*class="margin"', drawn)]
    assert [begin < zero for begin in begins] == [False, True]
    assert 8 == drawn.count('class="quantile"')
    assert margins_of_situations({"a": []}, "m") == ""


def test_of_many_situations_the_worst_are_told_apart() -> None:
    """They have a colour, a band and a name; the others are grey, drawn before them, and counted."""
    times = {f"situation {number}": [(-1, number), (10, 40 - number)] for number in range(40)}
    drawn = times_until_silent(times, dict.fromkeys(times, 100), 0.95, "times")
    named = [int(one) for one in re.findall(r"situation ([0-9]+): 40 vehicles", drawn)]
    assert named == list(range(40 - len(named), 40))
    assert len(named) == drawn.count("<polygon")
    assert f"{40 - len(named)} other situations" in drawn
    assert 40 == drawn.count('class="withdrawn"')
    widths = {f"situation {number}": [(0, 10, 10, 1_000, 2_000 + number)] for number in range(40)}
    assert "situation 39<" in width_along_line(widths, 50_000, "w")
    assert "situation 0<" not in width_along_line(widths, 50_000, "w")
    told = {f"situation {number}": [(0, 100, number, 1_000, 2_000)] for number in range(40)}
    assert "situation 0<" in availability_along_line(told, 50_000, "a")
    assert "situation 39<" not in availability_along_line(told, 50_000, "a")
