"""Every bound that the satellites' signal processing hands over holds what interval arithmetic says, over its inputs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction

import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st
from mpmath import iv

from safeloc.errors import InputError
from safeloc.sensing.satellite.channels import FARTHEST_MM, Channels
from safeloc.sensing.satellite.places import Vector
from safeloc.sensing.satellite.predicted import Predicted
from safeloc.sensing.satellite.residuals import Residuals
from safeloc.sensing.satellite.solution import FASTEST_M_PER_S, NEAREST_M, Bounds, Estimate, Look, solve
from safeloc.sensing.satellite.track_fit import Sight, fit
from safeloc.sensing.satellite.track_prediction import Portion, TrackState, on_portion
from safeloc.sensing.satellite.windows import Window
from tests.sensing.enclosure import FEWER, Ball, assert_encloses, ends, exact

LEAST_FLOAT = 5e-324
SHARES = st.floats(-1.0, 1.0)
NONE: frozenset[str] = frozenset()

# ------------------------------------------------------------------ differences


@FEWER
@given(st.one_of(st.floats(-1e6, 1e6), st.integers(-(10**6), 10**6).map(lambda mm: mm / 1_000)))
@example(0.001)
@example(-0.001)
@example(LEAST_FLOAT)
@example(-LEAST_FLOAT)
@example(0.0)
@example(math.nextafter(2.001, 3.0))
@example(1e6)
def test_differences_are_told_no_smaller_than_they_are(metres: float) -> None:
    """`Channels.hear`: whole mm and mm/s away from zero, less than one more."""
    heard = Channels(1, 2).hear(
        {"G01"}, {"G01"}, [Residuals({"G01": metres}, {"G01": metres / 64}, {}, NONE, NONE, 0.0)]
    )
    for told, real in (
        (heard.inputs["channel_1_range_off_mm"], metres),
        (heard.inputs["channel_1_speed_off_mm_s"], metres / 64),
    ):
        assert_encloses(abs(told) - 1, abs(told), exact(abs(real)) * 1_000)
        assert (told > 0, told < 0) == (real > 0, real < 0)


@pytest.mark.parametrize("wrong", [math.nan, math.inf, -math.inf, 1e300, math.nextafter(1e6, 2e6)], ids=str)
def test_differences_that_cannot_be_told_are_faults(wrong: float) -> None:
    """Not finite, or farther than is told: no input at all."""
    heard = Channels(1, 2).hear({"G01"}, {"G01"}, [Residuals({"G01": wrong}, {}, {}, NONE, NONE, 0.0)])
    assert "channel_1_range_off_mm" not in heard.inputs
    assert "G01" in [fault.channel for fault in heard.faults]


@FEWER
@given(
    st.lists(
        st.one_of(st.integers(-FARTHEST_MM, FARTHEST_MM), st.sampled_from([0, 1, FARTHEST_MM])), min_size=2, max_size=12
    )
)
def test_variances_enclose(values: list[int]) -> None:
    """`Window.add`: the mean square distance from the mean, rounded up, less than one more."""
    window = Window(len(values))
    told = [window.add(value) for value in values][-1]
    assert told is not None
    mean = exact(sum(values)) / len(values)
    assert_encloses(told - 1, told, sum((exact(one) - mean) ** 2 for one in values) / (len(values) - 1))


# ------------------------------------------------------------------ the fit

SIGHTS = st.lists(
    st.tuples(st.integers(-1_000_000, 1_000_000), st.integers(1, 100), st.integers(0, 10**9)), min_size=2, max_size=10
)


@FEWER
@given(SIGHTS, SHARES)
@example([(0, 1, 5_000), (1, 1, 5_000)], 1.0)
@example([(-1_000_000, 1, 5_000), (1_000_000, 100, 0), (999_999, 7, 10**9)], 1.0)
def test_protection_levels_enclose(sights: list[tuple[int, int, int]], share: float) -> None:
    """`TrackFit.protection_level`: the greatest error of a weighted line through errors at their bounds, less than 1 more."""
    slopes = [exact(Fraction(slope, 10**6)) for slope, _, _ in sights]
    weights, bounds = [one[1] for one in sights], [one[2] for one in sights]
    assume(len({one[0] for one in sights}) > 1)
    found = fit({f"G{n:02d}": Sight(0, s, Fraction(w)) for n, (s, w, _) in enumerate(sights, 1)})
    told = found.protection_level({f"G{n:02d}": bound for n, bound in enumerate(bounds, 1)})
    mean = sum(w * s for w, s in zip(weights, slopes, strict=True)) / sum(weights)
    spread = sum(w * (s - mean) ** 2 for w, s in zip(weights, slopes, strict=True))
    shares = [w * (s - mean) / spread for w, s in zip(weights, slopes, strict=True)]
    greatest = sum(abs(one) * bound for one, bound in zip(shares, bounds, strict=True))
    assert_encloses(told - 1, told, greatest)
    some = sum(exact(share) * one * bound for one, bound in zip(shares, bounds, strict=True))
    assert_encloses(-told, told, some)


# ------------------------------------------------------------------ the course of the track


def course(seed: Sequence[float], step_m: float) -> Portion:
    """Points near the Earth's surface, each a little off the straight line on."""
    points: list[Vector] = [(3_900_000.0, 600_000.0, 4_950_000.0)]
    heading = 0.3
    for turn in seed:
        heading += turn
        x, y, z = points[-1]
        points.append((x + step_m * math.cos(heading), y + step_m * math.sin(heading), z))
    return Portion(1_000.0, tuple(points))


