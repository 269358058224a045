"""The predicted state E*(t) in figures: what the machine predicts in its step, for the signals to be predicted from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from safeloc.models.satellite_parts.variables import SatelliteConfig
from safeloc.nodes import Value
from safeloc.signals.satellite.solution import Estimate
from safeloc.signals.satellite.track_prediction import TrackState

NM_PER_M, UM_PER_M = 1e9, 1e6


@dataclass(frozen=True, slots=True)
class Ahead:
    """Place and speed with their margins at the time of the cycle: nm, um/s.

    came_from_nm   where the vehicle may have been at the cycle before, for the portion of track run since
    """

    position_nm: int
    margin_nm: int
    speed_um_s: int
    speed_margin_um_s: int
    came_from_nm: tuple[int, int]
    max_acceleration_mm_s2: int

    def stretch_m(self) -> tuple[float, float]:
        """From where it may have been to where it may be, in m along the track."""
        low, high = self.came_from_nm
        ends = (self.position_nm - self.margin_nm, self.position_nm + self.margin_nm)
        return min(low, *ends) / NM_PER_M, max(high, *ends) / NM_PER_M

    def at(self, offset_s: float) -> TrackState:
        """The state so long after the time of the cycle (before it where negative), at constant speed."""
        speed = self.speed_um_s / UM_PER_M
        return TrackState(self.position_nm / NM_PER_M + speed * offset_s, speed, 0.0)

    def estimate(self, offset_s: float) -> Estimate:
        """How far off that may be."""
        speed_margin, gained = self.speed_margin_um_s / UM_PER_M, self.max_acceleration_mm_s2 / 1e3 * offset_s**2 / 2
        margin = self.margin_nm / NM_PER_M + speed_margin * abs(offset_s) + gained
        return Estimate(margin, self.speed_um_s / UM_PER_M, speed_margin)


def ahead(state: Mapping[str, Value], config: SatelliteConfig) -> Ahead:
    """E*(t) from the machine's state before the step, the same whole numbers as in `motion.predicted`."""
    place, margin, speed, speed_margin, change = (
        int(state[f"position.{name}"])
        for name in ("position_nm", "margin_nm", "speed_um_s", "speed_margin_um_s", "change_um_s")
    )
    half = change * (config.period_ms // 2)
    return Ahead(
        place + speed * config.period_ms + half,
        margin + speed_margin * config.period_ms + abs(half) + config.way_nm,
        speed + change,
        speed_margin + abs(change) + config.speed_change_um_s,
        (place - margin, place + margin),
        config.max_acceleration_mm_s2,
    )
