"""Time of flight: half of time times speed, and what the source prints cannot be meant."""

from __future__ import annotations

from fractions import Fraction

import pytest

from safeloc.errors import InputError
from safeloc.language.units import MM, MM_S, ONE, S, Unit
from safeloc.sensing.fibre.time_of_flight import bounds_mm, distance_mm, most_pulses_hz, speed_mm_s, time_ps
from safeloc.sensing.rounding import ExactBounds

INDEX_PPM = 1_468_000
T2_PS = 100_000_000


def test_a_hundred_microseconds_are_ten_kilometres() -> None:
    """T2 = 100 us gives 10 210.9 m at n = 1.468."""
    assert 10_210_915 == round(distance_mm(T2_PS, INDEX_PPM))
    assert 204_218_296 == round(speed_mm_s(INDEX_PPM) / 1_000)


def test_the_printed_formula_is_no_distance() -> None:
    """Ls = 1/2 T2 / V has the unit s2/m and a value of 2.4e-13; 1/2 T2 V is a length."""
    per_speed = Unit("s/mm", length=-1, time=1, scale=Fraction(1_000))
    assert per_speed.times(MM_S).same(ONE)
    assert (-1, 2, 0) == S.times(per_speed).dimension
    assert S.times(MM_S).same(MM)
    printed = Fraction(1, 2) * Fraction(T2_PS, 10**12) / (speed_mm_s(INDEX_PPM) / 1_000)
    assert 2.4e-13 == pytest.approx(float(printed), rel=0.03)


def test_time_and_distance_undo_each_other() -> None:
    """Exactly: they are fractions."""
    assert Fraction(40_000_000) == distance_mm(time_ps(40_000_000, INDEX_PPM), INDEX_PPM)


@pytest.mark.parametrize("off", [-100, -37, 0, 100])
def test_bounds_hold_the_truth_for_every_index_in_its_error(off: int) -> None:
    """The fibre's real index is anywhere within the stated error."""
    real = Fraction(INDEX_PPM) * (1 + Fraction(off, 1_000_000))
    truth = 30_000_000
    taken = Fraction(truth) * 2 * 10**12 * real / (299_792_458_000 * 1_000_000)
    found = bounds_mm(ExactBounds(taken - 5, taken + 5), INDEX_PPM, 100)
    assert found.low <= truth <= found.high
    assert found.high - found.low < 7_000


def test_the_pulse_rate_ends_where_two_pulses_would_be_in_the_fibre() -> None:
    """V / 2L: 2552.7 Hz for 40 km, 10 211 Hz for 10 km."""
    assert 2_552.7 == pytest.approx(float(most_pulses_hz(40_000_000, INDEX_PPM)), abs=0.05)
    assert 10_211 == round(most_pulses_hz(10_000_000, INDEX_PPM))


def test_impossible_figures_are_refused() -> None:
    """A pattern before its pulse, and light faster than in vacuum."""
    with pytest.raises(InputError, match=r"^a pattern cannot come 3 ps before its pulse\.$"):
        distance_mm(-3, INDEX_PPM)
    with pytest.raises(InputError, match="not above that of vacuum"):
        speed_mm_s(1_000_000)
