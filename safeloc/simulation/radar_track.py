"""Computes the true places of the radar's antenna and the reflectors, on tracks of straights and curves.

A vehicle that turns off at a switch follows its own track; each reflector stands beside the track to which it belongs.
Lengths in mm, angles in radians; x along the first straight, y to the left.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from safeloc.errors import InputError
from safeloc.sensing.figures import Reflectors
from safeloc.sensing.signature import MARKS, Model


@dataclass(frozen=True)
class Arc:
    """A piece of track; `radius_mm` positive: to the left, negative: to the right, 0: straight."""

    length_mm: float
    radius_mm: float = 0.0


@dataclass(frozen=True)
class Pose:
    """A place (mm) and the direction of the track there (radians)."""

    x: float
    y: float
    heading: float

    def aside(self, left_mm: float) -> tuple[float, float]:
        """Return the point beside the track."""
        return self.x - left_mm * math.sin(self.heading), self.y + left_mm * math.cos(self.heading)


def pose(track: Sequence[Arc], along_mm: float) -> Pose:
    """Return the place `along_mm` >= 0 from the track's beginning; beyond its end the track continues straight."""
    if along_mm < 0:
        raise InputError(f"{along_mm} mm lies before the beginning of the track.")
    here = Pose(0.0, 0.0, 0.0)
    for arc in track:
        here = _onwards(here, min(along_mm, arc.length_mm), arc.radius_mm)
        along_mm -= min(along_mm, arc.length_mm)
    return _onwards(here, along_mm, 0.0)


def _onwards(here: Pose, run: float, radius: float) -> Pose:
    if radius == 0:
        return Pose(here.x + run * math.cos(here.heading), here.y + run * math.sin(here.heading), here.heading)
    turned = here.heading + run / radius
    x = here.x + radius * (math.sin(turned) - math.sin(here.heading))
    return Pose(x, here.y - radius * (math.cos(turned) - math.cos(here.heading)), turned)


@dataclass(frozen=True)
class Reflector:
    """A reflector beside a track: its nearest corner `along_mm` from the beginning, `left_mm` to the left.

    lost  corners that are missing or turned away, by index from the nearest
    """

    model: Model
    along_mm: float
    left_mm: float = -3_000.0
    track: tuple[Arc, ...] = ()
    lost: tuple[int, ...] = ()


_CORNER_HEIGHTS_MM = (0.0, 200.0, 400.0)


def corners(reflector: Reflector, figures: Reflectors) -> NDArray[np.float64]:
    """Return the places of the corners, [corner, (x, y, height above the antenna)]; different heights keep all visible."""
    if reflector.model is Model.UNKNOWN:
        raise InputError("a reflector needs a model; take A, B, C or D.")
    made = []
    for index, mark in enumerate(MARKS[reflector.model]):
        if index in reflector.lost:
            continue
        where = pose(reflector.track, reflector.along_mm + mark * figures.unit_mm)
        made.append((*where.aside(reflector.left_mm), _CORNER_HEIGHTS_MM[index]))
    return np.array(made, dtype=np.float64).reshape(-1, 3)


def seen_from(antenna: Pose, places: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return slant range (mm) and sine of the angle to the left of places [place, 3]; places not ahead have range NaN."""
    dx, dy = places[:, 0] - antenna.x, places[:, 1] - antenna.y
    ahead = dx * math.cos(antenna.heading) + dy * math.sin(antenna.heading)
    left = dy * math.cos(antenna.heading) - dx * math.sin(antenna.heading)
    slant = np.sqrt(dx**2 + dy**2 + places[:, 2] ** 2)
    with np.errstate(invalid="ignore"):
        return np.where(ahead > 0, slant, np.nan), left / slant
