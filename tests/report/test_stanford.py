"""The Stanford diagram: every step in its region, every mark where error and margin put it."""

from __future__ import annotations

import pytest

from safeloc.railway.pictures import Stanford, unreadable
from safeloc.report.recorded_run import Broken, RecordedRun
from safeloc.report.stanford import REGIONS, Region, region, stanford_picture
from safeloc.reported import Reported
from tests.report.drawing_reader import Drawing, across, drawing, kinds, points, upright, words
from tests.report.gauge import drive, system

PICTURE = Stanford("Error against margin", Reported(), 10_000)
PLACES = range(0, 40_000, 1_000)


def told(error_mm: int, margin_below_mm: int = 4_000, margin_above_mm: int = 6_000) -> RecordedRun:
    """Every step with the same error and margins."""
    return drive([{"given_position": p + error_mm, "given_margin_below": margin_below_mm, "given_margin_above": margin_above_mm} for p in PLACES], PLACES)  # fmt: skip


def drawn(run: RecordedRun) -> Drawing:
    """The picture of a run."""
    return drawing(stanford_picture(PICTURE, run))


@pytest.mark.parametrize(
    ("error", "margin", "expected"),
    [
        (4, 5, "nominal"), (5, 5, "nominal"), (10, 10, "nominal"), (4, 11, "unavailable"), (11, 12, "unavailable"),
        (6, 5, "misleading"), (10, 9, "misleading"), (11, 5, "hazardous"), (13, 12, "hazardous"),
    ],
)  # fmt: skip
def test_regions(error: float, margin: float, expected: Region) -> None:
    """Equal is within; beyond margin and limit it is hazardous, even where the margin is beyond the limit too."""
    assert expected == region(error, margin, 10)


@pytest.mark.parametrize(("error", "margin"), [(3_000, 4_000), (-3_000, 6_000)])
def test_the_margin_is_that_of_the_truth_s_side(error: int, margin: int) -> None:
    """Reported too far: the truth lies below, where `below` guards; too near: `above`."""
    of = drawn(told(error))
    (mark,) = kinds(of, "step")
    assert abs(error) / 1_000 == pytest.approx(across(of)(float(str(mark.get("x"))) + 3), abs=0.1)
    assert margin / 1_000 == pytest.approx(upright(of)(float(str(mark.get("y"))) + 3), abs=0.1)
    assert "nominal: 40" in words(of)


@pytest.mark.parametrize(("error", "name"), [(5_000, "misleading"), (30_000, "hazardous")])
def test_failures_are_crosses(error: int, name: str) -> None:
    """A margin of 4 m that the truth misses: a cross in its region, counted in words."""
    of = drawn(told(error))
    assert {name} == {str(mark.get("class")).split()[1] for mark in kinds(of, "step")}
    (x, _) = points(kinds(of, name)[0])[0]
    assert error / 1_000 == pytest.approx(across(of)(x + 4), abs=0.3)
    assert f"{name}: 40" in words(of)
    assert "nominal: 0" in words(of)


@pytest.mark.parametrize(("error", "margin"), [(200_000, 5_000), (1_000, 200_000)])
def test_each_axis_has_its_own_scale(error: int, margin: int) -> None:
    """A far error does not flatten the margins, nor the reverse; regions fill the frame, and the diagonal ends on it."""
    of = drawn(told(error, margin, margin))
    ends = across(of)(985), upright(of)(24 + 14)
    assert ends == pytest.approx((max(error, 10_000) * 1.15 / 1_000, max(margin, 10_000) * 1.15 / 1_000), rel=0.05)
    corners = [point for name in REGIONS for shape in kinds(of, f"region-{name}") for point in points(shape)]
    frame = kinds(of, "frame")[0]
    left, top, wide, tall = (float(str(frame.get(name))) for name in ("x", "y", "width", "height"))
    assert all(left - 0.1 <= x <= left + wide + 0.1 and top - 0.1 <= y <= top + tall + 0.1 for x, y in corners)
    assert wide * tall == pytest.approx(
        sum(area(shape) for name in REGIONS for shape in kinds(of, f"region-{name}")), rel=1e-3
    )


def area(shape: Drawing) -> float:
    """Of a polygon."""
    corners = points(shape)
    pairs = zip(corners, [*corners[1:], corners[0]], strict=True)
    return abs(sum(x0 * y1 - x1 * y0 for (x0, y0), (x1, y1) in pairs)) / 2


def test_silence_is_unavailable_and_said() -> None:
    """Steps without report are counted with the unavailable ones; a run without any report has no picture."""
    steps = [{"given_position": p, "told": p >= 10_000} for p in PLACES]
    of = drawn(drive(steps, PLACES))
    assert "unavailable: 10" in words(of)
    assert "nothing reported in 10 of 40 steps" in words(of)
    assert not stanford_picture(PICTURE, drive([{"told": False}] * 40, PLACES))


def test_the_diagonal_and_the_limit_stand_where_the_axes_say() -> None:
    """The limit's lines cross at 10 m of error and of margin."""
    of = drawn(told(0))
    level, line = (str(one.get("d")) for one in kinds(of, "limit") if one.get("stroke-width") == "1.6")
    assert 10.0 == pytest.approx(upright(of)(float(level.split(" ")[1].split("H")[0])), abs=0.05)
    assert 10.0 == pytest.approx(across(of)(float(line[1:].split(" ")[0])), abs=0.05)


def test_violated_statements_are_named() -> None:
    """Above the diagram, with the step."""
    run = told(30_000)
    of = drawn(RecordedRun(run.name, run.trace, run.truth_mm, (Broken("containment", 1),)))
    assert "\N{MULTIPLICATION SIGN} violated at step 1: containment" in words(of)


def test_it_reads_what_the_machine_has() -> None:
    """The gauge has every name; another machine's names are found missing."""
    assert not unreadable(PICTURE, system())
    wrong = Stanford("x", Reported(position="place_mm"), 1)
    assert ["no output or state 'place_mm'"] == unreadable(wrong, system())
