"""Solves for place and speed along the track from usable satellites alone, with guaranteed bounds (SAT-5).

The errors of each used satellite's differences are bounded. The cost of linearising is added to a bound: the vehicle may be
anywhere within the prediction's margin, the track bends there, and the line of sight turns a little. While every bound holds,
the true place and speed lie within sum |a_i| * bound_i on either side, exactly. For an error common to all satellites that the
bounds do not include, `dilution` gives its greatest effect.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

from safeloc.errors import InputError
from safeloc.language.units import MM_PER_M
from safeloc.sensing.rounding import ExactBounds, exactly, hull
from safeloc.sensing.satellite.places import Vector
from safeloc.sensing.satellite.predicted import Predicted
from safeloc.sensing.satellite.track_fit import Sight, TrackFit, fit, slope_ppm
from safeloc.sensing.satellite.track_prediction import OnTrack, Portion

_ROUNDING = 2
"""mm or mm/s. Rounding of a difference adds up to 1, slopes in millionths half of that up to 1 km away, floats less."""
_SLOPE, _SLOPES_FREE_M = Fraction(1, 2_000_000), 1_000
"""Half a millionth of the correction; the part for 1 km is included in the rounding."""
NEAREST_M, FASTEST_M_PER_S = 19_000_000, 5_000
"""No navigation satellite is nearer, or faster relative to the Earth."""
Weighting = Literal["equal", "elevation"]


@dataclass(frozen=True, slots=True)
class Estimate:
    """The estimate E*(t) at which to linearise, with its margins in m and m/s."""

    margin_m: float
    speed_m_per_s: float
    speed_margin_m_per_s: float


@dataclass(frozen=True, slots=True)
class Bounds:
    """Error bounds on a used satellite's differences, mm and mm/s; None: this quantity is neither compared nor solved."""

    range_mm: int | None
    speed_mm_s: int | None

    def on_track(self, estimate: Estimate, portion: Portion, distance_m: float) -> Bounds:
        """Return the bounds with the cost of linearising at this distance: the bend of the track, the turn of the sight."""
        reach, margin = exactly(estimate.margin_m), exactly(estimate.speed_margin_m_per_s)
        fastest = abs(exactly(estimate.speed_m_per_s)) + margin
        low_m, high_m = distance_m - estimate.margin_m, distance_m + estimate.margin_m
        bend = exactly(portion.bend_per_m(max(low_m, portion.start_m), min(high_m, portion.end_m)))
        off_m = (bend / 2 + Fraction(1, 2 * NEAREST_M)) * reach**2 + _slopes(reach)
        turn_m_s = (fastest * bend + Fraction(FASTEST_M_PER_S, NEAREST_M)) * reach + _slopes(margin)
        return Bounds(_more(self.range_mm, off_m), _more(self.speed_mm_s, turn_m_s))


def _slopes(correction: Fraction) -> Fraction:
    """Return the error from slopes in whole millionths beyond that included in the rounding."""
    return max(Fraction(0), correction - _SLOPES_FREE_M) * _SLOPE


def _more(bound: int | None, metres: Fraction) -> int | None:
    """Return a bound in mm (or mm/s) increased by this much and the rounding, rounded up."""
    return None if bound is None else bound + math.ceil(metres * MM_PER_M) + _ROUNDING


@dataclass(frozen=True, slots=True)
class Look:
    """The used satellites seen from the prediction on one portion: differences in mm and mm/s, and predictions."""

    place: OnTrack
    bounds: Bounds
    off_mm: Mapping[str, int]
    speed_off_mm_s: Mapping[str, int]
    predictions: Mapping[str, Predicted]

    @property
    def measured(self) -> frozenset[str]:
        """The satellites with a difference in each quantity that is solved."""
        solved = ((self.bounds.range_mm, self.off_mm), (self.bounds.speed_mm_s, self.speed_off_mm_s))
        return frozenset(self.predictions).intersection(*(off for bound, off in solved if bound is not None))


