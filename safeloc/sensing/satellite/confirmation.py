"""Solves again from the satellites that a solution names, by another method, and compares (SAT-5; [0052], [0070]).

The solver may be wrong: its word on which satellites it used decides whether the solution counts. Here the share of every
named satellite follows anew: the columns of the clocks, and of the directions across the track, are taken out of the slopes
one by one (Gram-Schmidt), in floats, where the solver inverts the normal equations in fractions. A solution from other
signals than those named, or with a smaller dilution than theirs, differs from that.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from safeloc.sensing.satellite.places import Vector, dot
from safeloc.sensing.satellite.solution import Look, Solution, Solved, Weighting
from safeloc.sensing.satellite.track_fit import TrackFit

APART_MM, APART_SHARE = 1.0, 1e-4
"""The bound: 1 mm (mm/s), and a ten-thousandth of the correction, for slopes in whole millionths; of a dilution, this share."""
_ALIKE = 1e-9
"""Slopes of which so small a share is left cannot be told from clocks."""


def refuted(
    solution: Solution, looks: Sequence[Look], usable: frozenset[str], *, free: bool, weighting: Weighting
) -> str:
    """Return why the solution does not follow from usable satellites that it names; empty if it does."""
    foreign = sorted(solution.used - usable)
    if foreign:
        return f"names {', '.join(foreign)}, not usable in this cycle"
    if len(solution.solved) != len(looks):
        return f"has {len(solution.solved)} portions of track, of {len(looks)}"
    for solved, look in zip(solution.solved, looks, strict=True):
        why = _wrong(solved, look, solution.used, free, weighting)
        if why:
            return why
    return ""


def _wrong(solved: Solved, look: Look, used: frozenset[str], free: bool, weighting: Weighting) -> str:
    if solved.bounds != look.bounds:
        return "has other bounds of the further errors than the track gives"
    rows = (
        ("place", solved.place, look.bounds.range_mm, look.off_mm),
        ("speed", solved.speed, look.bounds.speed_mm_s, look.speed_off_mm_s),
    )
    for name, found, bound, off in rows:
        if (found is None) is not (bound is None):
            return f"has a {name} where none is compared, or none where one is"
        if found is not None:
            why = _differs(found, _again(look, used, off, free=free, weighting=weighting))
            if why:
                return f"its {name} {why}"
    return ""


@dataclass(frozen=True, slots=True)
class _Again:
    """The correction along the track, its dilution, and the number of unknowns, as solved again; None: nothing follows."""

    along: float
    dilution: float
    unknowns: int


def _differs(told: TrackFit, again: _Again | None) -> str:
    if again is None:
        return "does not follow from the satellites named: they have no such measurements, or stand alike"
    along, dilution = float(told.along), float(told.dilution)
    if not abs(along - again.along) <= APART_MM + APART_SHARE * abs(again.along):
        return f"is {along:.1f}, and {again.along:.1f} follows from the satellites named"
    if not abs(dilution - again.dilution) <= APART_SHARE * again.dilution:
        return f"has the dilution {dilution:.4f}, and {again.dilution:.4f} follows from the satellites named"
    if told.unknowns != again.unknowns:
        return f"has {told.unknowns} unknowns, and the satellites named {again.unknowns}"
    return ""


def _again(
    look: Look, used: frozenset[str], off: Mapping[str, int], *, free: bool, weighting: Weighting
) -> _Again | None:
    names = sorted(used)
    if not names or any(name not in off or name not in look.predictions for name in names):
        return None
    seen = [look.predictions[name] for name in names]
    weights = [1.0 if weighting == "equal" else _by_elevation(one.elevation_rad) for one in seen]
    clocks = sorted({name[0] for name in names})
    columns = [[float(name[0] == clock) for name in names] for clock in clocks]
    columns += [[-dot(one.direction, side) for one in seen] for side in (_sides(look.place.along) if free else ())]
    slopes = [-dot(one.direction, look.place.along) for one in seen]
    left = _taken_out(slopes, columns, weights)
    size = _product(left, left, weights)
    if not size > _ALIKE * _product(slopes, slopes, weights):
        return None
    shares = [weight * part / size for weight, part in zip(weights, left, strict=True)]
    along = math.fsum(share * off[name] for share, name in zip(shares, names, strict=True))
    return _Again(along, math.fsum(map(abs, shares)), 1 + len(columns))


def _by_elevation(elevation_rad: float) -> float:
    """Return a weight: the square of the sine of the elevation, in hundredths, at least one."""
    return float(max(1, round(100 * math.sin(elevation_rad) ** 2)))


def _taken_out(values: list[float], columns: Sequence[list[float]], weights: Sequence[float]) -> list[float]:
    """Return what of the values no sum of the columns makes."""
    basis = list[list[float]]()
    for column in [*columns, values]:
        rest = column
        for _ in range(2):  # the second pass takes out what rounding left
            for one in basis:
                factor = _product(rest, one, weights) / _product(one, one, weights)
                rest = [a - factor * b for a, b in zip(rest, one, strict=True)]
        if column is values:
            return rest
        if _product(rest, rest, weights) > _ALIKE * _product(column, column, weights):
            basis.append(rest)
    return values


def _sides(along: Vector) -> tuple[Vector, Vector]:
    """Return two directions across the track: any two that span the plane give the same share along it."""
    x, y, z = along
    first = (0.0, z, -y) if abs(y) + abs(z) > abs(x) else (y, -x, 0.0)
    second = (y * first[2] - z * first[1], z * first[0] - x * first[2], x * first[1] - y * first[0])
    return first, second


def _product(a: Sequence[float], b: Sequence[float], weights: Sequence[float]) -> float:
    return math.fsum(w * x * y for w, x, y in zip(weights, a, b, strict=True))
