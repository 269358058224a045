"""Fits position (or speed) along the track and clocks to the used satellites only, exactly (SAT-5; [0070]).

Model per satellite: difference = slope * s + clock + error, with the slope the change of pseudorange per metre along
the track (minus the line of sight's share along the track). With two unknowns, two satellites solve, three
detect a fault and four exclude one. Free of the track, the two directions across it are unknown too: four, five, six. Every
further constellation adds a clock, and so needs one more. The same fit gives speed and clock drift from range rates. All figures
are rational, so bounds hold exactly.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from operator import mul

from safeloc.errors import InputError
from safeloc.language.units import PPM_PER_ONE

_SOLVE, _DETECT, _EXCLUDE = 2, 3, 4


class NoSolution(InputError):
    """There is no solution. `why`: FEW_LEFT (fewer satellites than unknowns) or ALIKE (place and clock cannot be separated)."""

    def __init__(self, why: str, message: str) -> None:
        super().__init__(message)
        self.why = why


@dataclass(frozen=True, slots=True)
class Sight:
    """One used satellite: measured minus predicted (mm or mm/s), slope in millionths, and its weight (1/variance).

    across_ppm  slopes across the track, for a solution free of it
    clock       constellation whose clock its signals use; each clock is one unknown
    """

    difference: int
    slope_ppm: int
    weight: Fraction = Fraction(1)
    across_ppm: tuple[int, ...] = ()
    clock: str = "G"


@dataclass(frozen=True, slots=True)
class TrackFit:
    """The correction along the track and of the clocks, the share a_i of every satellite's error in it, and chi-square.

    Clocks are in the order of their names.
    """

    along: Fraction
    clocks: Mapping[str, Fraction]
    shares: Mapping[str, Fraction]
    chi_square: Fraction
    degrees_of_freedom: int

    @property
    def unknowns(self) -> int:
        """The number of solved unknowns."""
        return len(self.shares) - self.degrees_of_freedom

    @property
    def dilution(self) -> Fraction:
        """Sum |a_i|, the greatest shift of the correction by errors of 1 in each satellite. It is at least 1, as no slope exceeds 1."""
        return _sum(abs(share) for share in self.shares.values())

    def protection_level(self, bound: int | Mapping[str, int]) -> int:
        """Return sum |a_i| * bound_i, rounded up: the greatest error while each satellite's error is within its bound."""
        bounds = dict.fromkeys(self.shares, bound) if isinstance(bound, int) else bound
        wrong = [name for name in self.shares if bounds.get(name, -1) < 0]
        if wrong:
            raise InputError(f"the bound of {', '.join(wrong)} is missing or negative; give the bound of every error.")
        return math.ceil(_sum(abs(share) * bounds[name] for name, share in self.shares.items()))


def fit(sights: Mapping[str, Sight]) -> TrackFit:
    """Return the weighted least squares over the named satellites.

    NoSolution with fewer than two satellites or than unknowns, and if place and clock cannot be separated, as with equal
    slopes; InputError for a weight that is not positive.
    """
    if len(sights) < _SOLVE:
        raise NoSolution(
            "FEW_LEFT", f"{len(sights)} usable satellites; {_SOLVE} are needed to solve along the track: no fix."
        )
    if any(one.weight <= 0 for one in sights.values()):
        raise InputError("a weight must be positive; leave the satellite out instead.")
    clocks = sorted({one.clock for one in sights.values()})
    rows = {name: _row(one, clocks) for name, one in sights.items()}
    size = len(next(iter(rows.values())))
    if any(len(row) != size for row in rows.values()) or len(sights) < size:
        raise NoSolution("FEW_LEFT", f"{len(sights)} usable satellites for {size} unknowns: no fix.")
    weights = _as_integers([one.weight for one in sights.values()])
    normal, sums = _normal(list(rows.values()), weights, [one.difference for one in sights.values()])
    (first, over), (found, under) = _solved(normal, [1, *[0] * (size - 1)]), _solved(normal, sums)
    weighed = zip(rows.items(), weights, strict=True)
    shares = {name: Fraction(weight * _dot(row, first) * PPM_PER_ONE, over) for (name, row), weight in weighed}
    # columns are in millionths, also those of clocks, so their unknowns are in millions
    terms = zip(clocks, found[size - len(clocks) :], strict=True)
    residuals = (one.weight * (one.difference * under - _dot(rows[name], found)) ** 2 for name, one in sights.items())
    return TrackFit(
        Fraction(found[0] * PPM_PER_ONE, under),
        {clock: Fraction(term * PPM_PER_ONE, under) for clock, term in terms},
        shares,
        sum(residuals, Fraction(0)) / under**2,
        len(sights) - size,
    )


def _row(one: Sight, clocks: Sequence[str]) -> list[int]:
    return [one.slope_ppm, *one.across_ppm, *(PPM_PER_ONE if clock == one.clock else 0 for clock in clocks)]


def _as_integers(weights: Sequence[Fraction]) -> list[int]:
    """Return the weights times a common factor, as whole numbers."""
    factor = math.lcm(*(weight.denominator for weight in weights))
    return [weight.numerator * (factor // weight.denominator) for weight in weights]


def _normal(
    rows: Sequence[list[int]], weights: Sequence[int], values: Sequence[int]
) -> tuple[list[list[int]], list[int]]:
    """Return the normal equations: weighted products of the rows, and their weighted sums with the values."""
    size = range(len(rows[0]))
    every = list(zip(rows, weights, values, strict=True))
    products = [[sum(weight * row[i] * row[j] for row, weight, _ in every) for j in size] for i in size]
    return products, [sum(weight * row[i] * value for row, weight, value in every) for i in size]


def _solved(matrix: Sequence[Sequence[int]], right: Sequence[int]) -> tuple[list[int], int]:
    """Return the exact solution of equations in whole numbers, over one divisor (by Bareiss, without fractions).

    NoSolution if there is none.
    """
    rows = [[*row, value] for row, value in zip(matrix, right, strict=True)]
    size, last = len(rows), 1
    for at in range(size):
        pivot = next((n for n in range(at, size) if rows[n][at]), None)
        if pivot is None:
            raise NoSolution(
                "ALIKE", "all satellites stand alike to the track: place and clock cannot be separated, no fix."
            )
        rows[at], rows[pivot] = rows[pivot], rows[at]
        head = rows[at]
        rows = [
            row if row is head else [(head[at] * a - row[at] * b) // last for a, b in zip(row, head, strict=True)]
            for row in rows
        ]
        last = head[at]
    return [row[size] for row in rows], last


def slope_ppm(direction: tuple[float, float, float], track: tuple[float, float, float]) -> int:
    """Return the slope of a satellite from unit vectors to it and along the track, to the nearest millionth.

    Rounding costs half a micrometre for each metre of correction. InputError for a figure that is not finite.
    """
    share = sum(a * b for a, b in zip(direction, track, strict=True))
    if not math.isfinite(share):
        raise InputError("a direction is not finite; declare no fix.")
    return round(-share * 1e6)


def _dot(row: Sequence[int], found: Sequence[int]) -> int:
    return sum(map(mul, row, found))


def _sum(values: Iterable[Fraction]) -> Fraction:
    return sum(values, Fraction(0))
