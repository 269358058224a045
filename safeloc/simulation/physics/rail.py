"""Adhesion of the rail along a line: drawn for each section of track, and correlated along it.

The logarithm of a section's adhesion is a Gauss-Markov process along the line about that of the median. Adhesion falls with speed as
Curtius and Kniffler measured it. Every wheel of a vehicle that rolls over a section meets the same adhesion there.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from safeloc.simulation.many_runs import DrawnFigure
from safeloc.simulation.physics.gauss_markov import Floats
from safeloc.simulation.physics.line_process import LineProcess, line_process
from safeloc.simulation.vehicle_seed import VehicleSeed

ADHESION, SPREAD, CORRELATION = "adhesion", "adhesion_spread", "adhesion_correlation_mm"
FIGURES = {
    ADHESION: DrawnFigure(
        "share", 0, 0.6, 0, "median adhesion of the rail at standstill; 0: wheels err as their law says, not by physics"
    ),
    SPREAD: DrawnFigure("share", 0, 3, 0.3, "deviation of the logarithm of a section's adhesion"),
    CORRELATION: DrawnFigure("mm", 0, 1e7, 200_000, "length over which adhesion is correlated along the line"),
}
"""Figures of a rail: [S] 0.3 dry, 0.2 wet, below 0.05 with leaves or ice; how it differs along the line [M]."""
_MOST = 0.6
_STREAM = "rail"


def at_speed(speed_mm_s: Floats) -> Floats:
    """Return the share of the adhesion at standstill that is left at a speed ([S] Curtius and Kniffler)."""
    return (7.5 / (np.abs(speed_mm_s) * 0.0036 + 44) + 0.161) / (7.5 / 44 + 0.161)


def rail_of(
    seeds: Sequence[VehicleSeed], medians: Floats, spreads: Floats, lengths_mm: Floats, begin_mm: int, end_mm: int
) -> LineProcess:
    """Draw the rail of each vehicle, its adhesion at standstill, from a place on to another one."""
    drawn = line_process(seeds, _STREAM, lengths_mm, begin_mm, end_mm).values
    found = np.empty_like(drawn)
    for vehicle, (median, spread) in enumerate(zip(medians.tolist(), spreads.tolist(), strict=True)):
        found[:, vehicle] = [min(_MOST, median * math.exp(spread * one)) for one in drawn[:, vehicle].tolist()]
    return LineProcess(found, begin_mm)
