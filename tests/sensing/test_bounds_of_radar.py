"""Every bound that the radar front end hands over holds what interval arithmetic says, over the range of its inputs."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
from hypothesis import example, given
from hypothesis import strategies as st
from mpmath import iv

from safeloc.sensing.along_track import Delay, along_track, distance_now, lateral
from safeloc.sensing.detection import Peaks
from safeloc.sensing.echoes import Echo, echoes
from safeloc.sensing.figures import LIGHT_MM_S, MILLION, Detection, Installation, RadarConfig, Reflectors, Sensor
from safeloc.sensing.images import in_cdb
from safeloc.sensing.interpolation import FLOAT_CELLS, Places, Points, points
from safeloc.sensing.radar import Frame
from safeloc.sensing.reflector_inputs import step_inputs
from safeloc.sensing.rounding import ExactBounds, outward
from safeloc.sensing.sensor_errors import ground_nm, range_nm, sine_ppb
from safeloc.sensing.signature import MARKS, Model
from tests.sensing.enclosure import FEWER, Ball, assert_encloses, ends, exact, span

NM, BILLION = 1_000_000, 1_000_000_000
LEAST_FLOAT, GREATEST = 5e-324, 1e19
SHARES = st.floats(-1.0, 1.0)
EXACT = Sensor(scale_error_ppm=0, offset_error_mm=0, ground_reflection_percent=0, angle_error_urad=0)
"""A sensor without errors of its own: what is left is the places' own bound."""

# ------------------------------------------------------------------ whole numbers


@FEWER
@given(
    st.one_of(st.fractions(), st.floats(allow_nan=False, allow_infinity=False).map(Fraction)),
    st.one_of(st.fractions(0), st.floats(0, 1e300).map(Fraction)),
    st.sampled_from([1, 1_000, 1_000_000]),
)
@example(Fraction(0), Fraction(LEAST_FLOAT), 1)
@example(Fraction(-LEAST_FLOAT), Fraction(0), 1_000)
@example(Fraction(1e300), Fraction(1, 3), 1)
def test_whole_numbers_enclose(low: Fraction, width: Fraction, unit: int) -> None:
    """`outward`: both ends are inside, and each end is less than a unit and a half away."""
    value, error = outward(ExactBounds(low, low + width), unit)
    assert_encloses((value - error) * unit, (value + error) * unit, span(exact(low), exact(low + width)))
    assert 2 * error * unit < width + 3 * unit


# ------------------------------------------------------------------ intensity


def level(power: float) -> Ball:
    """Hundredths of dB."""
    return 1_000 * iv.log(exact(power)) / iv.log(exact(10))


@FEWER
@given(st.floats(LEAST_FLOAT, 1e300))
@example(LEAST_FLOAT)
@example(math.nextafter(100.0, 0.0))
@example(100.0)
@example(math.nextafter(10.0, 0.0))
@example(math.nextafter(1.0, 0.0))
@example(math.nextafter(1e15, 0.0))
@example(1e22)
def test_intensity_is_never_told_stronger_than_it_is(power: float) -> None:
    """`in_cdb`: at most the level, and less than 0.01 dB below it."""
    told = in_cdb(power)
    assert_encloses(told, told + 1, level(power))


# ------------------------------------------------------------------ places between cells

SMALL = RadarConfig(
    sensor=Sensor(samples=64, antennas=16, blind_mm=0), detection=Detection(window_cells=9), reflectors=Reflectors()
)
ROW, SIDE = 30, SMALL.sensor.side_cells
POWERS = st.one_of(st.floats(1.0, 1e4), st.floats(1e-9, GREATEST), st.floats(-9, 19).map(lambda tens: 10.0**tens))
PARTS = st.one_of(st.floats(0.0, 1.0), st.sampled_from([0.0, LEAST_FLOAT, 1e-300, math.nextafter(1.0, 0.0), 1.0]))
"""Power of a neighbour against the peak's."""


