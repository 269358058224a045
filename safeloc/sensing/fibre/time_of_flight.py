"""Time of flight: the distance along the fibre of a pattern that arrives T after its pulse (FWG-6).

    Ls = T V / 2        V = c0 / n

The source prints `Ls = 1/2 * T2 / V`, which has the unit s2/m and for 100 us gives 2.4e-13; half the product has the
unit of a distance and gives 10.2 km. Light goes there and back, hence the half.
"""

from __future__ import annotations

from fractions import Fraction

from safeloc.errors import InputError
from safeloc.sensing.figures import LIGHT_MM_S, MILLION
from safeloc.sensing.rounding import Exact, ExactBounds

_PS_PER_S = 10**12


def speed_mm_s(index_ppm: int) -> Fraction:
    """Return the speed of light in a fibre, by its index of refraction in millionths."""
    if index_ppm <= MILLION:
        raise InputError(f"an index of refraction of {index_ppm} ppm is not above that of vacuum (1000000 ppm).")
    return Fraction(LIGHT_MM_S * MILLION, index_ppm)


def distance_mm(time_ps: Exact, index_ppm: int) -> Fraction:
    """Return the length of fibre to the origin of a pattern that arrives `time_ps` after its pulse was sent."""
    if time_ps < 0:
        raise InputError(f"a pattern cannot come {-time_ps} ps before its pulse.")
    return Fraction(time_ps) * speed_mm_s(index_ppm) / (2 * _PS_PER_S)


def time_ps(distance: Exact, index_ppm: int) -> Fraction:
    """Return the delay between a pulse and its pattern from `distance` mm of fibre away."""
    return Fraction(distance) * 2 * _PS_PER_S / speed_mm_s(index_ppm)


def bounds_mm(time: ExactBounds, index_ppm: int, index_error_ppm: int) -> ExactBounds:
    """Return bounds of the distance (Se) from those of the time (ps) and the greatest error of the index in ppm of it."""
    error = Fraction(index_error_ppm, MILLION)
    near, far = distance_mm(max(time.low, 0), index_ppm), distance_mm(max(time.high, 0), index_ppm)
    return ExactBounds(near / (1 + error), far / (1 - error))


def most_pulses_hz(fibre_mm: int, index_ppm: int) -> Fraction:
    """Return the greatest rate with only one pulse in the fibre at a time: V / 2L."""
    return speed_mm_s(index_ppm) / (2 * fibre_mm)
