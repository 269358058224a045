"""Excess length of satellite signals that are reflected: correlated in time, and between satellites that stand in similar directions.

    excess = deviation x ( sqrt(common) x process of its direction + sqrt(1 - common) x process of its own )

All processes are Gauss-Markov processes in time of deviation 1. Those of the directions stand around the horizon; a satellite between two of them
takes a part of either, cosine and sine of how far it is from the one to the other, which keeps the deviation.

The range rate of a signal that comes by the reflected path alone is that of the excess length: what it gains in a cycle. For that the length
must change steadily, so the processes may be smoothed.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from safeloc.simulation.many_runs import DrawnFigure
from safeloc.simulation.physics.gauss_markov import Floats, gauss_markov, kept, smoothed
from safeloc.simulation.vehicle_seed import VehicleSeed

DEVIATION, COMMON, LASTS = "multipath_mm", "multipath_common", "multipath_lasts"
RATE, SMOOTH, WINDOW = "multipath_rate", "multipath_smooth", "multipath_window"
FIGURES = {
    DEVIATION: DrawnFigure("mm", 0, 1e6, 0, "deviation of the excess length by reflections of each signal; 0: none"),
    COMMON: DrawnFigure("share", 0, 1, 0.5, "share of its variance that satellites in one direction have in common"),
    LASTS: DrawnFigure("cycles", 0, 1e6, 100, "time over which the excess length is correlated"),
    RATE: DrawnFigure("share", 0, 1, 0, "share of the change of the excess length that the range rate shows; 1: the reflected path alone"),
    SMOOTH: DrawnFigure("cycles", 0, 1e6, 0, "time over which the excess length is smoothed; 0: it is not"),
    WINDOW: DrawnFigure("cycles", 0, 1_000, 0, "window of the receiver's covariances; 0: they do not show reflections"),
}  # fmt: skip
"""[S] pseudoranges recorded in a city: 2.6 m in the line of sight, 20 m reflected; how far they are correlated [M]."""
DIRECTIONS = 8
_TURN = 2 * math.pi


@dataclass(frozen=True, eq=False)
class Reflections:
    """Reflected signals of vehicles: azimuth of each satellite, [satellite, vehicle], rad, and excess length, mm, [satellite, cycle, vehicle].

    change_mm  what the range rate shows of its change in each cycle; in the first cycle as in the second
    window     of the receiver's covariances, cycles, [vehicle]; 0: without reflections
    """

    azimuth: Floats
    excess_mm: Floats
    change_mm: Floats
    window: NDArray[np.int64]

    @property
    def changing(self) -> NDArray[np.bool_]:
        """Return for which vehicles range rates show reflections."""
        return np.asarray((self.change_mm != 0).any(axis=(0, 1)))


def shares_of(azimuth: float) -> list[float]:
    """Return the share that a satellite takes of the process of each direction."""
    place = azimuth % _TURN / _TURN * DIRECTIONS
    before = int(place) % DIRECTIONS
    angle = (place - int(place)) * math.pi / 2
    found = [0.0] * DIRECTIONS
    found[before], found[(before + 1) % DIRECTIONS] = math.cos(angle), math.sin(angle)
    return found


def reflections(
    figures: Mapping[str, Floats], seeds: Sequence[VehicleSeed], satellites: int, cycles: int
) -> Reflections:
    """Draw the reflections of vehicles; the first satellites are the same whatever follows."""
    azimuth = np.stack([seed.rng("azimuths").random(satellites) * _TURN for seed in seeds], axis=1)
    keep = kept(1, figures[LASTS].tolist())
    ways, own = (
        _processes(seeds, name, number, cycles, keep, kept(1, figures[SMOOTH].tolist()))
        for name, number in (("reflections by direction", DIRECTIONS), ("reflections", satellites))
    )
    common, rest = np.sqrt(figures[COMMON]), np.sqrt(1.0 - figures[COMMON])
    shares = np.array([[shares_of(one) for one in row] for row in azimuth.tolist()])
    found = np.empty_like(own)
    for satellite in range(satellites):
        of_way = np.zeros(own.shape[1:])
        for way in range(DIRECTIONS):
            of_way = of_way + shares[satellite, :, way] * ways[way]
        found[satellite] = figures[DEVIATION] * (common * of_way + rest * own[satellite])
    change = np.diff(found, axis=1, prepend=2 * found[:, :1] - found[:, 1:2] if cycles > 1 else found)
    return Reflections(azimuth, found, change * figures[RATE], np.rint(figures[WINDOW]).astype(np.int64))


def _processes(seeds: Sequence[VehicleSeed], name: str, number: int, cycles: int, keep: Floats, hold: Floats) -> Floats:
    """Return so many processes of each vehicle, array [process, cycle, vehicle], each with a stream of its own; smoothed where `hold` is above 0."""
    found = np.empty((number, cycles, len(seeds)))
    for process in range(number):
        noise = [seed.rng(f"{name} {process}").standard_normal(cycles) for seed in seeds]
        found[process] = gauss_markov(np.stack(noise, axis=1), keep)
        if (hold > 0).any():
            begin = np.array([seed.rng(f"{name} {process} begin").standard_normal() for seed in seeds])
            found[process] = np.where(hold > 0, smoothed(found[process], begin, keep, hold), found[process])
    return found