@dataclass(frozen=True, slots=True)
class Solved:
    """Fits of place and speed on one portion, with their bounds; None if not solved."""

    bounds: Bounds
    place: TrackFit | None
    speed: TrackFit | None

    def off_mm(self) -> ExactBounds | None:
        """Return the vehicle's distance along the track beyond the prediction."""
        return _interval(self.place, self.bounds.range_mm)

    def speed_off_mm_s(self) -> ExactBounds | None:
        """Return the vehicle's speed above the prediction."""
        return _interval(self.speed, self.bounds.speed_mm_s)


def _interval(found: TrackFit | None, bound: int | None) -> ExactBounds | None:
    if found is None or bound is None:
        return None
    return ExactBounds(found.along, found.along).widened(found.protection_level(bound))


@dataclass(frozen=True, slots=True)
class Solution:
    """The solution of one cycle over all portions. The hull contains the true place, since the vehicle is on one of them."""

    solved: tuple[Solved, ...]
    used: frozenset[str]

    @property
    def unknowns(self) -> int:
        """The greatest number of unknowns of its fits."""
        return max(one.unknowns for both in self.solved for one in (both.place, both.speed) if one is not None)

    def dilution(self) -> Fraction:
        """Return the greatest shift of the place by errors of 1 in each used range, on any portion; 0 if none was solved."""
        return max((one.place.dilution for one in self.solved if one.place is not None), default=Fraction(0))

    def speed_dilution(self) -> Fraction:
        """Return the greatest shift of the speed by errors of 1 in each used range rate; 0 if none was solved."""
        return max((one.speed.dilution for one in self.solved if one.speed is not None), default=Fraction(0))

    def off_mm(self) -> ExactBounds | None:
        """Return the vehicle's distance beyond the prediction; None if it was not solved on every portion."""
        return _hull([one.off_mm() for one in self.solved])

    def speed_off_mm_s(self) -> ExactBounds | None:
        """Return the vehicle's speed above the prediction; None if it was not solved on every portion."""
        return _hull([one.speed_off_mm_s() for one in self.solved])


def _hull(found: Sequence[ExactBounds | None]) -> ExactBounds | None:
    known = [one for one in found if one is not None]
    return hull(known) if known and len(known) == len(found) else None


def solve(
    looks: Sequence[Look], used: frozenset[str], *, free: bool = False, weighting: Weighting = "equal"
) -> Solution:
    """Solve on every look. With `free` the directions across the track are unknown too.

    InputError without a solution: too few satellites, or a geometry in which place and clock cannot be separated.
    """
    return Solution(tuple(_solved(look, used, free, weighting) for look in looks), used)


def _solved(look: Look, used: frozenset[str], free: bool, weighting: Weighting) -> Solved:
    def fitted(off: Mapping[str, int]) -> TrackFit:
        return fit({name: _sight(look, name, off[name], free, weighting) for name in sorted(used)})

    place = None if look.bounds.range_mm is None else fitted(look.off_mm)
    speed = None if look.bounds.speed_mm_s is None else fitted(look.speed_off_mm_s)
    return Solved(look.bounds, place, speed)


def _sight(look: Look, name: str, difference: int, free: bool, weighting: Weighting) -> Sight:
    seen = look.predictions[name]
    across = tuple(slope_ppm(seen.direction, side) for side in _sides(look.place.along)) if free else ()
    weight = Fraction(1) if weighting == "equal" else Fraction(max(1, round(100 * math.sin(seen.elevation_rad) ** 2)))
    return Sight(difference, slope_ppm(seen.direction, look.place.along), weight, across, name[0])


def _sides(along: Vector) -> tuple[Vector, Vector]:
    """Return two unit vectors across the track, at right angles to each other."""
    least = min(range(3), key=lambda axis: abs(along[axis]))
    axis: Vector = (float(least == 0), float(least == 1), float(least == 2))
    first = _unit(_cross(along, axis))
    return first, _unit(_cross(along, first))


def _cross(a: Vector, b: Vector) -> Vector:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def _unit(a: Vector) -> Vector:
    length = math.hypot(*a)
    if not length > 0:
        raise InputError("the track has no direction here; declare no fix.")
    return a[0] / length, a[1] / length, a[2] / length
