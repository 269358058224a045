"""A cycle's solution holds the truth while every error is within its bound, wherever on a bent track the train is."""

from __future__ import annotations

import math
import random
from collections.abc import Mapping
from fractions import Fraction

import pytest

from safeloc.errors import InputError
from safeloc.sensing.rounding import ExactBounds
from safeloc.sensing.satellite.places import Vector
from safeloc.sensing.satellite.predicted import Predicted
from safeloc.sensing.satellite.solution import Bounds, Estimate, Look, Solution, solve
from safeloc.sensing.satellite.track_fit import NoSolution
from safeloc.sensing.satellite.track_prediction import OnTrack, Portion, TrackState, on_portion

RADIUS_M, FAR_M = 400.0, 2.2e7
THRESHOLD = Bounds(5_000, 800)
NAMES = tuple(f"{system}{number:02d}" for system in "GE" for number in range(1, 6))


def curve() -> Portion:
    """A curve of 400 m radius."""
    angles = [n * 15 / RADIUS_M for n in range(30)]
    points = tuple((RADIUS_M * math.sin(angle), RADIUS_M * (1 - math.cos(angle)), 0.0) for angle in angles)
    return Portion(0.0, points, (15.0,) * 29)


def satellites(seed: int) -> dict[str, Vector]:
    """Ten places far away, all above."""
    draw = random.Random(seed)

    def one() -> Vector:
        around, up = draw.uniform(0, 2 * math.pi), draw.uniform(0.2, 1.3)
        across = FAR_M * math.cos(up)
        return across * math.cos(around), across * math.sin(around), FAR_M * math.sin(up)

    return {name: one() for name in NAMES}


def seen(place: OnTrack, sky: Mapping[str, Vector]) -> dict[str, Predicted]:
    """Range and rate from a place under way, satellites standing."""
    found = {}
    for name, point in sky.items():
        way = math.dist(point, place.point_m)
        x, y, z = ((a - b) / way for a, b in zip(point, place.point_m, strict=True))
        rate = -sum(a * b for a, b in zip((x, y, z), place.velocity_m_per_s, strict=True))
        found[name] = Predicted(way, rate, (x, y, z), math.asin(z))
    return found


def looked(estimate: TrackState, truth: TrackState, seed: int, margin_m: float, speed_margin: float) -> Look:
    """Measured at the truth with errors at their bounds, predicted at the estimate."""
    draw, sky, track = random.Random(seed), satellites(seed), curve()
    (there,), (here,) = on_portion(truth, [track]), on_portion(estimate, [track])
    predicted, measured = seen(here, sky), seen(there, sky)
    clocks = {"G": 300.0, "E": -20.0}

    def off(name: str, true: float, expected: float, bound_mm: int) -> int:
        error = draw.choice((-1, 1)) * bound_mm / 1_000
        return math.floor((true - expected + clocks[name[0]] + error) * 1_000)

    codes = {n: off(n, measured[n].pseudorange_m, predicted[n].pseudorange_m, 5_000) for n in NAMES}
    rates = {n: off(n, measured[n].rate_m_per_s, predicted[n].rate_m_per_s, 800) for n in NAMES}
    around = Estimate(margin_m, estimate.speed_m_per_s, speed_margin)
    return Look(here, THRESHOLD.on_track(around, track, estimate.distance_m), codes, rates, predicted)


@pytest.mark.parametrize("free", [False, True])
@pytest.mark.parametrize("weighting", ["equal", "elevation"])
@pytest.mark.parametrize("seed", range(12))
def test_the_truth_is_inside(seed: int, weighting: str, free: bool) -> None:
    """Errors at their bounds, estimates off by whole margins in a curve: place and speed are within the solved intervals."""
    draw = random.Random(1_000 + seed)
    margin_m, speed_margin = draw.choice(((1.0, 0.5), (25.0, 3.0)))
    estimate = TrackState(200.0, 20.0, 0.0)
    truth = TrackState(200.0 + draw.uniform(-1, 1) * margin_m, 20.0 + draw.uniform(-1, 1) * speed_margin, 0.0)
    look = looked(estimate, truth, seed, margin_m, speed_margin)
    found = solve([look], frozenset(NAMES), free=free, weighting="equal" if weighting == "equal" else "elevation")
    assert _holds(found.off_mm(), (truth.distance_m - 200) * 1_000)
    assert _holds(found.speed_off_mm_s(), (truth.speed_m_per_s - 20) * 1_000)
    assert (5 if free else 3) == found.unknowns


