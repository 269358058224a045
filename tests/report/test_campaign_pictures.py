"""Pictures of campaigns show what was counted, and the band of a curve as steps."""

from __future__ import annotations

import re

import pytest

from safeloc.report.campaign_pictures import (
    Spread,
    Stretch,
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


def at(number: int, share: float, width_mm: float | None = None, widest_mm: int = 0) -> Stretch:
    """A stretch that ten vehicles crossed, with intervals 0.1 and 500 mm to both sides."""
    width = None if width_mm is None else Spread(width_mm, width_mm - 500, width_mm + 500)
    return Stretch(number, 10, Spread(share, share - 0.1, share + 0.1), 10 if width else 0, width, widest_mm)


STRETCHES = [at(0, 1.0, 4_000, 6_000), at(1, 0.0), at(2, 0.5, 5_000, 9_000)]


def curve(drawn: str, kind: str) -> list[tuple[float, float]]:
    """The points of the first curve of a kind."""
    path = re.findall(rf'<path d="M([^"]*)" fill="none"[^>]*class="{kind}"', drawn)[0]
    return [(float(x), float(y)) for x, y in (point.split() for point in path.split("L"))]


def bands(drawn: str) -> list[list[tuple[float, float]]]:
    """The corners of each band, in the order of drawing."""
    found = re.findall(r'<polygon points="([^"]*)"[^>]*class="confidence"', drawn)
    return [[(float(x), float(y)) for x, y in (one.split(",") for one in corners.split())] for corners in found]


def test_widths_are_drawn_where_something_is_reported() -> None:
    """A stretch without a report is left out, without any there is no picture; the band goes as far above the mean as below."""
    drawn = width_along_line({"a": STRETCHES}, 50_000, 0.95, "w")
    assert 2 == drawn.count('class="width"')
    mean, [band] = curve(drawn, "width"), bands(drawn)
    assert 2 == len(mean) and 4 == len(band)
    assert band[0][1] < mean[0][1] < band[3][1]
    assert mean[0][1] - band[0][1] == pytest.approx(band[3][1] - mean[0][1], abs=0.2)
    assert "fewer than 3.0 / (their number in the run) are wider, at 95 %" in drawn
    assert "<style>" in with_style(drawn)
    assert width_along_line({"a": [at(1, 0.0)]}, 50_000, 0.95, "w") == ""


def test_a_mean_width_that_nothing_bounds_has_no_band() -> None:
    """As of a machine without a tolerance."""
    free = Stretch(0, 10, Spread(1.0, 0.9, 1.0), 10, Spread(4_000, None, None), 6_000)
    drawn = width_along_line({"a": [free, at(1, 1.0, 4_000, 6_000)]}, 50_000, 0.95, "w")
    assert [2] == [len(one) for one in bands(drawn)]
    assert not bands(width_along_line({"a": [free]}, 50_000, 0.95, "w"))


def test_availability_falls_where_nothing_is_reported() -> None:
    """Stretches without a report are drawn too, at 0; the band ends at 0 and at 1, with a little room."""
    drawn = availability_along_line({"a": STRETCHES}, 50_000, 0.95, "w")
    (_, full), (_, none), (_, half) = curve(drawn, "availability")
    assert full < half < none
    assert half == pytest.approx((full + none) / 2, abs=0.11)
    [band] = bands(drawn)
    assert 6 == len(band)
    assert (none, band[2][1] < half < band[3][1]) == (band[4][1], True)
    assert availability_along_line({"a": []}, 50_000, 0.95, "w") == ""


def least(*values_mm: int) -> list[Spread]:
    """Smallest margins whose intervals reach 100 mm to both sides; nothing bounds that of 1 % below."""
    first, second, *others = values_mm
    return [
        Spread(first, None, None),
        Spread(second, None, second + 100),
        *(Spread(one, one - 100, one + 100) for one in others),
    ]


def test_margins_stand_left_of_the_truth_where_an_interval_misses_it() -> None:
    """A row for each situation with a report; one with a wrong interval crosses the line at 0."""
    rows = {"a": least(500, 700, 900, 4_000), "b": least(-2_000, 10, 20, 30), "never reports": []}
    drawn = margins_of_situations(rows, 0.95, "m")
    assert "never reports" not in drawn
    zero = float(re.findall(r'<path d="M([\d.]+) [^"]*"[^>]*class="truth"', drawn)[0])
    begins = [float(x) for x in re.findall(r'<path d="M([\d.]+) [^"]*" fill="none"[^>]*class="margin"', drawn)]
    assert [begin < zero for begin in begins] == [False, True]
    assert 8 == drawn.count('class="quantile"')
    assert margins_of_situations({"a": []}, 0.95, "m") == ""


def test_each_quantile_has_its_interval() -> None:
    """The least margin has none; where nothing bounds a quantile its bar ends at the picture's edge."""
    drawn = margins_of_situations({"a": least(500, 700, 900, 4_000)}, 0.95, "m")
    one_percent, tenth, half = ([x for x, _ in corners] for corners in bands(drawn))
    dots = [float(x) for x in re.findall(r'<circle cx="([\d.]+)"[^>]*class="quantile"', drawn)]
    for dot, bar in zip(dots[1:], (one_percent, tenth, half), strict=True):
        assert min(bar) < dot < max(bar)
    assert dots[2] - min(tenth) == pytest.approx(max(tenth) - dots[2], abs=0.2)
    assert min(one_percent) < dots[0] - 1 < min(tenth)


def test_of_many_situations_the_worst_are_told_apart() -> None:
    """They have a colour, a band and a name; the others are grey, drawn before them, and counted."""
    times = {f"situation {number}": [(-1, number), (10, 40 - number)] for number in range(40)}
    drawn = times_until_silent(times, dict.fromkeys(times, 100), 0.95, "times")
    named = [int(one) for one in re.findall(r"situation ([0-9]+): 40 vehicles", drawn)]
    assert named == list(range(40 - len(named), 40))
    assert len(named) == drawn.count("<polygon")
    assert f"{40 - len(named)} other situations" in drawn
    assert 40 == drawn.count('class="withdrawn"')
    widths = {f"situation {number}": [at(0, 1.0, 1_000, 2_000 + number)] for number in range(40)}
    drawn = width_along_line(widths, 50_000, 0.95, "w")
    assert "situation 39<" in drawn and "situation 0<" not in drawn
    told = {f"situation {number}": [at(0, number / 40)] for number in range(40)}
    drawn = availability_along_line(told, 50_000, 0.95, "a")
    assert "situation 0<" in drawn and "situation 39<" not in drawn
