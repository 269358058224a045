"""Errors of a map that are correlated along the line: what was surveyed in one go errs alike.

    error of a place = offset, the same for the whole line, + a walk, which begins at place 0 and gathers along the line

Each vehicle draws a map of its own, so that vehicles stay independent trials; all of its sensors meet the same map.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from safeloc.simulation.many_runs import DrawnFigure
from safeloc.simulation.physics.gauss_markov import Floats
from safeloc.simulation.vehicle_seed import VehicleSeed

OFFSET, WALK, OWN = "map_offset_mm", "map_walk_mm", "map_own_share"
OWN_SHARE = 0.9
FIGURES = {
    OFFSET: DrawnFigure("mm", -1e6, 1e6, 0, "error of the map that all places of the line have in common"),
    WALK: DrawnFigure("mm", 0, 1e6, 0, "deviation of the error that gathers along the line, after 1 km"),
    OWN: DrawnFigure("share", 0, 10, OWN_SHARE, "each place's own error, at most, as a share of its accuracy"),
}
_STEP_MM = 100_000
_STREAM = "map"


@dataclass(frozen=True, eq=False)
class MapError:
    """The error of one vehicle's map: places and errors between which it runs straight, mm; and each place's own, as a share."""

    places_mm: Floats
    errors_mm: Floats
    own_share: float

    def at(self, places_mm: Floats) -> Floats:
        """Return the common part of the error of places, mm: a place lies that far beyond where the map has it."""
        return np.asarray(np.interp(places_mm, self.places_mm, self.errors_mm), dtype=np.float64)


def map_error(seed: VehicleSeed, offset_mm: float, walk_mm: float, own_share: float, end_mm: int) -> MapError:
    """Draw the error of a vehicle's map up to the end of its line; that of a longer line begins alike."""
    steps = max(1, -(-end_mm // _STEP_MM))
    drawn = seed.rng(_STREAM).standard_normal(steps) * (walk_mm * (_STEP_MM / 1e6) ** 0.5)
    walk = np.concatenate([[0.0], np.cumsum(drawn)])
    places = np.arange(steps + 1, dtype=np.float64) * _STEP_MM
    return MapError(places, np.asarray(offset_mm + walk, dtype=np.float64), own_share)
