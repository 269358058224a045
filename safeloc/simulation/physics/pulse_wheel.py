"""A wheel that counts pulses, on the rail: it creeps, is worn, is not quite round, and tells whole pulses in whole mm.

rim      true distance x (1 + creep)
counted  rim x (1 + scale) + eccentricity x (sine of the wheel's angle), in whole pulses
told     the counted distance in whole mm: what it gained since the last cycle in which it was told
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from safeloc.language.units import NM_PER_MM
from safeloc.simulation.many_runs import DrawnFigure
from safeloc.simulation.physics.creep import GRAVITY_MM_S2, creep_of
from safeloc.simulation.physics.gauss_markov import Floats
from safeloc.simulation.physics.rail import at_speed
from safeloc.simulation.physics.telling import Devices, gains

_DIAMETER_MM, _EDGES = 850, 200
_ROUND_MM = math.pi * _DIAMETER_MM
STEP_MM = _ROUND_MM / _EDGES
"""[S] 850 mm, 100 pulses a turn, both edges counted: 13.4 mm."""


def figures_of_wheel(name: str) -> dict[str, DrawnFigure]:
    """Return the figures of a wheel that is simulated from its physics."""
    return {
        f"{name}_scale_ppm": DrawnFigure("ppm", -200_000, 200_000, 0, f"how much too far {name} measures: a wheel worn from 850 to 780 mm 90 000"),
        f"{name}_eccentricity_mm": DrawnFigure("mm", 0, 20, 0, f"by how much the axle of {name} is out of its centre"),
        f"{name}_effort": DrawnFigure("share", 0, 20, 1, f"force of {name} as a share of its load, against that of the whole vehicle; 0: it rolls freely"),
        f"{name}_creep": DrawnFigure("share", 0, 0.1, 0.01, f"creep of {name} at which the adhesion of a dry rail is used up"),
        f"{name}_slide": DrawnFigure("share", 0, 1, 0.15, f"creep of {name} while it slips or slides; 1: it locks"),
    }  # fmt: skip


@dataclass(frozen=True, eq=False)
class PulseWheels(Devices):
    """A wheel of each of several vehicles, with the figures of `figures_of_wheel`."""

    def told_mm(
        self, true_nm: NDArray[np.int64], adhesion: Floats, present: NDArray[np.bool_], period_ms: int
    ) -> NDArray[np.int64]:
        """Return what the wheels tell in each cycle: arrays [cycle, vehicle], as the arguments.

        true_nm   true distances
        adhesion  at standstill, of the rail under the wheel
        present   whether it tells anything
        """
        speed = true_nm / (NM_PER_MM / 1_000 * period_ms)
        faster = np.diff(np.abs(speed), axis=0, prepend=np.abs(speed[:1])) / (period_ms / 1_000)
        wanted = self._figure("effort") * faster / GRAVITY_MM_S2
        creep = creep_of(wanted, adhesion * at_speed(speed), self._figure("creep"), self._figure("slide"), period_ms)
        rim_mm = np.cumsum(true_nm / NM_PER_MM * (1.0 + creep), axis=0)
        return gains(self._counted_mm(rim_mm), present)

    def _counted_mm(self, rim_mm: Floats) -> NDArray[np.int64]:
        """Return the distance counted up to the end of each cycle, whole mm."""
        found = np.empty(rim_mm.shape, dtype=np.int64)
        scale, off_centre = self._figure("scale_ppm"), self._figure("eccentricity_mm")
        for vehicle, seed in enumerate(self.seeds):
            angle, edge = seed.rng(f"pulses {self.stream}").random(2)
            rim = np.ascontiguousarray(rim_mm[:, vehicle])
            turned = np.sin(2 * math.pi * (rim / _ROUND_MM + angle)) - math.sin(2 * math.pi * angle)
            counted = rim * (1.0 + scale[vehicle] / 1e6) + off_centre[vehicle] * turned
            found[:, vehicle] = np.rint(np.floor(counted / STEP_MM + edge) * STEP_MM).astype(np.int64)
        return found
