"""Every bound that the fibre front end hands over holds what interval arithmetic says, over the range of its inputs."""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from mpmath import iv

from safeloc.errors import InputError
from safeloc.sensing.fibre.features import Bounds
from safeloc.sensing.fibre.fibre_map import FibreMap
from safeloc.sensing.fibre.figures import Detection, FibreConfig, Interrogator
from safeloc.sensing.fibre.measures import end, length, speed
from safeloc.sensing.fibre.sections import Change, Edge, Effect
from safeloc.sensing.fibre.signals import Signaller
from safeloc.sensing.fibre.time_of_flight import bounds_mm
from safeloc.sensing.fibre.tracks import Fit
from safeloc.sensing.figures import LIGHT_MM_S
from safeloc.sensing.rounding import ExactBounds
from tests.sensing.enclosure import FEWER, Ball, around, assert_encloses, ends, exact, span

LEAST_FLOAT = 5e-324
SHARES = st.floats(-1.0, 1.0)
PLACES = st.one_of(st.floats(0.0, 2e8), st.sampled_from([0.0, LEAST_FLOAT, 0.1, 2e8, math.nextafter(40e6, 0.0)]))
OFFS = st.one_of(st.floats(0.0, 2e6), st.sampled_from([0.0, LEAST_FLOAT, 0.1, 0.2, 0.3]))
MAPS = [
    FibreMap(((0, 0), (200_000_000, 200_000_000)), 0),
    FibreMap(((100, 7), (1_000_000, 960_001), (1_000_050, 960_001), (40_000_000, 39_000_000))),
]
INTERROGATORS = st.builds(
    Interrogator,
    index_ppm=st.sampled_from([1_000_001, 1_468_000, 3_000_000]),
    index_error_ppm=st.sampled_from([0, 1, 100, 10_000]),
    trigger_error_ps=st.sampled_from([0, 20_000, 10_000_000]),
    pulse_hz=st.just(1_000),
)
DETECTIONS = st.builds(
    Detection,
    end_error_mm=st.sampled_from([0, 35_000, 1_000_000]),
    length_error_mm=st.sampled_from([0, 1, 40_000]),
    speed_error_mm_s=st.sampled_from([0, 1_500, 50_000]),
    overhang_mm=st.sampled_from([0, 4_500]),
    most_change_mm_s2=st.sampled_from([100, 1_501, 5_000]),
)
CONFIGS = st.builds(FibreConfig, interrogator=INTERROGATORS, detection=DETECTIONS)


def fit(low: float = 0.0, high: float = 0.0, **figures: float) -> Fit:
    """A course; what is not named is 0."""
    zero = Fit(low, high, 0.0, 0.0, 0.0, 0.0, 0.0)
    return replace(zero, **figures)


def index_of(config: FibreConfig, share: float) -> Ball:
    """The real index, as a part of the stated one."""
    return 1 + exact(share) * config.interrogator.index_error_ppm / 1_000_000


def on_path(where: FibreMap, fibre: Fraction) -> Ball:
    """Linear between surveyed points, and on beyond the outermost ones."""
    inner = [point for point in where.points[1:-1] if point[0] <= fibre]
    first = where.points.index(inner[-1]) if inner else 0
    (f0, p0), (f1, p1) = where.points[first], where.points[first + 1]
    return p0 + (exact(fibre) - f0) * (p1 - p0) / (f1 - f0)


# ------------------------------------------------------------------ time of flight


@FEWER
@given(
    st.fractions(0, 10**10), st.fractions(0, 10**6), st.integers(1_000_001, 3_000_000), st.integers(0, 10_000), SHARES
)
@example(Fraction(LEAST_FLOAT), Fraction(0), 1_468_000, 10_000, -1.0)
def test_times_of_flight_enclose(
    time_ps: Fraction, late_ps: Fraction, index: int, error_ppm: int, share: float
) -> None:
    """`bounds_mm`: T c / 2n for every time and every index within their errors, and exactly these ends."""
    found = bounds_mm(ExactBounds(time_ps, time_ps + late_ps), index, error_ppm)
    time, error = span(exact(time_ps), exact(time_ps + late_ps)), exact(Fraction(error_ppm, 1_000_000))
    real = exact(Fraction(index, 1_000_000))
    anywhere = time * LIGHT_MM_S / (2 * 10**12 * real)
    assert_encloses(found.low, found.high, anywhere / (1 + error * exact(share)))
    widest = anywhere / span(1 - error, 1 + error)
    assert_encloses(found.low, found.high, widest)
    low, high = ends(widest)
    assert found.high - found.low <= (high - low) * (1 + Fraction(1, 2**100)) + Fraction(1, 2**100)


# ------------------------------------------------------------------ ends


