"""The simulated cable: cells of fibre with scatterers, their places along the track, and their coupling to the ground.

Places along the fibre are in m of cable from the coupler, places along the track in m from the beginning of the map. A loop of
cable in a shaft is fibre at a single place of the track.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from safeloc.config import Config, quantity
from safeloc.errors import InputError
from safeloc.sensing.array_types import Floats
from safeloc.sensing.fibre.figures import Interrogator

Complex = NDArray[np.complex64]


@dataclass(frozen=True)
class Section:
    """A localization section (m of cable) whose coupling to the rail, or material, is `factor` times as sensitive."""

    from_m: float
    to_m: float
    factor: float
    by: Literal["coupling", "material"] = "coupling"


class CableFigures(Config):
    """Unevenness of a cable."""

    cell_mm: int = quantity(2_500, "mm", 100, 10_000, "[D] scatterers are put together in cells, several to a pulse")
    coupling_cdb: int = quantity(200, "cdB", 0, 1_500, "[M] standard deviation of the coupling along the fibre")
    coupling_mm: int = quantity(100_000, "mm", 1_000, 10_000_000, "[M] over which coupling is alike")
    point_amplitude: int = quantity(30, "scatterers", 1, 10_000, "[M] an inserted reflecting point")
    end_amplitude: int = quantity(300, "scatterers", 1, 100_000, "[M] a cleaved end without an absorber")
    ghost_percent: int = quantity(5, "% of amplitude", 0, 100, "[M] what such an end sends back into the fibre")


@dataclass(frozen=True, eq=False)
class Cable:
    """Cells from the coupler to the end. Shapes [cells].

    track_m      place of each cell along the track
    coupling     share of the ground's strain that reaches the fibre
    material     phase for a strain, relative to plain fibre
    scatterers   amplitude and phase of the backscatter of each cell
    ghost        amplitude that the end reflects back into the fibre (0: absorbed)
    """

    cell_m: float
    track_m: Floats
    coupling: Floats
    material: Floats
    scatterers: Complex
    ghost: float

    @property
    def places_m(self) -> Floats:
        """The middle of each cell along the fibre, m."""
        return np.asarray((np.arange(len(self.track_m)) + 0.5) * self.cell_m, dtype=np.float64)


def cable(
    interrogator: Interrogator,
    rng: np.random.Generator,
    *,
    figures: CableFigures | None = None,
    map_points: Sequence[tuple[float, float]] = (),
    sections: Sequence[Section] = (),
    points_m: Sequence[float] = (),
    absorber: bool = True,
) -> Cable:
    """Return a cable laid by `map_points` (fibre m, track m), one to one without any, with reflecting points at `points_m`."""
    figures = figures or CableFigures()
    cell = figures.cell_mm / 1_000
    places: Floats = (np.arange(interrogator.fibre_mm // figures.cell_mm) + np.float64(0.5)) * np.float64(cell)
    scatter = (rng.standard_normal(len(places)) + 1j * rng.standard_normal(len(places))) / np.sqrt(2)
    for point in points_m:
        scatter[_cell(point, places, cell)] += figures.point_amplitude
    if not absorber:
        scatter[-1] += figures.end_amplitude
    return Cable(
        cell,
        _laid(places, map_points),
        _coupling(len(places), figures, rng) * _factor(places, sections, "coupling"),
        _factor(places, sections, "material"),
        scatter.astype(np.complex64),
        0.0 if absorber else figures.ghost_percent / 100,
    )


def _cell(place: float, places: Floats, cell: float) -> int:
    number = int(place // cell)
    if not 0 <= number < len(places):
        raise InputError(f"a reflecting point at {place} m is not on a fibre of {len(places) * cell} m.")
    return number


def _laid(places: Floats, map_points: Sequence[tuple[float, float]]) -> Floats:
    if not map_points:
        return places
    points = np.array(map_points, dtype=np.float64)
    if np.any(np.diff(points[:, 0]) <= 0):
        raise InputError("map points have to be in ascending order of fibre.")
    return np.interp(places, points[:, 0], points[:, 1])


def _coupling(cells: int, figures: CableFigures, rng: np.random.Generator) -> Floats:
    """Return the coupling: lognormal, correlated over `coupling_mm` (white noise smoothed by a Gaussian)."""
    width = figures.coupling_mm / figures.cell_mm
    reach = np.arange(-int(3 * width), int(3 * width) + 1)
    weights = np.exp(-((reach / width) ** 2))
    white = rng.standard_normal(cells + len(reach) - 1)
    smooth = np.fft.irfft(
        np.fft.rfft(white, 2 * len(white)) * np.fft.rfft(weights / np.sqrt((weights**2).sum()), 2 * len(white))
    )[len(reach) - 1 : len(reach) - 1 + cells]
    gain: Floats = 10 ** (smooth * figures.coupling_cdb / 2_000)
    return gain


def _factor(places: Floats, sections: Sequence[Section], by: str) -> Floats:
    factor: Floats = np.ones(len(places))
    for section in sections:
        if section.by == by:
            factor[(places >= section.from_m) & (places < section.to_m)] *= section.factor
    return factor
