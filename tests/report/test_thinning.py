"""Thinning and strips: long runs become short drawings, and nothing that was there is hidden."""

from __future__ import annotations

from itertools import groupby

from hypothesis import given
from hypothesis import strategies as st

from safeloc.report.drawing import Axis, across, legend, number, stroke_swatch
from safeloc.report.strips import strip
from safeloc.report.thinning import Point, Span, pieces, spans, thinned, thinned_band
from tests.report.drawing_reader import begin, drawing, end, kinds, words

POINTS = st.lists(st.builds(Point, st.floats(0, 6), st.floats(-9, 9)), min_size=1, max_size=60)


def columns(points: list[Point]) -> list[list[Point]]:
    """Successive points that fall into one column."""
    return [list(group) for _, group in groupby(points, lambda point: round(point.x))]


@given(POINTS)
def test_thinning_keeps_every_extreme(points: list[Point]) -> None:
    """In each column the lowest, the highest, the first and the last stay, in their order, and at most these four."""
    kept = thinned(points)
    assert len(columns(kept)) == len(columns(points))
    for before, after in zip(columns(points), columns(kept), strict=True):
        heights = [point.y for point in before]
        assert (after[0], after[-1]) == (before[0], before[-1])
        assert {min(heights), max(heights)} <= {point.y for point in after}
        assert len(after) <= 4
    rest = iter(points)
    assert all(any(one is point for one in rest) for point in kept)


@given(st.lists(st.builds(Span, st.floats(0, 6), st.floats(-9, 0), st.floats(0, 9)), min_size=1, max_size=60))
def test_a_thinned_band_covers_the_band(band: list[Span]) -> None:
    """No span reaches out of what is drawn of its column."""
    kept: dict[int, tuple[float, float]] = {}
    for span in thinned_band(band):
        low, high = kept.get(round(span.x), (span.low, span.high))
        kept[round(span.x)] = (min(low, span.low), max(high, span.high))
    assert all(kept[round(one.x)][0] <= one.low and one.high <= kept[round(one.x)][1] for one in band)


def test_gaps_separate() -> None:
    """None interrupts a line and a band."""
    a, b = Point(0, 1), Point(1, 2)
    assert pieces([a, None, None, b, a]) == [[a], [b, a]]
    assert spans([None]) == []


def test_a_strip_says_what_was_where() -> None:
    """Pieces reach to where the next begins; a gap stays empty; a narrow piece has its number, a wide one its name."""
    axis = Axis(0, 100, 150, 950)
    places = [*map(float, range(40)), None, *map(float, range(60, 63))]
    said = ["RUN"] * 40 + [""] + ["HOLD"] * 3
    of = drawing(f"<svg>{strip(axis, places, said, ('RUN', 'HOLD'), 0, 'mode')}</svg>")
    assert [(begin(piece), end(piece)) for piece in kinds(of, "piece")] == [(150, 462), (630, 646)]
    assert words(of) == ["mode", "RUN", "2"]


def test_a_mode_of_one_step_is_seen_in_a_long_strip() -> None:
    """100 000 steps that flap between two modes are at most two pieces in a column, and the one odd step is there."""
    axis = Axis(0, 100_000, 150, 950)
    said = [("A", "B")[step % 2] for step in range(100_000)]
    said[50_001] = "ODD"
    text = strip(axis, list(map(float, range(100_000))), said, ("A", "B", "ODD"), 0, "mode")
    of = drawing(f"<svg>{text}</svg>")
    (odd,) = kinds(of, "ODD")
    assert round(begin(odd)) == 550
    assert end(odd) - begin(odd) == 1
    assert len(kinds(of, "piece")) <= 3 * 801


@given(st.floats(-1e6, 1e6), st.floats(0.01, 1e6))
def test_ticks_are_round_and_on_the_axis(low: float, length: float) -> None:
    """Between two and twenty of them, evenly spaced, none outside."""
    ticks = Axis(low, low + length, 150, 985).ticks
    assert 2 <= len(ticks) <= 20
    assert all(low - 1e-6 * length <= tick <= low + length * (1 + 1e-6) for tick in ticks)


def test_an_axis_of_one_place_has_a_length() -> None:
    """A vehicle that never moves can be drawn."""
    axis = across([5.0, 5.0])
    assert axis.low < 5 < axis.high


def test_numbers_are_written_shortly() -> None:
    """Without trailing zeros, zero without a sign, and with a real minus sign."""
    assert [number(value) for value in (0.0, -0.0, 2.50, -3.0, 1e-9)] == ["0", "0", "2.5", "\N{MINUS SIGN}3", "0"]


def test_a_legend_breaks_into_rows() -> None:
    """Entries that do not fit begin a new row; the next thing stands below all of them."""
    entries = [stroke_swatch("#000", "a rather long explanation of a line")] * 5
    text, below = legend(entries, 100)
    rows = {line.get("transform", "").split(" ")[1] for line in drawing(f"<svg>{text}</svg>").findall("g")}
    assert len(rows) == 2
    assert below == 100 + 19 + 22
