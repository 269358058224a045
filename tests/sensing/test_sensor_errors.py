"""What the sensor adds to the error: every part shows in the bound, and rounding is outward and exact."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.sensing.detection import Peaks
from safeloc.sensing.figures import Sensor
from safeloc.sensing.interpolation import Places, Points
from safeloc.sensing.sensor_errors import ground_nm, range_nm, sine_ppb

PERFECT = Sensor(scale_error_ppm=0, offset_error_mm=0, angle_error_urad=0, ground_reflection_percent=0)
PARTS = st.floats(-1.0, 2.0)


def peak(row: int, column: int, low: float, high: float) -> Points:
    """One peak with these bounds, in cells, on both axes."""
    places = Places(np.array([low]), np.array([low]), np.array([high]))
    return Points(Peaks(np.array([row]), np.array([column]), np.array([1.0])), places, places, np.array([100.0]))


@given(st.integers(30, 1_000), st.integers(1, 15), PARTS, PARTS)
def test_rounding_is_outward_and_below_one(row: int, column: int, a: float, b: float) -> None:
    """Exact cell widths times exact floats, to whole nm and 1e-9: nothing is cut off, and less than one is added."""
    low, high = min(a, b), max(a, b)
    found = peak(row, column, low, high)
    ends = [(row + Fraction(part)) * PERFECT.cell_mm * 1_000_000 for part in (low, high)]
    bound = range_nm(0, found, PERFECT)
    assert ends[0] - 1 < bound.low <= ends[0] <= ends[1] <= bound.high < ends[1] + 1
    sines = [(column - PERFECT.side_cells + Fraction(part)) * PERFECT.sine_cell * 10**9 for part in (low, high)]
    sine = sine_ppb(0, found, PERFECT)
    assert sines[0] - 1 < sine.low <= sines[0] <= sines[1] <= sine.high < sines[1] + 1


@pytest.mark.parametrize(
    ("more_nm", "figure"),
    [(9_990_500, {"scale_error_ppm": 100}), (7_000_000, {"offset_error_mm": 7}), (1_387_700, {"ground_reflection_percent": 5})],
    ids=["scale", "offset", "ground"],
)  # fmt: skip
def test_each_error_adds_error(more_nm: int, figure: dict[str, int]) -> None:
    """On either side, at 99.9 m."""
    found = peak(666, 8, 0.25, 0.25)
    bare, added = range_nm(0, found, PERFECT), range_nm(0, found, PERFECT.model_copy(update=figure))
    assert added.high - bare.high == pytest.approx(more_nm, rel=0.06)
    assert bare.low - added.low == added.high - bare.high


def test_mounting_adds_error_to_the_angle() -> None:
    """3 mrad on either side."""
    found = peak(666, 8, 0.0, 0.0)
    assert sine_ppb(0, found, PERFECT.model_copy(update={"angle_error_urad": 3_000})).high == 3_000_000


def test_the_ground_matters_near_by() -> None:
    """Twice as much at half the range; a nearer range than the blind one is taken for that."""
    sensor = Sensor()
    assert ground_nm(sensor, 10_000_000_000) == pytest.approx(2 * ground_nm(sensor, 20_000_000_000), abs=2)
    assert ground_nm(sensor, -5) == ground_nm(sensor, sensor.blind_mm * 1_000_000)


def test_the_figures_of_a_sensor() -> None:
    """c / 2B in air, half-wavelength antennas, and Doppler's lead."""
    sensor = Sensor()
    assert float(sensor.cell_mm) == pytest.approx(149.896229 / 1.00029)
    assert sensor.sine_cell == Fraction(1, 16)
    assert sensor.shape == (1_024, 17)
    assert sensor.lead_us == 7_700