def found_at(top: float, before: float, after: float, background: float) -> Places:
    """The places in range of a peak with these powers in and beside its cell."""
    power = np.zeros(SMALL.sensor.shape)
    power[ROW - 1 : ROW + 2, SIDE] = before, top, after
    peak = Peaks(np.array([ROW]), np.array([SIDE]), np.array([background]))
    return points(power, peak, SMALL).range


def place(tall: Ball, beside: Ball) -> Ball:
    """(2a - 1) / (1 + a) with a = beside / tall, each amplitude written once."""
    return 2 - 3 / (1 + beside / tall)


@FEWER
@given(POWERS, PARTS, PARTS, st.one_of(st.floats(1e-14, 0.0045), st.just(1e-300)))
def test_places_between_cells_enclose(top: float, left: float, right: float, share: float) -> None:
    """`points`: amplitudes off by the noise's greatest, together with the window's own error, and next to nothing more."""
    before, after, background = top * left, top * right, top * share
    noise = iv.sqrt(exact(background) * exact(10) ** (exact(SMALL.detection.noise_bound_cdb) / 1_000))
    tall, beside = iv.sqrt(exact(top)), iv.sqrt(exact(max(before, after)))
    assert ends(noise)[1] < ends(tall)[0]
    least = (beside - noise) if ends(beside - noise)[0] > 0 else exact(0)
    amplitude, short = span(tall - noise, tall + noise), exact(4) / SMALL.sensor.samples**2
    quantity = place(amplitude, span(least, beside + noise))
    quantity = span(quantity - short, quantity + short)
    places = found_at(top, before, after, background)
    sign = 1 if after >= before else -1
    low, high = sorted((sign * float(places.low[0]), sign * float(places.high[0])))
    lowest, highest = ends(quantity)
    assert_encloses(low, high, span(exact(max(lowest, Fraction(-1))), exact(highest)))
    assert Fraction(high) - Fraction(low) <= highest - max(lowest, Fraction(-1)) + Fraction(4 * FLOAT_CELLS)


@FEWER
@given(POWERS, PARTS, st.floats(1.0, 1e6))
def test_where_noise_may_be_all_the_whole_neighbourhood_is_told(top: float, right: float, times: float) -> None:
    """A peak no stronger than the noise may be anywhere from one cell before to two behind."""
    places = found_at(top, 0.0, top * right, top * times)
    assert float(places.low[0]) == -1.0
    assert float(places.high[0]) >= 2.0


@FEWER
@given(POWERS, st.floats(0.3, 1.0), st.integers(4, 25), st.integers(-2, 2), st.floats(1e-3, 1e3))
def test_what_another_echo_leaks_is_enclosed(top: float, right: float, away: int, aside: int, ratio: float) -> None:
    """`points`: side lobes of the other echo come to the noise, as far as the other one's power is known."""
    power = np.zeros(SMALL.sensor.shape)
    power[ROW - 1 : ROW + 2, SIDE] = 0.0, top, top * right
    power[ROW + away, SIDE + aside] = other = top * ratio
    both = Peaks(np.array([ROW, ROW + away]), np.array([SIDE, SIDE + aside]), np.full(2, 1e-300))
    found = points(power, both, SMALL)
    at = np.flatnonzero((found.peaks.row == ROW) & (found.peaks.column == SIDE))
    leaked = lobe(away) * smaller(1, 2 * lobe(abs(aside))) * iv.sqrt(exact(other))
    if len(at) == 0:
        return
    noise = leaked * exact(Fraction(999_999, 1_000_000))  # the other's power is read off its cell, on which it stands
    tall, beside = iv.sqrt(exact(top)), iv.sqrt(exact(top * right))
    if ends(tall - noise)[0] <= 0 or ends(beside - noise)[0] <= 0:
        return
    quantity = place(span(tall - noise, tall + noise), span(beside - noise, beside + noise))
    assert_encloses(float(found.range.low[at[0]]), float(found.range.high[at[0]]), quantity)


