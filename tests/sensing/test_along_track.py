"""Distance along the track holds the truth on every track that is not too sharply curved, at any age."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.errors import InputError
from safeloc.sensing.along_track import Delay, along_track, distance_now, lateral
from safeloc.sensing.echoes import Echo
from safeloc.sensing.figures import Installation, RadarConfig
from safeloc.sensing.rounding import ExactBounds
from safeloc.sensing.signature import Model
from safeloc.simulation.radar_track import Arc, pose, seen_from
from tests.sensing.scenes import CONFIG

TIGHT = Installation(least_radius_mm=300_000)
NO_DELAY = Delay(0, 0, 0, 0)
BENDS = st.lists(st.tuples(st.floats(1_000, 60_000), st.sampled_from([-1, 0, 1])), min_size=1, max_size=6)


def echo(range_mm: int, error_mm: int = 0, sine_ppm: int = 0, sine_error_ppm: int = 0) -> Echo:
    """An echo of a reflector."""
    return Echo(Model.A, None, range_mm, error_mm, sine_ppm, sine_error_ppm, 5_000, 2_000)


@given(BENDS, st.floats(4_000, 150_000), st.floats(-100, 100), st.floats(-500, 500), st.sampled_from([-1, 1]))
def test_every_track_is_held(
    bends: list[tuple[float, int]], along_mm: float, off: float, height: float, side: int
) -> None:
    """Straights and curves of the sharpest radius, in any order, and any place that the installation rule admits."""
    track = [Arc(length, turn * TIGHT.least_radius_mm) for length, turn in bends]
    x, y = pose(track, along_mm).aside(side * (TIGHT.offset_mm + off))
    slant = math.sqrt(x * x + y * y + height * height)
    held = along_track(ExactBounds(Fraction(slant), Fraction(slant)), TIGHT)
    assert held.low <= along_mm <= held.high


def test_on_a_straight_the_bounds_are_tight() -> None:
    """A reflector 50 m ahead, 3 m aside, curves of 3 km at most: 90 mm wide; with turnouts ten times as much; and where
    neither curve nor tolerance has to be reckoned with, 2 mm."""
    slant = ExactBounds(Fraction(math.hypot(50_000, 3_000)), Fraction(math.hypot(50_000, 3_000)))
    wide, turnout = along_track(slant, Installation(least_radius_mm=3_000_000)), along_track(slant, CONFIG.installation)
    assert 60 < wide.high - wide.low < 90
    assert 600 < turnout.high - turnout.low < 1_000
    exact = Installation(offset_error_mm=0, height_difference_mm=0, least_radius_mm=10_000_000_000)
    assert along_track(slant, exact).high - along_track(slant, exact).low <= 2


def test_nearer_than_the_offset_nothing_is_claimed() -> None:
    """A range shorter than the reflector stands aside: from abreast on."""
    assert along_track(ExactBounds(0, 2_000), CONFIG.installation).low == 0


def test_a_view_around_a_curve_is_refused() -> None:
    """Where the range is longer than the radius, the bounds say nothing; the configuration is refused as well."""
    with pytest.raises(InputError, match=r"^a reflector 899\d{3} mm away is not in view on a radius of 300000 mm;"):
        along_track(ExactBounds(900_000, 900_000), TIGHT)
    with pytest.raises(ValueError, match="a view of 153450 mm reaches around a curve of 150000 mm"):
        RadarConfig(installation=Installation(least_radius_mm=150_000))


@given(st.integers(-40_000, 40_000), st.integers(0, 400), st.floats(20_000, 140_000), st.integers(0, 3_000))
def test_age_is_compensated(speed: int, age_ms: int, ahead_mm: float, unsure: int) -> None:
    """The truth now is held when the speed was within its bounds; Doppler's shift is undone."""
    lead_s = float(CONFIG.sensor.lead_us) / 1e6
    measured = math.floor(math.hypot(ahead_mm - speed * lead_s, 3_000))
    delay = Delay(age_ms, age_ms, speed - unsure, speed + unsure)
    held = distance_now(echo(measured, 2), CONFIG, delay)
    assert held.low <= ahead_mm - speed * age_ms / 1_000 <= held.high


