"""Errors of a map that are correlated along the line: what was surveyed in one go errs alike.

    error of a place = offset, the same for the whole line, + a walk, which begins at place 0 and gathers along the line

Each vehicle draws a map of its own, so that vehicles stay independent trials; all of its sensors meet the same map.

Reflectors, and sections of a fibre, may have been surveyed with the balises or by themselves:

    error of such a place = common x that of the map + a walk of their own + each one's own, up to so much
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

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
REFLECTORS, SECTIONS = "reflector", "section"
_STEP_MM = 100_000
_STREAM = "map"


def figures_of_survey(things: str) -> dict[str, DrawnFigure]:
    """Return the figures of the survey of reflectors, or of sections of a fibre."""
    return {
        f"{things}_map_common": DrawnFigure("share", 0, 1, 0, f"share of the map's error that each {things} has, surveyed with the balises"),
        f"{things}_map_walk_mm": DrawnFigure("mm", 0, 1e6, 0, f"deviation of the error of each {things} that gathers along the line, after 1 km"),
        f"{things}_map_own_mm": DrawnFigure("mm", 0, 1e6, 0, f"error of each {things} by itself, at most"),
    }  # fmt: skip


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
    places, walk = _walk(seed, _STREAM, walk_mm, end_mm)
    return MapError(places, np.asarray(offset_mm + walk, dtype=np.float64), own_share)


def _walk(seed: VehicleSeed, stream: str, walk_mm: float, end_mm: int) -> tuple[Floats, Floats]:
    """Return places, and a walk that begins with 0 at place 0."""
    steps = max(1, -(-end_mm // _STEP_MM))
    drawn = seed.rng(stream).standard_normal(steps) * (walk_mm * (_STEP_MM / 1e6) ** 0.5)
    return np.arange(steps + 1, dtype=np.float64) * _STEP_MM, np.concatenate([[0.0], np.cumsum(drawn)])


@dataclass(frozen=True, eq=False)
class Survey:
    """The survey of reflectors, or of sections of a fibre, for each vehicle: the figures of `figures_of_survey`, arrays [vehicle].

    maps  the error of each vehicle's map
    """

    things: str
    figures: Mapping[str, Floats]
    seeds: Sequence[VehicleSeed]
    maps: Sequence[MapError]

    def _figure(self, which: str) -> Floats:
        return self.figures[f"{self.things}_map_{which}"]

    @property
    def errs(self) -> NDArray[np.bool_]:
        """Return for which vehicles these things err at all."""
        return np.asarray((self._figure("common") > 0) | (self._figure("walk_mm") > 0) | (self._figure("own_mm") > 0))

    def errors_mm(self, places_mm: Sequence[int]) -> Floats:
        """Return how far each thing lies beyond its place on the map: array [thing, vehicle]."""
        found, places = np.zeros((len(places_mm), len(self.seeds))), np.array(places_mm, dtype=np.float64)
        for vehicle in np.flatnonzero(self.errs).tolist():
            seed, own = self.seeds[vehicle], float(self._figure("own_mm")[vehicle])
            ends, walk = _walk(
                seed, f"map {self.things}", float(self._figure("walk_mm")[vehicle]), max(places_mm, default=0)
            )
            apart = seed.rng(f"map own {self.things}").uniform(-own, own, len(places_mm))
            common = float(self._figure("common")[vehicle]) * self.maps[vehicle].at(places)
            found[:, vehicle] = common + np.interp(places, ends, walk) + apart
        return found