def lobe(cells: int) -> Ball:
    """Greatest amplitude of a point a cell and a half nearer, 1 / (pi x (x^2 - 1))."""
    far = exact(cells) - exact(1.5)
    return exact(1) if cells < 3 else 1 / (iv.pi * far * (far * far - 1))


def smaller(one: int, other: Ball) -> Ball:
    """The smaller one of a whole number and a thin interval."""
    return exact(one) if ends(other)[0] > one else other


# ------------------------------------------------------------------ sensor


SENSORS = st.builds(
    Sensor,
    bandwidth_mhz=st.sampled_from([50, 250, 1_000, 4_999]),
    air_ppm=st.sampled_from([0, 290, 500]),
    scale_error_ppm=st.one_of(st.integers(0, 10_000), st.sampled_from([0, 100, 10_000])),
    offset_error_mm=st.sampled_from([0, 5, 1_000]),
    angle_error_urad=st.sampled_from([0, 3_000, 100_000]),
    ground_reflection_percent=st.sampled_from([0, 5, 30]),
    ground_height_mm2=st.sampled_from([0, 1_000_000, 25_000_000]),
    blind_mm=st.sampled_from([0, 3_000]),
    antennas=st.sampled_from([8, 31, 256]),
)


def one_peak(row: int, column: int, low: float, high: float) -> Points:
    """One peak with these bounds, in cells, on both axes."""
    places = Places(np.array([low]), np.array([low]), np.array([high]))
    return Points(Peaks(np.array([row]), np.array([column]), np.array([1.0])), places, places, np.array([100.0]))


def ground_shift(sensor: Sensor, range_mm: Ball) -> Ball:
    """How far the sum's centre may move: the way over the ground, from antenna and reflector height, and q / (1 - q)."""
    way = iv.sqrt(range_mm * range_mm + 4 * exact(sensor.ground_height_mm2)) - range_mm
    return way * sensor.ground_reflection_percent / (100 - sensor.ground_reflection_percent)


HIGH_AND_NEAR = Sensor(
    bandwidth_mhz=250, scale_error_ppm=0, offset_error_mm=1_000, ground_reflection_percent=30, ground_height_mm2=25_000_000,
    blind_mm=0,
)  # fmt: skip
MOST_ADDED = 14
"""The bound takes the way over the ground in first order and a quarter more, on both sides. At 1 m, the nearest range, with the highest
antenna and reflector, the first order is 50 / (sqrt(101) - 1) = 5.52 times the exact way: 2 x 1.25 x 5.52 = 13.8. A machine knows the measured range alone: the way is that of
the range or of the measured one, whichever is nearer."""


@FEWER
@given(SENSORS, st.floats(1.0, 8_000.0), SHARES, SHARES, SHARES)
@example(Sensor(scale_error_ppm=10_000, offset_error_mm=0, ground_reflection_percent=0), 1_000.0, -1.0, 0.0, 0.0)
@example(Sensor(), 1_000.0, -1.0, -1.0, -1.0)
@example(HIGH_AND_NEAR, 1.5, 0.0, 1.0, 1.0)
@example(HIGH_AND_NEAR.model_copy(update={"bandwidth_mhz": 50, "offset_error_mm": 0}), 1.0, 0.0, 0.0, -1.0)
def test_ranges_enclose_what_the_sensor_may_have_measured(
    sensor: Sensor, cells: float, scale: float, offset: float, ground: float
) -> None:
    """`range_nm`: a range whose measured value is off by scale, offset and ground, each within its stated error."""
    nearest_mm = max(sensor.blind_mm, 1_000)
    cell = exact(LIGHT_MM_S) / (2 * sensor.bandwidth_mhz * MILLION) * MILLION / (MILLION + sensor.air_ppm)
    truth = exact(nearest_mm) + cell * exact(cells)
    measured = (truth + exact(ground) * ground_shift(sensor, truth)) * (
        1 + exact(scale) * sensor.scale_error_ppm / MILLION
    ) + exact(offset) * sensor.offset_error_mm
    low, high = (float(end) for end in ends(measured / cell))
    row = max(1, round(low))
    low, high = math.nextafter(low - row, -math.inf), math.nextafter(high - row, math.inf)
    bound = range_nm(0, one_peak(row, sensor.side_cells, low, high), sensor)
    assert_encloses(bound.low, bound.high, truth * NM)
    nearest = max(nearest_mm, min(float(ends(one)[0]) for one in (truth, measured)))
    added = float(ends(ground_shift(sensor, exact(nearest)))[1]) + sensor.offset_error_mm
    scaled = float(ends(truth)[1]) * sensor.scale_error_ppm / MILLION
    assert (bound.high - bound.low) / NM < 2.1 * scaled + MOST_ADDED * added + 1e-5


