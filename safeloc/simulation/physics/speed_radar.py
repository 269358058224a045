"""A Doppler radar that measures the speed over ground: how it is mounted, the ground under it, noise, and a dead band.

speed    true speed x (1 + mounting + ground) + noise; 0 below the dead band, and at standstill
counted  its integral, in whole mm
told     what was gained since the last cycle in which it was told

The ground (ballast, slab, snow, water) is that of the line, so it errs alike for all radars of a vehicle that look at it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from safeloc.language.units import NM_PER_MM
from safeloc.simulation.many_runs import DrawnFigure
from safeloc.simulation.physics.gauss_markov import Floats
from safeloc.simulation.physics.telling import Devices, gains

SHARED_RADAR = "speed_radar"
"""The name of the figures of a vehicle's speed radars where several machines read the front one."""
GROUND = "ground_correlation_mm"
"""The length over which the ground is correlated along the line, of all radars of a vehicle."""
FIGURES = {
    GROUND: DrawnFigure("mm", 0, 1e7, 200_000, "length over which the ground under speed radars is correlated along the line")
}  # fmt: skip


def figures_of_radar(name: str) -> dict[str, DrawnFigure]:
    """Return the figures of a speed radar that is simulated from its physics; how grounds differ and the dead band [M]."""
    return {
        f"{name}_noise_mm_s": DrawnFigure("mm/s", 0, 10_000, 0, f"deviation of the speed that {name} measures in a cycle; 0: it errs as its law says, not by physics"),
        f"{name}_mounting_ppm": DrawnFigure("ppm", -200_000, 200_000, 0, f"how much too far {name} measures: one degree off an angle of 45 degrees 17 500"),
        f"{name}_ground_ppm": DrawnFigure("ppm", 0, 200_000, 3_000, f"deviation of what the ground adds to what {name} measures"),
        f"{name}_dead_mm_s": DrawnFigure("mm/s", 0, 10_000, 0, f"speed up to which {name} measures 0"),
    }  # fmt: skip


@dataclass(frozen=True, eq=False)
class SpeedRadars(Devices):
    """A radar of each of several vehicles, with the figures of `figures_of_radar`."""

    @property
    def by_physics(self) -> NDArray[np.bool_]:
        """Return which vehicles have a radar that is simulated from its physics."""
        return np.asarray(self._figure("noise_mm_s") > 0)

    def told_mm(
        self, true_nm: NDArray[np.int64], ground: Floats, present: NDArray[np.bool_], period_ms: int
    ) -> NDArray[np.int64]:
        """Return what the radars tell in each cycle: arrays [cycle, vehicle], as the arguments.

        true_nm  true distances
        ground   under the radar, with deviation 1
        present  whether it tells anything
        """
        seconds = period_ms / 1_000
        noise = np.stack(
            [seed.rng(f"speed radar {self.stream}").standard_normal(len(true_nm)) for seed in self.seeds], axis=1
        )
        speed = true_nm / (NM_PER_MM * seconds)
        scale = 1.0 + (self._figure("mounting_ppm") + self._figure("ground_ppm") * ground) / 1e6
        measured = speed * scale + self._figure("noise_mm_s") * noise
        heard = np.where(np.abs(speed) > self._figure("dead_mm_s"), measured, 0.0)
        return gains(np.rint(np.cumsum(heard * seconds, axis=0)).astype(np.int64), present)
