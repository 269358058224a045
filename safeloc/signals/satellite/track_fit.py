"""Position (or speed) along the track and the clock term from the used satellites only (SAT-5; [0070]), exactly.

Model per satellite: difference = slope * s + clock + error, with the slope the change of pseudorange per metre along
the track (minus the line of sight's share along the track). Two unknowns: two satellites solve, three detect a fault,
four exclude one. The same fit serves speed and clock drift with range rates. All figures are rational: bounds hold
exactly, not up to rounding.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction

from safeloc.errors import InputError

SOLVE, DETECT, EXCLUDE = 2, 3, 4


@dataclass(frozen=True, slots=True)
class Sight:
    """One used satellite: measured minus predicted (mm or mm/s), slope in millionths, and its weight (1/variance)."""

    difference: int
    slope_ppm: int
    weight: Fraction = Fraction(1)


@dataclass(frozen=True, slots=True)
class TrackFit:
    """Correction along the track and of the clock, the share a_i of every satellite's error in it, chi-square."""

    along: Fraction
    clock: Fraction
    shares: Mapping[str, Fraction]
    chi_square: Fraction
    degrees_of_freedom: int

    def protection_level(self, threshold: int) -> int:
        """sum |a_i| * threshold, rounded up: no larger error is possible while each satellite's is within it."""
        if threshold < 0:
            raise InputError(f"threshold {threshold} is negative; give the bound of a satellite's error.")
        return math.ceil(sum(map(abs, self.shares.values()), Fraction(0)) * threshold)


def fit(sights: Mapping[str, Sight]) -> TrackFit:
    """Weighted least squares over the named satellites.

    InputError below two satellites, for a weight that is not positive, or when all slopes are alike (no solution).
    """
    if len(sights) < SOLVE:
        raise InputError(f"{len(sights)} usable satellites; {SOLVE} are needed to solve along the track: no fix.")
    if any(one.weight <= 0 for one in sights.values()):
        raise InputError("a weight must be positive; leave the satellite out instead.")
    total = _sum(one.weight for one in sights.values())
    middle = _sum(one.weight * one.slope_ppm for one in sights.values()) / total
    spread = _sum(one.weight * (one.slope_ppm - middle) ** 2 for one in sights.values())
    if spread == 0:
        raise InputError("all satellites stand alike to the track: position and clock cannot be told apart, no fix.")
    shares = {name: one.weight * (one.slope_ppm - middle) / spread * 10**6 for name, one in sights.items()}
    along = _sum(shares[name] * one.difference for name, one in sights.items())
    clock = _sum(one.weight * _left(one, along) for one in sights.values()) / total
    square = _sum(one.weight * (_left(one, along) - clock) ** 2 for one in sights.values())
    return TrackFit(along, clock, shares, square, len(sights) - SOLVE)


def slope_ppm(direction: tuple[float, float, float], track: tuple[float, float, float]) -> int:
    """Slope of a satellite from unit vectors to it and along the track, to the nearest millionth.

    Rounding costs half a micrometre a metre of correction. InputError when a figure is not finite.
    """
    share = sum(a * b for a, b in zip(direction, track, strict=True))
    if not math.isfinite(share):
        raise InputError("a direction is not finite; declare no fix.")
    return round(-share * 1e6)


def _left(one: Sight, along: Fraction) -> Fraction:
    return one.difference - Fraction(one.slope_ppm, 10**6) * along


def _sum(values: Iterable[Fraction]) -> Fraction:
    return sum(values, Fraction(0))