TURNS = st.lists(st.one_of(st.floats(-0.1, 0.1), st.just(0.0)), min_size=4, max_size=8)


def second_derivative(portion: Portion, piece: int, share: float) -> Ball:
    """Of the cubic between two points, from the same ends and directions."""
    one, t = portion._pieces[piece], exact(share)
    h = exact(one.length_m)
    total = exact(0)
    for p, q, u, v in zip(one.start, one.end, one.start_along, one.end_along, strict=True):
        apart = (exact(q) - exact(p)) * 6 / h
        total += ((apart * (1 - 2 * t) - exact(u) * (4 - 6 * t) - exact(v) * (2 - 6 * t)) / h) ** 2
    return iv.sqrt(total)


@FEWER
@given(TURNS, st.floats(1.0, 200.0), st.floats(0.0, 1.0), st.integers(0, 7))
@example([0.0, 0.0, 0.0, 0.0], 15.0, 0.0, 1)
@example([0.1, 0.1, 0.1, 0.1], 1.0, 1.0, 1)
def test_no_bend_of_the_track_is_greater_than_told(turns: list[float], step_m: float, share: float, piece: int) -> None:
    """`Portion.bend_per_m`: the second derivative by distance, anywhere on the stretch."""
    portion = course(turns, step_m)
    piece %= len(turns)
    low, high = portion.distances_m[piece], math.nextafter(portion.distances_m[piece + 1], 0.0)
    told = portion.bend_per_m(low, high)
    assert_encloses(0.0, told, second_derivative(portion, piece, share))
    greatest = max(float(ends(second_derivative(portion, piece, at))[1]) for at in (0.0, 1.0))
    assert told <= greatest * (1 + 1e-9) + 1e-12


# ------------------------------------------------------------------ the whole solution


def away(place: Ball, sky: Sequence[Ball]) -> tuple[Ball, list[Ball]]:
    """Distance and direction from a place to a point in the sky."""
    apart = [a - b for a, b in zip(sky, place, strict=True)]
    far = iv.sqrt(sum(one * one for one in apart))
    return far, [one / far for one in apart]


DIRECTIONS = st.lists(
    st.tuples(st.floats(0.2, 1.4), st.floats(0.0, 6.2), st.floats(1.95e7, 2.9e7)), min_size=4, max_size=6, unique=True
)
REACHES = st.sampled_from([0.0, 1.0, 50.0, 300.0])