def _holds(interval: ExactBounds | None, value: float) -> bool:
    assert interval is not None
    return float(interval.low) <= value <= float(interval.high)


def test_the_bend_costs_what_it_must() -> None:
    """On a straight track nothing but rounding is added; in a curve the way off the tangent within the margin."""
    straight = Portion(0.0, ((0.0, 0.0, 0.0), (400.0, 0.0, 0.0)))
    estimate = Estimate(20.0, 20.0, 1.0)
    assert Bounds(5_003, 808) == THRESHOLD.on_track(estimate, straight, 200.0)
    bent = THRESHOLD.on_track(estimate, curve(), 200.0)
    assert bent.range_mm is not None and 5_500 <= bent.range_mm < 5_530
    assert bent.speed_mm_s is not None and 1_850 <= bent.speed_mm_s < 1_930


def test_the_hull_of_two_portions() -> None:
    """What either says; where one of them has no solution for the speed, there is none."""
    looks = [looked(TrackState(200.0, 20.0, 0.0), TrackState(at, 20.0, 0.0), 1, 5.0, 1.0) for at in (199.0, 203.0)]
    both, alone = solve(looks, frozenset(NAMES)), [solve([one], frozenset(NAMES)) for one in looks]
    ends = [one.off_mm() for one in alone]
    assert both.off_mm() == ExactBounds(min(_low(one) for one in ends), max(_high(one) for one in ends))
    placeless = Solution(
        (both.solved[0], type(both.solved[1])(Bounds(None, 800), None, both.solved[1].speed)), both.used
    )
    assert placeless.off_mm() is None


def test_the_dilution_is_that_of_the_worse_portion() -> None:
    """Of place and speed; what is not solved moves nothing."""
    looks = [looked(TrackState(at, 20.0, 0.0), TrackState(200.0, 20.0, 0.0), 1, 5.0, 1.0) for at in (150.0, 250.0)]
    both, alone = solve(looks, frozenset(NAMES)), [solve([one], frozenset(NAMES)) for one in looks]
    assert both.dilution() == max(one.dilution() for one in alone) > min(one.dilution() for one in alone) >= 1
    assert both.speed_dilution() == max(one.speed_dilution() for one in alone)
    assert both.solved[0].speed is not None
    placeless = Solution((type(both.solved[0])(Bounds(None, 800), None, both.solved[0].speed),), both.used)
    assert placeless.dilution() == 0
    assert placeless.speed_dilution() == both.solved[0].speed.dilution > 0


def _low(interval: ExactBounds | None) -> Fraction:
    assert interval is not None
    return Fraction(interval.low)


def _high(interval: ExactBounds | None) -> Fraction:
    assert interval is not None
    return Fraction(interval.high)


def test_what_cannot_be_solved_says_why() -> None:
    """Too few for the clocks; all satellites in one place."""
    look = looked(TrackState(200.0, 20.0, 0.0), TrackState(200.0, 20.0, 0.0), 1, 5.0, 1.0)
    with pytest.raises(NoSolution) as few:
        solve([look], frozenset(("G01", "E01")))
    assert "FEW_LEFT" == few.value.why
    one = look.predictions["G01"]
    alike = Look(look.place, look.bounds, look.off_mm, look.speed_off_mm_s, dict.fromkeys(NAMES, one))
    with pytest.raises(NoSolution, match="cannot be separated") as same:
        solve([alike], frozenset(("G01", "G02", "G03")))
    assert "ALIKE" == same.value.why
    still = Look(
        OnTrack((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
        *(getattr(look, n) for n in ("bounds", "off_mm", "speed_off_mm_s", "predictions")),
    )
    with pytest.raises(InputError, match="no direction"):
        solve([still], frozenset(NAMES), free=True)
