"""Bounds of a measured place after adding all sensor errors: range in whole nm, sine in whole 1e-9."""

from __future__ import annotations

from fractions import Fraction

from safeloc.language.units import NM_PER_MM
from safeloc.sensing.figures import MILLION, Sensor
from safeloc.sensing.interpolation import Places, Points
from safeloc.sensing.rounding import ExactBounds

_BILLION = 1_000_000_000
_GROUND_SECOND_ORDER = Fraction(5, 4)
_NEAREST_MM = 1_000


def range_nm(one: int, found: Points, sensor: Sensor) -> ExactBounds:
    """Return bounds of the slant range of a peak: errors from noise and other echoes, scale, offset and ground."""
    measured = _scaled(int(found.peaks.row[one]), found.range, one, sensor.cell_mm * NM_PER_MM)
    offset = sensor.offset_error_mm * NM_PER_MM
    scale = _scale_nm(sensor, int(measured.high) + offset)
    return measured.widened(scale + offset + ground_nm(sensor, int(measured.low) - scale - offset))


def _scale_nm(sensor: Sensor, measured_nm: int) -> int:
    """Return the greatest error of a measured range due to the sensor's scale.

    The error is a share of the true range: measured = true (1 +- e), so it is at most measured e / (1 - e).
    """
    return -(-measured_nm * sensor.scale_error_ppm // (MILLION - sensor.scale_error_ppm))


def ground_nm(sensor: Sensor, range_nm: int) -> int:
    """Return the largest shift of a range by reflection from the ground.

    The way over the ground is 2 h1 h2 / r longer. With relative amplitude q on either leg the centre of the sum moves by at
    most q / (1 - q) of this, plus a quarter for the second order.
    """
    nearest = max(range_nm, sensor.blind_mm * NM_PER_MM, _NEAREST_MM * NM_PER_MM)
    share = Fraction(sensor.ground_reflection_percent, 100 - sensor.ground_reflection_percent) * _GROUND_SECOND_ORDER
    detour = 2 * sensor.ground_height_mm2 * NM_PER_MM**2
    return -(-detour * share.numerator // (nearest * share.denominator))


def sine_ppb(one: int, found: Points, sensor: Sensor) -> ExactBounds:
    """Return bounds of the sine of the angle to the left, including the error of mounting."""
    cell = int(found.peaks.column[one]) - sensor.side_cells
    return _scaled(cell, found.angle, one, sensor.sine_cell * _BILLION).widened(sensor.angle_error_urad * 1_000)


def _scaled(cell: int, places: Places, one: int, width: Fraction) -> ExactBounds:
    """Return bounds of cell plus part of a cell in the unit of the width, rounded outward; a float is exact as a rational."""
    low, high = float(places.low[one]), float(places.high[one])
    return ExactBounds(_floor(cell, low, width), -_floor(-cell, -high, width))


def _floor(cell: int, part: float, width: Fraction) -> int:
    over, under = part.as_integer_ratio()
    return (cell * under + over) * width.numerator // (under * width.denominator)
