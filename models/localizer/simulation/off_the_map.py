"""Things that are off their places on the map: reflectors, balises where the radar's machine reads them, and sections of a fibre."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from safeloc.language.units import NM_PER_MM
from safeloc.models.balise.simulation.passages import antenna_timing
from safeloc.models.localizer.simulation.journey import SECTION_SPACING, Vehicles
from safeloc.models.reflector.simulation.misplaced import Misplaced
from safeloc.models.reflector.simulation.scene import Balise
from safeloc.simulation.physics.gauss_markov import Floats
from safeloc.simulation.physics.map_errors import REFLECTORS, SECTIONS
from safeloc.simulation.physics.reader_timing import Way

_OF_THE_RADAR = ("radar shifted",)
"""Faults of a journey that set the radar's error, which the world then has no choice of."""
_UNREAD_MM = 1e9
"""A place beyond every line: a balise there is never read."""


def reflectors_err(vehicles: Vehicles) -> NDArray[np.bool_]:
    """Return for which vehicles reflectors err, and the radar has no fault with a name: array [vehicle]."""
    found = vehicles.survey(REFLECTORS).errs
    for kind in _OF_THE_RADAR:
        found = found & ~vehicles.having(kind)
    return found


def misplaced(vehicles: Vehicles, read_by_radar: Sequence[Balise]) -> Misplaced | None:
    """Return what is not where the map has it; None if everything is.

    read_by_radar  balises that the radar's machine reads itself; none where the balise machine reads them
    """
    survey, route = vehicles.survey(REFLECTORS), vehicles.first.reflectors
    seen = sorted({one.position_mm for one in (*route.reflectors, *route.beside)})
    balises = [one.position_mm for one in read_by_radar]
    read = _where_read(vehicles, balises, survey.errs)
    if not survey.errs.any() and not read.any():
        return None
    errors = survey.errors_mm(seen)
    return Misplaced(
        dict(zip(seen, errors, strict=True)), dict(zip(balises, read, strict=True)), reflectors_err(vehicles)
    )


def _where_read(vehicles: Vehicles, places_mm: list[int], surveyed: NDArray[np.bool_]) -> Floats:
    """Return how far beyond its place on the map each balise is read, mm: array [balise, vehicle].

    surveyed  vehicles whose balises have the error of the map here as well, because their reflectors err too
    """
    found = np.zeros((len(places_mm), len(vehicles.seeds)))
    period_ms = vehicles.motions.period_ms
    for vehicle, seed in enumerate(vehicles.seeds):
        timing, rng = antenna_timing(vehicles.figures, vehicle, seed)
        if surveyed[vehicle]:
            found[:, vehicle] = vehicles.maps[vehicle].at(np.array(places_mm, dtype=np.float64))
        if timing.plain:
            continue
        way = Way(vehicles.motions.start_nm, vehicles.motions.position_nm[:, vehicle], period_ms)
        drawn = timing.latencies(rng, len(places_mm))
        for number, place in enumerate(places_mm):
            met_ms = way.time_ms((place + float(found[number, vehicle]) - timing.mounting_mm) * NM_PER_MM)
            if met_ms is not None and not drawn.heard(number, way.speed_mm_s(met_ms)):
                found[number, vehicle] = _UNREAD_MM
            elif met_ms is not None:
                found[number, vehicle] = way.at_nm(met_ms + float(drawn.late_ms[number])) / NM_PER_MM - place
    return found


def sections_off_mm(vehicles: Vehicles, front_mm: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return how far the last section that each front passed lies beyond its place on the map: array [cycle, vehicle].

    The fibre counts from there on, so it puts a front that far too near. The first section is where the stretch begins.
    """
    survey, stretch = vehicles.survey(SECTIONS), vehicles.first.fibre
    found = np.zeros(front_mm.shape, dtype=np.int64)
    if stretch is None:
        return found
    spacings = np.rint(vehicles.figures[SECTION_SPACING]).astype(np.int64)
    for spacing in np.unique(spacings[survey.errs]).tolist():
        places = list(range(stretch.begin_mm, stretch.end_mm, spacing))
        errors = np.rint(survey.errors_mm(places)).astype(np.int64)
        last = np.clip((front_mm - stretch.begin_mm) // spacing, 0, len(places) - 1)
        which = survey.errs & (spacings == spacing)
        found[:, which] = np.take_along_axis(errors, last, axis=0)[:, which]
    return found
