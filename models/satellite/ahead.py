"""The predicted state E*(t) in figures: what the machine predicts in its step, for the signals to be predicted from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from safeloc.language.nodes import Value
from safeloc.language.units import NM_PER_M, UM_PER_M
from safeloc.models.satellite.variables import SatelliteConfig
from safeloc.sensing.satellite.solution import Estimate
from safeloc.sensing.satellite.track_prediction import TrackState


@dataclass(frozen=True, slots=True)
class Ahead:
    """Estimated place and speed at the time of the cycle, with the bounds that hold the true ones: nm, um/s.

    came_from_nm   where the vehicle may have been at the cycle before, for the portion of track run since
    """

    position_nm: int
    low_nm: int
    high_nm: int
    speed_um_s: int
    slowest_um_s: int
    fastest_um_s: int
    came_from_nm: tuple[int, int]
    max_acceleration_mm_s2: int

    @property
    def margin_nm(self) -> int:
        """The estimate's place is no farther from the true one."""
        return max(self.position_nm - self.low_nm, self.high_nm - self.position_nm)

    @property
    def speed_margin_um_s(self) -> int:
        """Nor is its speed."""
        return max(self.speed_um_s - self.slowest_um_s, self.fastest_um_s - self.speed_um_s)

    def stretch_m(self) -> tuple[float, float]:
        """Return the stretch from its rearmost to its foremost possible place, in m along the track."""
        ends = (*self.came_from_nm, self.low_nm, self.high_nm)
        return min(ends) / NM_PER_M, max(ends) / NM_PER_M

    def at(self, offset_s: float) -> TrackState:
        """Return the estimate so long after the time of the cycle (before it if negative), at constant speed."""
        speed = self.speed_um_s / UM_PER_M
        return TrackState(self.position_nm / NM_PER_M + speed * offset_s, speed, 0.0)

    def estimate(self, offset_s: float) -> Estimate:
        """Return the error bounds of the estimate at that time."""
        speed_margin, gained = self.speed_margin_um_s / UM_PER_M, self.max_acceleration_mm_s2 / 1e3 * offset_s**2 / 2
        margin = self.margin_nm / NM_PER_M + speed_margin * abs(offset_s) + gained
        return Estimate(margin, self.speed_um_s / UM_PER_M, speed_margin)


def ahead(state: Mapping[str, Value], config: SatelliteConfig) -> Ahead:
    """Return the prediction E*(t) from the machine's state before the step, in the same whole numbers as `motion.predicted`."""
    names = ("position_nm", "low_nm", "high_nm", "speed_um_s", "slowest_um_s", "fastest_um_s", "change_um_s")
    place, low, high, speed, slowest, fastest, change = (int(state[f"position.{name}"]) for name in names)
    fast, gained, period = config.max_speed_mm_s * 1_000, config.speed_change_um_s, config.period_ms
    return Ahead(
        place + speed * period + change * (period // 2),
        low + slowest * period - config.way_nm,
        high + fastest * period + config.way_nm,
        max(-fast, min(speed + change, fast)),
        max(slowest - gained, -fast),
        min(fastest + gained, fast),
        (low, high),
        config.max_acceleration_mm_s2,
    )
