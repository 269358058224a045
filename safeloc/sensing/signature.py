"""Recognises a reflector's model from a group of echoes: three corners at unique marks (RFL-10).

The marks, in units along the track from the nearest corner, form a difference triangle set: each distance between two
corners from 1 to 12 units occurs once in all models together. In any overlay of two models at most one
corner coincides, so one model could look like another only if two of three corners were wrong at once. All three corners are
needed: two make no model.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from safeloc.sensing.array_types import Floats
from safeloc.sensing.figures import RadarConfig
from safeloc.sensing.images import in_cdb
from safeloc.sensing.range_law import is_lawful, section_cdbsm


class Model(Enum):
    """Models of reflectors. UNKNOWN stands for every echo that is not certainly one of them."""

    UNKNOWN = "UNKNOWN"
    A = "A"
    B = "B"
    C = "C"
    D = "D"


class Doubt(Enum):
    """Reasons why an echo has no model."""

    SHAPE = "no corners at the marks of a model"
    BALANCE = "corners too unequal"
    CROWDED = "a foreign echo among the corners"
    RANGE_LAW = "stronger or weaker than a corner can be at this range"
    WEAK = "below the minimum intensity"
    AMBIGUOUS = "the same echo fits two groups"
    GHOST = "behind a stronger one of the same model, where a detour would show it"


MARKS = {Model.A: (0, 1, 12), Model.B: (0, 3, 10), Model.C: (0, 4, 9), Model.D: (0, 2, 8)}


@dataclass(frozen=True, eq=False)
class Spots:
    """Echoes as places, in order of range: range in mm, sine of the angle (left: positive), and power."""

    range_mm: Floats
    sine: Floats
    power: Floats


@dataclass(frozen=True)
class Group:
    """Echoes at the marks of a model, nearest first, and these marks in units along the track from the nearest."""

    model: Model
    members: tuple[int, ...]
    marks: tuple[int, ...]
    doubt: Doubt | None = None


def groups(spots: Spots, config: RadarConfig) -> list[Group]:
    """Return every group of echoes with the shape of a model. No echo is in two groups without doubt."""
    shaped = [replace(group, doubt=_doubt(group, spots, config)) for group in _shaped(spots, config)]
    used = Counter(member for group in shaped if group.doubt is None for member in group.members)
    clear = [_ambiguous(group, used) for group in shaped if group.doubt is None]
    free = [group for group in shaped if group.doubt is not None and not any(used[one] for one in group.members)]
    return [_ghost(group, shaped, spots, config) for group in clear] + free


def _shaped(spots: Spots, config: RadarConfig) -> Iterator[Group]:
    if len(spots.power) == 0:
        return
    for model, marks in MARKS.items():
        found = [_beyond(mark * config.reflectors.unit_mm, spots, config) for mark in marks]
        complete = np.logical_and.reduce([mark.there for mark in found])
        for first in np.flatnonzero(complete):
            members = tuple(int(mark.strongest[first]) for mark in found)
            yield Group(model, members, marks)


@dataclass(frozen=True, eq=False)
class _Beyond:
    """For each echo, whether there are echoes at one mark, and the strongest of them."""

    there: NDArray[np.bool_]
    strongest: NDArray[np.intp]


def _beyond(along_mm: float, spots: Spots, config: RadarConfig) -> _Beyond:
    """Find the echoes `along_mm` beyond each echo, on a line parallel to the antenna's axis; 0 is the echo itself."""
    range_mm, sine = seen_at(spots.range_mm, spots.sine, along_mm)
    close = np.abs(spots.range_mm - range_mm[:, None]) <= config.reflectors.mark_tolerance_mm
    close &= np.abs(spots.sine - sine[:, None]) <= float(config.sensor.sine_cell) / 2
    if along_mm == 0:
        close &= np.eye(len(close), dtype=np.bool_)
    strongest = np.argmax(np.where(close, spots.power, -1.0), axis=1)
    there: NDArray[np.bool_] = np.logical_or.reduce(close, axis=1)
    return _Beyond(there, strongest)


def seen_at(range_mm: Floats, sine: Floats, along_mm: float) -> tuple[Floats, Floats]:
    """Return range and sine of the place `along_mm` beyond a point, on a line parallel to the antenna's axis."""
    ahead, aside = range_mm * np.sqrt(1 - sine * sine) + along_mm, range_mm * sine
    far = np.hypot(ahead, aside)
    return far, aside / far


# ------------------------------------------------------------------ doubts


def _doubt(group: Group, spots: Spots, config: RadarConfig) -> Doubt | None:
    powers = [float(spots.power[one]) for one in group.members]
    sections = [section_cdbsm(float(spots.power[one]), float(spots.range_mm[one]), config) for one in group.members]
    if in_cdb(min(powers)) < config.reflectors.minimum_cdb:
        return Doubt.WEAK
    if not all(is_lawful(section, config) for section in sections):
        return Doubt.RANGE_LAW
    if max(sections) - min(sections) > config.reflectors.balance_cdb:
        return Doubt.BALANCE
    return Doubt.CROWDED if _crowded(group, spots, min(powers), config) else None


def _crowded(group: Group, spots: Spots, weakest: float, config: RadarConfig) -> bool:
    """Return whether another strong echo lies between a unit before the first corner and a unit beyond the last."""
    unit, beam = config.reflectors.unit_mm, 2 * float(config.sensor.sine_cell)
    first, last = spots.range_mm[group.members[0]], spots.range_mm[group.members[-1]]
    inside = (spots.range_mm >= first - unit) & (spots.range_mm <= last + unit)
    inside &= np.abs(spots.sine - spots.sine[group.members[0]]) <= beam
    inside &= spots.power >= weakest / 10 ** (config.reflectors.purity_cdb / 1_000)
    inside[list(group.members)] = False
    return bool(inside.any())


def _ambiguous(group: Group, used: Counter[int]) -> Group:
    shared = any(used[member] > 1 for member in group.members)
    return replace(group, doubt=Doubt.AMBIGUOUS) if shared else group


def _ghost(group: Group, others: list[Group], spots: Spots, config: RadarConfig) -> Group:
    """Mark the group as a ghost if a nearer, stronger one of its model is direct: a detour keeps the shape.

    A detour by a wall is only a little longer: less than the spacing of two reflectors of one model. If the vehicle's own
    front sends an echo to a corner once more, the ranges of two corners add up.
    """
    return (
        replace(group, doubt=Doubt.GHOST) if any(_shadows(other, group, spots, config) for other in others) else group
    )


def _shadows(direct: Group, later: Group, spots: Spots, config: RadarConfig) -> bool:
    first, last, place = (
        float(spots.range_mm[one]) for one in (direct.members[0], direct.members[-1], later.members[0])
    )
    tolerance = config.reflectors.mark_tolerance_mm
    beside = 0 < place - first < config.reflectors.equal_spacing_mm
    twice = 2 * first - tolerance <= place <= 2 * last + tolerance
    weaker = bool(spots.power[later.members[0]] < spots.power[direct.members[0]])
    return direct.model is later.model and weaker and (beside or twice)