@FEWER
@given(st.integers(0, 10**13), st.sampled_from([0, 5, 30]), st.sampled_from([0, 1, 1_000_000, 25_000_000]))
def test_the_ground_adds_error_in_full(range_nm_: int, percent: int, height: int) -> None:
    """`ground_nm`: never below the exact way over the ground, and a quarter more than its first order at most."""
    sensor = Sensor(ground_reflection_percent=percent, ground_height_mm2=height, blind_mm=0)
    told, nearest = ground_nm(sensor, range_nm_), max(exact_mm(range_nm_), Fraction(1_000))
    first = exact(Fraction(2 * height * percent, 100 - percent)) / exact(nearest) * NM
    assert_encloses(0, told, span(exact(0), ground_shift(sensor, exact(nearest)) * NM))
    assert told <= ends(first)[1] * Fraction(5, 4) + 1


def exact_mm(nm: int) -> Fraction:
    """Nanometres in mm."""
    return Fraction(nm, NM)


@FEWER
@given(SENSORS, st.floats(-0.49, 0.49), SHARES)
def test_sines_enclose_what_the_sensor_may_have_measured(sensor: Sensor, sine: float, mounting: float) -> None:
    """`sine_ppb`: the stated error of the mounting and the rounding, and nothing else."""
    measured = exact(sine) + exact(mounting) * sensor.angle_error_urad / MILLION
    cells = measured * sensor.antennas / 2
    low, high = (float(end) for end in ends(cells))
    column = round(low)
    low, high = math.nextafter(low - column, -math.inf), math.nextafter(high - column, math.inf)
    bound = sine_ppb(0, one_peak(1, column + sensor.side_cells, low, high), sensor)
    assert_encloses(bound.low, bound.high, exact(sine) * BILLION)
    assert bound.high - bound.low <= 2 * 1_000 * sensor.angle_error_urad + 4


# ------------------------------------------------------------------ along the track


def seen(along: Ball, radius: float, aside: Ball, height: float) -> tuple[Ball, Ball]:
    """Slant range, and cosine between track and sight, of what stands beside a circle (0: a straight) after this way."""
    x, y = along, aside
    if radius:
        turn = along / exact(radius)
        x, y = (exact(radius) - aside) * iv.sin(turn), exact(radius) - (exact(radius) - aside) * iv.cos(turn)
    slant = iv.sqrt(
        x**2 + y**2 + exact(height) ** 2
    )  # a square, unlike a product of two equal intervals, is never negative
    return slant, x / slant


PLACES = st.builds(
    Installation,
    offset_mm=st.sampled_from([0, 3_000, 20_000]),
    offset_error_mm=st.sampled_from([0, 100, 5_000]),
    height_difference_mm=st.sampled_from([0, 500, 5_000]),
    least_radius_mm=st.sampled_from([190_000, 1_000_000, 10_000_000_000]),
)