def test_age_adds_error_where_the_speed_is_not_known() -> None:
    """30 m/s either way and 100 ms: 3 m on either side, and 0.23 m for Doppler's shift."""
    known = distance_now(echo(50_000), CONFIG, Delay(100, 100, 0, 0))
    added = distance_now(echo(50_000), CONFIG, Delay(100, 100, -30_000, 30_000))
    assert float(added.high - known.high) == pytest.approx(3_231, abs=5)
    assert float(known.low - added.low) == pytest.approx(3_231, abs=5)


def test_a_reflector_may_have_been_passed() -> None:
    """Bounds below zero are left as they are."""
    assert distance_now(echo(5_000), CONFIG, Delay(1_000, 1_000, 10_000, 10_000)).high < 0


@pytest.mark.parametrize("wrong", [(-1, 0, 0, 0), (2, 1, 0, 0), (0, 0, 1, 0)], ids=str)
def test_a_delay_the_wrong_way_round_is_refused(wrong: tuple[int, int, int, int]) -> None:
    """Ages and speeds come in order, and nothing is measured in the future."""
    with pytest.raises(InputError, match=r"needs 0 <= least_ms <= most_ms and least_mm_s <= most_mm_s\.$"):
        Delay(*wrong)


@pytest.mark.parametrize("wrong", [1.0, True, float("nan"), None], ids=str)
def test_figures_of_a_delay_are_whole(wrong: object) -> None:
    """Nothing else is taken for a number, NaN least of all."""
    with pytest.raises(InputError, match=r": ages and speeds are whole ms and mm/s\.$"):
        Delay(0, 0, 0, wrong)  # type: ignore[arg-type]


def test_times_in_whole_ms_add_a_rounding_error() -> None:
    """Half a ms at either end; an age is never below 0, and never from after now."""
    assert Delay.since(1_000, 1_050, -5, 5) == Delay(49, 51, -5, 5)
    assert Delay.since(1_000, 1_000, 0, 0) == Delay(0, 1, 0, 0)
    with pytest.raises(InputError, match="needs 0 <= least_ms <= most_ms"):
        Delay.since(1_050, 1_000, 0, 0)


def test_lateral_is_range_times_sine() -> None:
    """On the left positive; with both errors."""
    held = lateral(echo(100_000, 50, 30_000, 1_000), CONFIG, NO_DELAY)
    assert held.low <= 2_899
    assert 3_101 <= held.high
    assert float(held.low) == pytest.approx(99_950 * 0.029, abs=1)
    assert float(held.high) == pytest.approx(100_050 * 0.031, abs=1)


def test_tracks_go_where_arcs_say() -> None:
    """A quarter of a circle to the left ends one radius ahead and one to the left; then the track goes on straight."""
    quarter = [Arc(math.pi / 2 * 200_000, 200_000)]
    end, beyond = pose(quarter, math.pi / 2 * 200_000), pose(quarter, math.pi / 2 * 200_000 + 1_000)
    assert (end.x, end.y, end.heading) == pytest.approx((200_000, 200_000, math.pi / 2))
    assert (beyond.x, beyond.y) == pytest.approx((200_000, 201_000))
    with pytest.raises(InputError, match=r"^-1 mm lies before the beginning of the track\.$"):
        pose(quarter, -1)


def test_what_is_behind_is_not_seen() -> None:
    """Range NaN; ahead, range by Pythagoras and the sine to the left."""
    ranges, sines = seen_from(pose([], 10_000), np.array([[0.0, 0.0, 0.0], [14_000.0, 3_000.0, 0.0]]))
    assert math.isnan(ranges[0])
    assert (ranges[1], sines[1]) == pytest.approx((5_000, 0.6))
