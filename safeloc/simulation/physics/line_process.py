"""A quantity along a line that is drawn for each section of track and correlated along it: a Gauss-Markov process with deviation 1.

Every device of a vehicle that comes over a section meets the same value there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from safeloc.language.units import NM_PER_MM
from safeloc.simulation.physics.gauss_markov import Floats, gauss_markov, kept
from safeloc.simulation.vehicle_seed import VehicleSeed

_SECTION_MM = 25_000


@dataclass(frozen=True, eq=False)
class LineProcess:
    """Values of vehicles, array [section, vehicle], from a place on; beyond either end they are those of the end."""

    values: Floats
    begin_mm: int

    def at(self, place_nm: NDArray[np.int64]) -> Floats:
        """Return the values at places, array [cycle, vehicle]."""
        section = (place_nm // NM_PER_MM - self.begin_mm) // _SECTION_MM
        return np.take_along_axis(self.values, np.clip(section, 0, len(self.values) - 1), axis=0)


def line_process(
    seeds: Sequence[VehicleSeed], stream: str, lengths_mm: Floats, begin_mm: int, end_mm: int
) -> LineProcess:
    """Draw the process of each vehicle from a place on to another one; a longer line begins with the shorter one."""
    sections = max(1, -(-(end_mm - begin_mm) // _SECTION_MM))
    noise = np.stack([seed.rng(stream).standard_normal(sections) for seed in seeds], axis=1)
    return LineProcess(gauss_markov(noise, kept(_SECTION_MM, lengths_mm.tolist())), begin_mm)