@FEWER
@given(PLACES, st.floats(0.0, 140_000.0), st.sampled_from([-1.0, 0.0, 1.0]), SHARES, SHARES, st.sampled_from([-1, 1]))
@example(Installation(), 140_000.0, 1.0, 1.0, 1.0, 1)
@example(Installation(), LEAST_FLOAT, 0.0, 1.0, 1.0, 1)
@example(Installation(offset_error_mm=100), 2.4514920895155617e-244, 1.0, 2.4514920895155617e-244, 0.0, -1)
def test_distances_along_the_track_enclose(
    installation: Installation, along: float, bend: float, off: float, height: float, side: int
) -> None:
    """`along_track`: on the straight and on the sharpest curve to either side, wherever the reflector may stand."""
    aside = exact(max(0, installation.offset_mm)) + exact(off) * installation.offset_error_mm
    if ends(aside)[0] < 0:
        aside = exact(0)
    slant, _ = seen(
        exact(along), bend * installation.least_radius_mm, side * aside, height * installation.height_difference_mm
    )
    low, high = ends(slant)
    held = along_track(ExactBounds(low, high), installation)
    assert_encloses(held.low, held.high, exact(along))


@FEWER
@given(st.floats(20_000.0, 140_000.0), SHARES)
def test_along_a_straight_track_little_is_given_away(along: float, off: float) -> None:
    """Where nothing but 100 mm aside is unsure: what these cost (100 mm x 3100 / 20 000, both ways), and 2 mm."""
    installation = Installation(height_difference_mm=0, least_radius_mm=10_000_000_000)
    slant, _ = seen(exact(along), 0, exact(3_000) + exact(off) * 100, 0)
    held = along_track(ExactBounds(*ends(slant)), installation)
    assert held.high - held.low < 2 * 100 * 3_100 / along + 2.5


SPEEDS = st.sampled_from([-40_000, -1, 0, 1, 40_000])


@FEWER
@given(
    st.floats(20_000.0, 140_000.0), st.integers(0, 500), SPEEDS, st.integers(0, 3_000), SHARES,
    st.sampled_from([-1.0, 0.0, 1.0]),
)  # fmt: skip
def test_distances_now_enclose(ahead: float, age_ms: int, speed: int, unsure: int, share: float, bend: float) -> None:
    """`distance_now`, `step_inputs`: Doppler's shift undone and the age run, at every speed within its bounds."""
    config = RadarConfig()
    real = exact(speed) + exact(share) * unsure
    slant, cosine = seen(exact(ahead), bend * config.installation.least_radius_mm, exact(3_000), 0)
    lead_s = exact(config.sensor.lead_us) / MILLION
    measured_mm, error_mm = outward(ExactBounds(*ends(slant - real * cosine * lead_s)))
    echo = Echo(Model.A, None, measured_mm, error_mm, 0, 0, 5_000, 2_000)
    delay = Delay(age_ms, age_ms, speed - unsure, speed + unsure)
    held = distance_now(echo, config, delay)
    now = exact(ahead) - real * age_ms / 1_000
    assert_encloses(held.low, held.high, now)
    given_ = step_inputs(Frame(0, 0, 0, (echo,)), config, delay).inputs
    if "echo_1_range_mm" in given_:
        told, error = int(given_["echo_1_range_mm"]), int(given_["echo_1_error_mm"])
        assert_encloses(told - error, told + error, now)
        assert 2 * error < held.high - held.low + 3


@FEWER
@given(st.floats(5_000.0, 140_000.0), st.floats(-0.45, 0.45), st.integers(0, 400), st.integers(0, 30_000))
def test_lateral_places_enclose(range_mm: float, sine: float, error_mm: int, error_ppm: int) -> None:
    """`lateral`: range times sine, wherever both lie within their errors."""
    echo = Echo(Model.A, None, round(range_mm), error_mm, round(sine * MILLION), error_ppm, 5_000, 2_000)
    held = lateral(echo, RadarConfig(), Delay(0, 0, 0, 0))
    told = span(exact(max(echo.range_mm - error_mm, 0)), exact(echo.range_mm + error_mm))
    angle = span(exact(echo.sine_ppm - error_ppm), exact(echo.sine_ppm + error_ppm)) / MILLION
    assert_encloses(held.low, held.high, told * angle)
    low, high = ends(told * angle)
    assert held.high - held.low <= high - low + Fraction(1, MILLION)