@FEWER
@given(TURNS, DIRECTIONS, REACHES, SHARES, SHARES, SHARES, st.floats(-60.0, 60.0))
@example(
    [0.1] * 6, [(0.2, 0.0, 1.95e7), (0.2, 3.1, 1.95e7), (0.5, 1.5, 2e7), (1.2, 5.0, 2e7)], 300.0, 1.0, 1.0, 1.0, 60.0
)
def test_solutions_enclose(
    turns: list[float],
    sky: list[tuple[float, float, float]],
    reach: float,
    off: float,
    faster: float,
    error: float,
    speed: float,
) -> None:
    """`Bounds.on_track`, `solve`: errors at their bounds, an estimate off by its margins, on a bent track near the Earth."""
    portion = course(turns, 200.0)
    middle = (portion.start_m + portion.end_m) / 2
    estimate = Estimate(reach, speed, 2.0)
    there_m = middle + off * reach
    (here,), (there,) = (on_portion(TrackState(at, 0.0, 0.0), [portion]) for at in (middle, there_m))
    real = exact(speed) + exact(faster) * 2
    predictions: dict[str, Predicted] = {}
    range_off: dict[str, int] = {}
    rate_off: dict[str, int] = {}
    for number, (up, around, far) in enumerate(sky, 1):
        name, at = f"G{number:02d}", placed(here.point_m, up, around, far)
        moving = [exact(FASTEST_M_PER_S / 2) * one for one in (0.6, 0.0, 0.8)]
        predicted, seen = away([exact(a) for a in here.point_m], at)
        measured, sight = away([exact(a) for a in there.point_m], at)
        rate = dot(seen, moving) - exact(speed) * dot(seen, [exact(a) for a in here.along])
        drawn = dot(sight, moving) - real * dot(sight, [exact(a) for a in there.along])
        sign = (-1) ** number
        range_off[name] = told((measured - predicted + exact(error) * 5 * sign) * 1_000)
        rate_off[name] = told((drawn - rate + exact(error) * exact(0.8) * sign) * 1_000)
        direction = (as_float(seen[0]), as_float(seen[1]), as_float(seen[2]))
        predictions[name] = Predicted(as_float(predicted), as_float(rate), direction, up)
    bounds = Bounds(5_000, 800).on_track(estimate, portion, middle)
    assert bounds.range_mm is not None
    assert bounds.speed_mm_s is not None
    try:
        found = solve([Look(here, bounds, range_off, rate_off, predictions)], frozenset(predictions))
    except InputError:  # satellites that stand alike
        return
    place, gained = found.off_mm(), found.speed_off_mm_s()
    assert place is not None
    assert gained is not None
    assert_encloses(place.low, place.high, (exact(there_m) - exact(middle)) * 1_000)
    assert_encloses(gained.low, gained.high, (real - exact(speed)) * 1_000)


def placed(point: Vector, up: float, around: float, far: float) -> list[Ball]:
    """A point in the sky, no nearer than a satellite."""
    level = far * math.cos(up)
    return [
        exact(a) + exact(b)
        for a, b in zip(point, (level * math.cos(around), level * math.sin(around), far * math.sin(up)), strict=True)
    ]


def dot(a: Sequence[Ball], b: Sequence[Ball]) -> Ball:
    """Their product."""
    return sum(x * y for x, y in zip(a, b, strict=True))


def as_float(one: Ball) -> float:
    """A thin interval as the nearest float."""
    return float(sum(ends(one)) / 2)


def told(mm: Ball) -> int:
    """Away from zero."""
    low, high = ends(mm)
    return math.ceil(high) if high > 0 else math.floor(low)


@FEWER
@given(st.sampled_from([0.0, 1.0, 37.5, 1_000.0, 5_000.0]), st.floats(0.0, 100.0), st.floats(-60.0, 60.0))
def test_linearising_costs_enclose(reach: float, margin: float, speed: float) -> None:
    """`Bounds.on_track`: half the bend and the sight's turn over the reach squared, the slopes' last digit; 4 mm more at most."""
    portion = Portion(0.0, ((0.0, 0.0, 0.0), (6_000.0, 0.0, 0.0), (12_000.0, 90.0, 0.0)))
    found = Bounds(0, 0).on_track(Estimate(reach, speed, margin), portion, 6_000.0)
    assert found.range_mm is not None
    assert found.speed_mm_s is not None
    bend, far = exact(portion.bend_per_m(6_000.0 - reach, 6_000.0 + reach)), exact(NEAREST_M)
    curve = (bend / 2 + 1 / (2 * far)) * exact(reach) ** 2 * 1_000
    slopes = exact(reach) * 1_000 / 2_000_000
    assert_encloses(0, found.range_mm, curve + slopes + 1)
    assert found.range_mm <= ends(curve + slopes)[1] + 4
    turn = ((exact(abs(speed)) + exact(margin)) * bend + exact(FASTEST_M_PER_S) / far) * exact(reach) * 1_000
    assert_encloses(0, found.speed_mm_s, turn + exact(margin) / 2_000 + 1)
    assert found.speed_mm_s <= ends(turn)[1] + 4


@pytest.mark.parametrize("wrong", [math.nan, math.inf], ids=str)
def test_margins_that_are_not_finite_bound_nothing(wrong: float) -> None:
    """Refused, in place and in speed."""
    portion = Portion(0.0, ((0.0, 0.0, 0.0), (400.0, 0.0, 0.0)))
    for estimate in (Estimate(wrong, 1.0, 1.0), Estimate(1.0, wrong, 1.0), Estimate(1.0, 1.0, wrong)):
        with pytest.raises(InputError, match=rf"^a measured figure is {wrong}; remove figures that are not finite"):
            Bounds(5_000, 800).on_track(estimate, portion, 200.0)