@FEWER
@given(CONFIGS, st.sampled_from(MAPS), PLACES, OFFS, st.sampled_from([-1, 1]), SHARES, SHARES, SHARES, SHARES)
@example(FibreConfig(), MAPS[1], 0.0, 0.0, -1, -1.0, -1.0, -1.0, 1.0)
def test_ends_of_a_train_enclose(
    config: FibreConfig, where: FibreMap, place: float, off: float, outward: int,
    axle: float, index: float, trigger: float, map_: float,
) -> None:  # fmt: skip
    """`end`: error of the axle, overhang, trigger, index and map, each anywhere within what is stated of it."""
    found = end(place, off, outward, config, where, None)
    detection, inter = config.detection, config.interrogator
    scatter = max(Fraction(0), Fraction(off) - Fraction(detection.end_error_mm, 2))
    measured = exact(place) + exact(axle) * (detection.end_error_mm + exact(scatter))
    vehicle = (
        span(measured, measured + detection.overhang_mm)
        if outward > 0
        else span(measured - detection.overhang_mm, measured)
    )
    vehicle = span(exact(max(ends(vehicle)[0], Fraction(0))), exact(max(ends(vehicle)[1], Fraction(0))))
    flight = vehicle * 2 * 10**12 * inter.index_ppm / (exact(LIGHT_MM_S) * 1_000_000)
    flight = flight + exact(trigger) * inter.trigger_error_ps
    flight = span(exact(max(ends(flight)[0], Fraction(0))), exact(max(ends(flight)[1], Fraction(0))))
    assert_encloses(found.time_of_flight_ps.low, found.time_of_flight_ps.high, flight)
    fibre = flight * LIGHT_MM_S * 1_000_000 / (2 * 10**12 * inter.index_ppm) / index_of(config, index)
    assert_encloses(found.fibre_mm.low, found.fibre_mm.high, fibre)
    low, high = ends(fibre)
    path = span(on_path(where, low), on_path(where, high)) + exact(map_) * where.error_mm
    assert_encloses(found.path_mm.low, found.path_mm.high, path)


@FEWER
@given(CONFIGS, PLACES, OFFS, st.sampled_from([-1, 1]))
def test_ends_of_a_train_are_no_wider_than_their_parts(
    config: FibreConfig, place: float, off: float, outward: int
) -> None:
    """The sum of what is stated, twice, once the overhang, and the rounding: nothing is added twice."""
    found, inter, detection = end(place, off, outward, config, MAPS[0], None), config.interrogator, config.detection
    trigger = Fraction(inter.trigger_error_ps * LIGHT_MM_S, 2 * 10**6 * inter.index_ppm)
    axle = detection.end_error_mm + max(Fraction(0), Fraction(off) - Fraction(detection.end_error_mm, 2))
    reach = Fraction(place) + axle + detection.overhang_mm + trigger
    share = Fraction(inter.index_error_ppm, 1_000_000)
    most = 2 * (axle + trigger) + detection.overhang_mm + 2 * reach * share / (1 - share) + 2
    assert found.fibre_mm.high - found.fibre_mm.low <= most


# ------------------------------------------------------------------ speed and length


@FEWER
@given(CONFIGS, st.one_of(st.floats(-2e5, 2e5), st.sampled_from([0.0, LEAST_FLOAT, 0.1, 1e5])), OFFS, SHARES, SHARES)
@example(FibreConfig(interrogator=Interrogator(index_error_ppm=10_000)), 1e5, 0.0, 1.0, -1.0)
def test_speeds_enclose(config: FibreConfig, fitted: float, apart: float, change: float, index: float) -> None:
    """`speed`: the fit's error, half of what the ends disagree, a change since the fit's middle, and the index."""
    found, detection = speed(fit(speed_mm_s=fitted, apart_mm_s=apart), config), config.detection
    gained = exact(Fraction(detection.most_change_mm_s2 * detection.fit_ms, 2_000)) * exact(change)
    real = exact(fitted) / index_of(config, index) + gained
    assert_encloses(found.low, found.high, around(real, exact(detection.speed_error_mm_s) + exact(apart) / 2))
    parts = (
        detection.speed_error_mm_s
        + Fraction(apart) / 2
        + Fraction(detection.most_change_mm_s2 * detection.fit_ms, 2_000)
    )
    share = Fraction(config.interrogator.index_error_ppm, 1_000_000)
    assert found.high - found.low <= 2 * (parts + abs(Fraction(fitted)) * share / (1 - share)) + 2


