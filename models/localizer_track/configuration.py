"""Configuration of a localizer on a map with switches."""

from __future__ import annotations

from pydantic import model_validator

from safeloc.config import CompositionConfig
from safeloc.models.localizer import LocalizerConfig
from safeloc.models.occupied_track import OccupiedTrackConfig
from safeloc.models.turn_off import TurnOffConfig


class LocalizerTrackConfig(CompositionConfig):
    """One vehicle, its course at switches, and the map that it is on; all machines have one cycle and one coordinate."""

    localizer: LocalizerConfig = LocalizerConfig(sources=("balise",))
    turn_off: TurnOffConfig = TurnOffConfig()
    track: OccupiedTrackConfig = OccupiedTrackConfig(position_limit_mm=1_000_030_000)

    @model_validator(mode="after")
    def _one_vehicle(self) -> LocalizerTrackConfig:
        if "balise" not in self.localizer.sources:
            raise ValueError(
                f"localizer.sources {list(self.localizer.sources)} has no balise: a track begins with a balise group; add it."
            )
        vehicle = self.localizer.motion
        for figure in ("period_ms", "max_speed_mm_s"):
            if getattr(vehicle, figure) != getattr(self.track, figure):
                raise ValueError(
                    f"track.{figure} is {getattr(self.track, figure)}, but the vehicle's is {getattr(vehicle, figure)} "
                    "(localizer.motion); make them the same."
                )
        if self.turn_off.position_limit_mm != vehicle.position_limit_mm:
            raise ValueError(
                f"turn_off.position_limit_mm is {self.turn_off.position_limit_mm}, but the vehicle's is "
                f"{vehicle.position_limit_mm} (localizer.motion); make them the same."
            )
        farthest = vehicle.position_limit_mm + self.localizer.tolerance_mm
        if self.track.position_limit_mm < farthest:
            raise ValueError(
                f"track.position_limit_mm {self.track.position_limit_mm} is below {farthest}, to which the interval of the vehicle "
                "may reach (localizer.motion.position_limit_mm, localizer.tolerance_mm); raise it."
            )
        return self
