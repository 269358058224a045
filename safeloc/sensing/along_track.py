"""Converts slant range to the present distance along the track, with exact bounds for any track that is not too sharply curved.

The reflector stands o beside the track and h above or below the antenna, a distance s ahead along the track, whose
curvature nowhere exceeds 1 / R. With r the slant range and c the chord,

    c^2 - s^2 o / R  <=  r^2 - o^2 - h^2  <=  c^2 + s^2 o / R        and        s^2 (1 - s^2 / 12 R^2)  <=  c^2  <=  s^2

The first holds since the chord leaves the tangent by at most s^2 / 2R. The second follows from Schur's theorem: no chord of
such a curve is shorter than that of the circle. The view zone of the reflector is shorter than R.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

from safeloc.errors import InputError
from safeloc.language.units import MS_PER_S, US_PER_MS
from safeloc.sensing.echoes import Echo
from safeloc.sensing.figures import MILLION, Installation, RadarConfig
from safeloc.sensing.rounding import Exact, ExactBounds


@dataclass(frozen=True)
class Delay:
    """The age of a frame, and the speed towards the reflector (negative: away) since it was taken.

    If the speed is unknown, give the highest speed in both directions; the age then widens the bounds instead of being
    compensated.
    """

    least_ms: int
    most_ms: int
    least_mm_s: int
    most_mm_s: int

    def __post_init__(self) -> None:
        figures = (self.least_ms, self.most_ms, self.least_mm_s, self.most_mm_s)
        if any(type(one) is not int for one in figures):
            raise InputError(f"{self}: ages and speeds are whole ms and mm/s.")
        if not 0 <= self.least_ms <= self.most_ms or self.least_mm_s > self.most_mm_s:
            raise InputError(f"{self}: needs 0 <= least_ms <= most_ms and least_mm_s <= most_mm_s.")

    @classmethod
    def since(cls, taken_ms: int, now_ms: int, least_mm_s: int, most_mm_s: int) -> Delay:
        """Return the delay from a frame's time to now, both in whole ms of one clock; each may be rounded by 0.5 ms."""
        age = now_ms - taken_ms
        return cls(max(0, age - 1), age + 1, least_mm_s, most_mm_s)

    @property
    def speed(self) -> ExactBounds:
        """The speed towards the reflector, mm/s."""
        return ExactBounds(self.least_mm_s, self.most_mm_s)


def distance_now(echo: Echo, config: RadarConfig, delay: Delay) -> ExactBounds:
    """Return bounds in mm of the distance along the track to the reflector of an echo, after the delay.

    A negative lower bound means that the vehicle may have passed the reflector. InputError for a range that does not fit
    the sharpest radius.
    """
    then = along_track(_at_frame(_measured(echo), config, delay), config.installation)
    age = ExactBounds(Fraction(delay.least_ms, MS_PER_S), Fraction(delay.most_ms, MS_PER_S))
    run = age * delay.speed
    return ExactBounds(then.low - run.high, then.high - run.low)


def lateral(echo: Echo, config: RadarConfig, delay: Delay) -> ExactBounds:
    """Return bounds in mm of an echo's lateral distance from the antenna's axis when the frame was taken, positive to the left."""
    low, high = echo.sine_ppm - echo.sine_error_ppm, echo.sine_ppm + echo.sine_error_ppm
    sine = ExactBounds(Fraction(low, MILLION), Fraction(high, MILLION))
    return _at_frame(_measured(echo), config, delay) * sine


def _measured(echo: Echo) -> ExactBounds:
    nearest = max(echo.range_mm - echo.range_error_mm, 0)
    return ExactBounds(nearest, echo.range_mm + echo.range_error_mm)


def _at_frame(measured: ExactBounds, config: RadarConfig, delay: Delay) -> ExactBounds:
    """Return the range at the time of the frame: a chirp measures the range `lead_us` later, so the run until then is added."""
    lead_s = config.sensor.lead_us / (US_PER_MS * MS_PER_S)
    nearest = measured.low - max(abs(delay.least_mm_s), abs(delay.most_mm_s)) * lead_s
    closing = delay.speed * ExactBounds(_least_cosine(nearest, config.installation), 1)
    run = closing * ExactBounds(lead_s, lead_s)
    return ExactBounds(max(measured.low + run.low, 0), measured.high + run.high)


def _least_cosine(range_mm: Exact, installation: Installation) -> Fraction:
    """Return a lower bound of the cosine of the angle between track and line of sight: 1 - sin^2."""
    if range_mm <= 0:
        return Fraction(0)
    aside = installation.offset_mm + installation.offset_error_mm + installation.height_difference_mm
    sine = Fraction(aside) / range_mm + Fraction(range_mm) / installation.least_radius_mm
    return max(Fraction(0), 1 - sine * sine)


def along_track(slant: ExactBounds, installation: Installation) -> ExactBounds:
    """Return bounds, in whole mm, of the distance along the track to a reflector ahead at this slant range >= 0."""
    radius = installation.least_radius_mm
    widest = installation.offset_mm + installation.offset_error_mm
    narrowest = max(0, installation.offset_mm - installation.offset_error_mm)
    bend = Fraction(widest, radius)
    least = slant.low**2 - widest**2 - installation.height_difference_mm**2
    low = math.isqrt(max(0, math.floor(least / (1 + bend))))
    return ExactBounds(low, _farthest(max(slant.high**2 - narrowest**2, 0), bend, radius))


def _farthest(square: Exact, bend: Fraction, radius: int) -> int:
    """Return the largest s with s^2 (1 - bend - s^2 / 12 R^2) <= square: first with s <= R, then with that bound for s."""
    first = square / (Fraction(11, 12) - bend)
    if first > radius**2:
        raise InputError(
            f"a reflector {math.isqrt(math.floor(square))} mm away is not in view on a radius of {radius} mm; "
            "measure nearer ones, or configure the true least radius in view zones."
        )
    return math.isqrt(math.ceil(square / (1 - bend - first / (12 * radius**2)))) + 1