@FEWER
@given(CONFIGS, st.sampled_from(MAPS), PLACES, st.floats(0.0, 1.5e6), OFFS, OFFS, SHARES, SHARES, SHARES, SHARES)
@example(FibreConfig(), MAPS[1], 5_000_000.0, 700_000.0, 0.0, 0.0, 1.0, 1.0, 0.0, 1.0)
@example(
    FibreConfig(interrogator=Interrogator(index_error_ppm=10_000)), MAPS[0], 0.0, 1.5e6, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0
)
@example(FibreConfig(detection=Detection(length_error_mm=0)), MAPS[0], 0.0, 0.0, 0.1, 0.2, 1.0, 0.0, 0.0, 0.0)
def test_lengths_enclose(
    config: FibreConfig, where: FibreMap, low: float, apart: float, off_low: float, off_high: float,
    error: float, map_: float, index: float, overhang: float,
) -> None:  # fmt: skip
    """`length`: the ends' error against each other, their scatter, the map's at both ends, the index, the overhangs."""
    course = fit(low, low + apart, off_low_mm=off_low, off_high_mm=off_high)
    found, detection = length(course, config, where), config.detection
    scatter = max(Fraction(0), Fraction(off_low) + Fraction(off_high) - detection.length_error_mm)
    axles = on_path(where, Fraction(course.high_mm)) - on_path(where, Fraction(low))
    true = axles / index_of(config, index) + exact(error) * (detection.length_error_mm + exact(scatter))
    true = true + 2 * exact(map_) * where.error_mm
    true = exact(max(Fraction(0), ends(true)[0])) + (1 + exact(overhang)) * detection.overhang_mm
    assert_encloses(found.low, found.high, true)
    share = Fraction(config.interrogator.index_error_ppm, 1_000_000)
    parts = detection.length_error_mm + scatter + 2 * where.error_mm + ends(axles)[1] * share / (1 - share)
    assert found.high - found.low <= 2 * (parts + detection.overhang_mm) + 3


@FEWER
@given(CONFIGS, st.one_of(st.floats(0.0, 1e8), st.sampled_from([0.0, LEAST_FLOAT, 1e8])), SHARES, SHARES)
def test_lengths_of_sections_enclose(config: FibreConfig, run: float, error: float, index: float) -> None:
    """A section's length as run through: the stated error, and the index; told as a signal."""
    change = Change(Effect.RAISES, Edge.FALL, False, run, 0)
    found = Signaller(config)._length(change)
    assert found is not None
    true = exact(run) / index_of(config, index) + exact(error) * config.sections.length_error_mm
    assert_encloses(found.low, found.high, exact(max(Fraction(0), ends(true)[0])))
    share = Fraction(config.interrogator.index_error_ppm, 1_000_000)
    assert found.high - found.low <= 2 * (config.sections.length_error_mm + Fraction(run) * share / (1 - share)) + 2


# ------------------------------------------------------------------ whole numbers


@FEWER
@given(
    st.one_of(st.fractions(), st.floats(allow_nan=False, allow_infinity=False).map(Fraction)),
    st.one_of(st.fractions(0), st.floats(0, 1e300).map(Fraction)),
)
@example(Fraction(-LEAST_FLOAT), Fraction(LEAST_FLOAT))
def test_whole_bounds_enclose(low: Fraction, width: Fraction) -> None:
    """`Bounds.outward`: the ends are inside, and less than one is added at either."""
    found = Bounds.outward(ExactBounds(low, low + width))
    assert_encloses(found.low, found.high, span(exact(low), exact(low + width)))
    assert found.high - found.low < width + 2


@pytest.mark.parametrize("wrong", [math.nan, math.inf, -math.inf], ids=str)
def test_what_is_not_finite_has_no_bounds(wrong: float) -> None:
    """Places, speeds, scatter and lengths: refused, never told as a number."""
    config, refused = FibreConfig(), rf"^a measured figure is {wrong}; remove figures that are not finite"
    with pytest.raises(InputError, match=refused):
        end(wrong, 0.0, 1, config, MAPS[0], None)
    with pytest.raises(InputError, match=refused):
        end(0.0, wrong, 1, config, MAPS[0], None)
    with pytest.raises(InputError, match=refused):
        speed(fit(speed_mm_s=wrong), config)
    with pytest.raises(InputError, match=refused):
        length(fit(0.0, 1.0, off_low_mm=wrong), config, MAPS[0])
    with pytest.raises(InputError, match=refused):
        Signaller(config)._length(Change(Effect.RAISES, Edge.FALL, False, wrong, 0))


def test_the_judge_sees_a_bound_that_is_short() -> None:
    """A thousandth of a millionth of a mm less than the interval, at either end, is noticed."""
    thin = iv.sqrt(exact(2))
    low, high = ends(thin)
    assert_encloses(low, high, thin)
    for wrong in ((low + Fraction(1, 10**15), high), (low, high - Fraction(1, 10**15))):
        with pytest.raises(AssertionError):
            assert_encloses(*wrong, thin)
