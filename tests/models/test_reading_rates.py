"""Odometers with different rates for over- and under-reading: corrected distances keep the symmetric law."""

from __future__ import annotations

import re
from fractions import Fraction

import pytest
from hypothesis import example as drawn
from hypothesis import given
from hypothesis import strategies as st

from safeloc.language.units import PPM_PER_ONE
from safeloc.models.vocabulary.error_law import ErrorLaw
from safeloc.models.vocabulary.reading_rates import ReadingRates
from tests.runtime.embedding.test_shown import DOCS, example

WHEEL = ErrorLaw(kind="wheel", constant_mm=0, rate_ppm=0, floor_mm_s=7)
PERIOD_MS = 100
RATES = st.builds(ReadingRates, under_ppm=st.integers(0, 200_000), over_ppm=st.integers(0, 200_000))
CYCLES = st.lists(st.tuples(st.integers(-4_000, 4_000), st.fractions(0, 1, max_denominator=1_000)), max_size=60)
"""Measured distances, and where in its bounds the true run lies: 0 as over-read as may be, 1 as under-read."""


@given(RATES, CYCLES)
@drawn(ReadingRates(under_ppm=100_000, over_ppm=0), [(1, Fraction(1))] * 60)
@drawn(ReadingRates(under_ppm=0, over_ppm=100_000), [(3, Fraction(0)), (-2, Fraction(1))] * 30)
def test_corrected_distances_keep_the_symmetric_law(rates: ReadingRates, cycles: list[tuple[int, Fraction]]) -> None:
    """In exact numbers: between any two cycles the error is within rate, floor and, once, the constant."""
    law, correction = rates.law(WHEEL, PERIOD_MS), rates.correction()
    floor_mm = Fraction((law.floor_mm_s - WHEEL.floor_mm_s) * PERIOD_MS, 1_000)
    low = high = Fraction(0)  # of the sum of errors less what rate and floor allow: above and below
    for measured, share in cycles:
        under, over = (Fraction(ppm, PPM_PER_ONE) * abs(measured) for ppm in (rates.under_ppm, rates.over_ppm))
        farther = share * (under + over) - over
        true = measured + (farther if measured >= 0 else -farther)
        corrected = correction.distance_mm(measured)
        allowed = Fraction(law.rate_ppm, PPM_PER_ONE) * abs(corrected) + floor_mm
        high, low = (
            max(Fraction(0), high + true - corrected - allowed),
            min(Fraction(0), low + true - corrected + allowed),
        )
        assert high <= law.constant_mm and low >= -law.constant_mm


def test_both_figures_cost_less_than_the_greater_one_twice() -> None:
    """10 % under-reading and 2 % over-reading: 5.77 % to either side of 1.04 of the distance, not 10 %."""
    rates = ReadingRates(under_ppm=100_000, over_ppm=20_000)
    law = rates.law(WHEEL, PERIOD_MS)
    assert (57_693, 1, 8) == (law.rate_ppm, law.constant_mm, law.floor_mm_s)
    correction = rates.correction()
    assert [1_040, -1_040, 1] == [correction.distance_mm(measured) for measured in (1_000, -1_000, 1)]


def test_equal_rates_change_nothing_but_the_rounding_that_they_do_not_need() -> None:
    """The distances stay as they are; over thousands of cycles no rounding adds up."""
    equal, uneven = ReadingRates().correction(), ReadingRates(under_ppm=1, over_ppm=0).correction()
    assert list(range(-50, 50)) == [equal.distance_mm(measured) for measured in range(-50, 50)]
    assert abs(sum(uneven.distance_mm(1_000) for _ in range(4_000)) - 4_000_002) <= 1


def test_the_page_tells_what_its_code_prints(capsys: pytest.CaptureFixture[str]) -> None:
    """docs/howto/odometer.md, line by line."""
    text = (DOCS / "howto" / "odometer.md").read_text(encoding="utf-8")
    (code,) = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    exec(compile(code, "odometer.md", "exec"), {})
    assert capsys.readouterr().out.splitlines() == ["57693 5001 1", "[1914, 1913, 1914]"]
    assert all(printed in code for printed in ("57693 5001 1", "[1914, 1913, 1914]"))


def test_the_example_holds_the_truth_in_a_narrower_interval() -> None:
    """Of the same journey, with both rates and with the greater one; the page has the widths."""
    journey = example("uneven_odometer").journey
    widths = []
    for corrected in (True, False):
        run = list(journey(corrected=corrected))
        assert all(told is not None and told.holds(truth_mm) for truth_mm, told in run)
        widths.append(max(told.high_mm - told.low_mm for _, told in run))
    assert [33_129, 44_195] == widths
    text = (DOCS / "howto" / "odometer.md").read_text(encoding="utf-8")
    assert "33.1 m wide" in text and "gives 44.2 m" in text
