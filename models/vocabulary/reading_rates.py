"""Odometers that over-read and under-read by different rates: their distances are corrected, and a symmetric law is left.

A unit whose true run lies between d - over x d and d + under x d for a measured distance d is a unit with the distance
d + (under - over) / 2 x d and the symmetric rate (under + over) / 2 of d. Machines keep to symmetric laws; the correction stands
before them. Taken as symmetric, the same unit would have the greater of both rates.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from fractions import Fraction

from safeloc.config import Config, quantity
from safeloc.language.units import MS_PER_S, PPM_PER_ONE
from safeloc.models.vocabulary.error_law import ErrorLaw

_ROUNDING_MM = 1
"""Two totals that are rounded to whole mm differ from the exact difference by at most this."""


class ReadingRates(Config):
    """The rates of a unit, in millionths of the measured distance."""

    under_ppm: int = quantity(50_000, "ppm of distance", 0, 1_000_000, "[M] by how much the vehicle runs farther")
    over_ppm: int = quantity(50_000, "ppm of distance", 0, 900_000, "[M] by how much it runs less far")

    @property
    def _shift(self) -> Fraction:
        return Fraction(self.under_ppm - self.over_ppm, 2 * PPM_PER_ONE)

    @property
    def _half(self) -> Fraction:
        return Fraction(self.under_ppm + self.over_ppm, 2 * PPM_PER_ONE)

    def law(self, unit: ErrorLaw, period_ms: int) -> ErrorLaw:
        """Return the unit's law for corrected distances: its constant, floor, knee and drift, and the symmetric rate.

        The rounding of corrected distances to whole mm adds 1 mm to the constant, and to the floor the share of it that the
        rate would add in a cycle.
        """
        rate = self._half / (1 + self._shift)
        floor = rate * _ROUNDING_MM * MS_PER_S / period_ms
        figures = {
            "rate_ppm": math.ceil(rate * PPM_PER_ONE),
            "floor_mm_s": unit.floor_mm_s + math.ceil(floor),
            "constant_mm": unit.constant_mm + _ROUNDING_MM,
        }
        return ErrorLaw(**{**unit.model_dump(), **figures})

    def correction(self) -> Correction:
        """Return a correction for the distances of one unit, from the beginning of a journey on."""
        return Correction(self._shift)


@dataclass
class Correction:
    """Corrects the distances of one unit, cycle by cycle. Rounding is carried on, so that it never adds up."""

    _shift: Fraction
    _carried_mm: Fraction = field(default_factory=Fraction)

    def distance_mm(self, measured_mm: int) -> int:
        """Return the corrected distance of a cycle in whole mm. Call it once for each distance that the unit delivers."""
        exact = measured_mm * (1 + self._shift) + self._carried_mm
        rounded = math.floor(exact + Fraction(1, 2))
        self._carried_mm = exact - rounded
        return rounded
