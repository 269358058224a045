"""Coupling of a fibre along its stretch: how strongly each axle is received, and which axles are so weak that they are missed.

    level of an axle = level where the stretch begins - loss x way from there + coupling of its place (- loss where the cable lies loose)
                       + fading of the block

Coupling is a Gauss-Markov process along the fibre, in dB, and so is whether the cable lies loose. An axle whose level is below the threshold, 0 dB, is
missed: then the front is where the first axle is that is received, and the length what lies between the first and the last.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import NormalDist

import numpy as np
from numpy.typing import NDArray

from safeloc.simulation.many_runs import DrawnFigure
from safeloc.simulation.physics.gauss_markov import Floats, gauss_markov, kept
from safeloc.simulation.vehicle_seed import VehicleSeed

LEVEL, LOSS, COUPLING, CORRELATION = "fibre_level_db", "fibre_loss_db_km", "fibre_coupling_db", "fibre_coupling_mm"
LOOSE, LOOSE_SHARE, FADING = "fibre_loose_db", "fibre_loose_share", "fibre_fading_db"
FIGURES = {
    LEVEL: DrawnFigure("dB", 0, 100, 0, "level of an axle above the threshold where the stretch begins; 0: the fibre finds every axle"),
    LOSS: DrawnFigure("dB/km", 0, 100, 0.4, "loss of light there and back along the stretch"),
    COUPLING: DrawnFigure("dB", 0, 40, 2, "deviation of the coupling along the fibre"),
    CORRELATION: DrawnFigure("mm", 0, 1e7, 100_000, "length over which coupling is correlated"),
    LOOSE: DrawnFigure("dB", 0, 100, 0, "loss of coupling where the cable lies loose"),
    LOOSE_SHARE: DrawnFigure("share", 0, 1, 0, "share of the fibre that lies loose"),
    FADING: DrawnFigure("dB", 0, 40, 1, "deviation of the level of each axle from block to block"),
}  # fmt: skip
"""[S] single-mode fibre 0.2 dB/km each way; coupling varies strongly along the fibre; by how much, 2 dB over 100 m, and fading [M]."""
_PIECE_MM = 10_000
"""Gauge length: the piece of fibre whose strain is one value."""


@dataclass(frozen=True, eq=False)
class Received:
    """The part of a train that is received in blocks, arrays [block]: axles, and how far the first and the last are behind the front; 0 without any."""

    axles: NDArray[np.int64]
    first_mm: NDArray[np.int64]
    last_mm: NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Coupled:
    """The fibre of one vehicle: level of each piece of the stretch, dB, from a place on; beyond either end it is that of the end."""

    levels_db: Floats
    begin_mm: int
    fading_db: float

    def received(self, front_mm: NDArray[np.int64], length_mm: int, axles: int, rng: np.random.Generator) -> Received:
        """Return what is received of a train in blocks in which its front is at these places; its axles are spaced evenly."""
        behind = np.rint(np.linspace(0, length_mm, axles)).astype(np.int64)
        piece = (front_mm[:, None] - behind - self.begin_mm) // _PIECE_MM
        level = self.levels_db[np.clip(piece, 0, len(self.levels_db) - 1)]
        heard = level + self.fading_db * rng.standard_normal(level.shape) > 0
        some = heard.any(axis=1)
        first, last = heard.argmax(axis=1), axles - 1 - heard[:, ::-1].argmax(axis=1)
        return Received(heard.sum(axis=1), np.where(some, behind[first], 0), np.where(some, behind[last], 0))


def coupled(
    figures: Mapping[str, Floats], seeds: Sequence[VehicleSeed], begin_mm: int, end_mm: int
) -> Mapping[int, Coupled]:
    """Draw the fibre of each vehicle that has a level, by its number."""
    pieces, found = max(1, -(-(end_mm - begin_mm) // _PIECE_MM)), dict[int, Coupled]()
    away_km = (np.arange(pieces) + 0.5) * (_PIECE_MM / 1e6)
    for vehicle in np.flatnonzero(figures[LEVEL] > 0).tolist():
        one = {name: float(figures[name][vehicle]) for name in FIGURES}
        keep = kept(_PIECE_MM, [one[CORRELATION]])
        uneven, loosely = (
            gauss_markov(seeds[vehicle].rng(stream).standard_normal((pieces, 1)), keep)[:, 0]
            for stream in ("fibre coupling", "fibre loose")
        )
        loose = loosely < _deviations_below(one[LOOSE_SHARE])
        levels = one[LEVEL] - one[LOSS] * away_km + one[COUPLING] * uneven - one[LOOSE] * loose
        found[vehicle] = Coupled(levels, begin_mm, one[FADING])
    return found


def _deviations_below(share: float) -> float:
    """Return what a standard normal value is below with this chance."""
    if share <= 0:
        return -np.inf
    return np.inf if share >= 1 else NormalDist().inv_cdf(share)
