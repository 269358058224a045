"""A solution as the position machine's inputs: dilutions, and what comes beside, rounded outward."""

from __future__ import annotations

from fractions import Fraction

import pytest

from safeloc.models.satellite.ahead import Ahead
from safeloc.models.satellite.fix_inputs import fix_inputs, no_fix
from safeloc.models.satellite.variables import SatelliteConfig
from safeloc.sensing.satellite.solution import Bounds, Solution, Solved
from safeloc.sensing.satellite.track_fit import TrackFit

FAST = 44_445_000
AHEAD = Ahead(0, -1_000_000_000, 1_000_000_000, 40_000_000, 39_000_000, 41_000_000, (0, 0), 1_500)


def speed_of(faster_mm_s: int, share: Fraction = Fraction(3, 4)) -> Solution:
    """A solution of the speed alone, so much above the predicted 40 m/s, from two satellites on either side."""
    shares = {"G01": share, "G02": -share}
    found = TrackFit(Fraction(faster_mm_s), {"G": Fraction(0)}, shares, Fraction(0), 0)
    return Solution((Solved(Bounds(None, 0), None, found),), frozenset(shares))


def test_what_is_solved_has_a_dilution_and_what_is_not_has_none() -> None:
    """The speed's is 1.5; the place is anywhere within the predicted bounds, whatever signals are wrong by."""
    told = fix_inputs(speed_of(1_000), AHEAD, 0.0, SatelliteConfig())
    assert (0, 0, 1_000) == tuple(told[f"position.fix_{name}"] for name in ("mm", "dilution_permille", "further_mm"))
    names = ("speed_um_s", "speed_dilution_permille", "speed_further_um_s")
    assert (41_000_000, 1_500, 0) == tuple(told[f"position.fix_{name}"] for name in names)


def test_a_dilution_is_rounded_up() -> None:
    """2/3 of a thousandth more is one more."""
    told = fix_inputs(speed_of(0, Fraction(1, 3)), AHEAD, 0.0, SatelliteConfig())
    assert 667 == told["position.fix_speed_dilution_permille"]


def test_a_speed_that_no_vehicle_has_is_the_nearest_one_and_as_far_off() -> None:
    """50 m/s of a vehicle that runs 44.445 at most: 5.555 m/s come to the error, so that the interval still holds 50."""
    told = fix_inputs(speed_of(10_000), AHEAD, 0.0, SatelliteConfig())
    assert (FAST, 50_000_000 - FAST) == (told["position.fix_speed_um_s"], told["position.fix_speed_further_um_s"])


@pytest.mark.parametrize(
    "solution",
    [speed_of(94_000), speed_of(-174_000), speed_of(0, Fraction(10_001, 1_000))],
    ids=["fast", "back", "dilution"],
)
def test_what_the_inputs_cannot_hold_is_no_solution(solution: Solution) -> None:
    """A speed beyond twice the greatest of a vehicle's, either way; a dilution above 20."""
    assert no_fix("OUT_OF_RANGE") == fix_inputs(solution, AHEAD, 0.0, SatelliteConfig())