@FEWER
@given(st.integers(0, 10**12), st.integers(0, 10**6), SHARES, SHARES)
def test_ages_enclose_two_rounded_times(taken_ms: int, age_ms: int, at: float, then: float) -> None:
    """`Delay.since`: whole ms of one clock, each the nearest or next to it, half a ms off at most."""
    delay = Delay.since(taken_ms, taken_ms + age_ms, -1, 1)
    age = exact(age_ms) + exact(at) / 2 - exact(then) / 2
    assert_encloses(
        delay.least_ms,
        delay.most_ms,
        span(exact(max(ends(age)[0], Fraction(0))), exact(max(ends(age)[1], Fraction(0)))),
    )


# ------------------------------------------------------------------ reflectors


@FEWER
@given(
    st.sampled_from([*MARKS]), st.integers(0, 3), st.floats(8_000.0, 130_000.0), st.floats(-0.3, 0.3), SHARES, SHARES
)
@example(Model.A, 2, 8_000.0, 0.3, 1.0, 1.0)
@example(Model.A, 1, 8_000.0, 0.3, -1.0, 1.0)
def test_one_right_corner_of_three_is_enough(
    model: Model, right: int, range_mm: float, sine: float, off: float, aside: float
) -> None:
    """`echoes`: range and sine of the nearest corner are held as long as one of the three is read right (3: all are)."""
    config = RadarConfig(sensor=EXACT)
    near, far_aside = exact(range_mm), exact(range_mm) * exact(sine)
    rows, columns = [], []
    for number, mark in enumerate(MARKS[model]):
        along = iv.sqrt(near * near - far_aside * far_aside) + mark * config.reflectors.unit_mm
        slant, wrong = iv.sqrt(along * along + far_aside * far_aside), right not in (number, 3)
        rows.append((slant + wrong * exact(off) * 25) / exact(config.sensor.cell_mm))
        columns.append((far_aside / slant + wrong * exact(aside) / 500) / exact(config.sensor.sine_cell))
    (echo, *others) = echoes(read_at(rows, columns, config), config)
    assert (right == 3) <= (echo.model is model)
    if echo.model is model:
        assert not others
        assert_encloses(echo.range_mm - echo.range_error_mm, echo.range_mm + echo.range_error_mm, near)
        assert_encloses(echo.sine_ppm - echo.sine_error_ppm, echo.sine_ppm + echo.sine_error_ppm, exact(sine) * MILLION)
    if right == 3:  # a thousandth of a cell in range; the same of the sine costs unit x 12 x sine in range
        assert echo.range_error_mm <= 3 + 7_200 * abs(sine) * 1.1 / 16 / 1_000 + 7_200 / 16_000
        assert echo.sine_error_ppm <= 200


def read_at(rows: list[Ball], columns: list[Ball], config: RadarConfig, off: float = 1e-3) -> Points:
    """Three peaks, each best place half of its bound off, and bounds of a thousandth of a cell."""
    cells, across = np.array([middle(one) for one in rows]), np.array([middle(one) for one in columns])
    row, column = np.rint(cells).astype(np.int64), np.rint(across).astype(np.int64)

    def places(best: np.ndarray) -> Places:
        return Places(best + off / 2, best - off, best + off)

    peaks = Peaks(row, column + config.sensor.side_cells, np.ones(3))
    return Points(peaks, places(cells - row), places(across - column), lawful(cells, config))


def middle(one: Ball) -> float:
    """A thin interval as a float."""
    return float(ends(one)[0])


def lawful(cells: np.ndarray, config: RadarConfig) -> np.ndarray:
    """Powers that the range law allows for a corner."""
    nominal = config.reflectors.section_cdbsm(config.sensor.carrier_mhz) + config.reference_cdb
    ranges = cells * float(config.sensor.cell_mm)
    return np.asarray(10 ** ((nominal - 4_000 * np.log10(ranges / 100_000)) / 1_000))
