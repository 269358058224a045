"""Configuration of reflectors with the direction of travel: its machines, and the figures that they share."""

from __future__ import annotations

from safeloc.models.reflector_device.configuration import AnchoredConfig, ReflectorDeviceConfig
from safeloc.models.stop_point.variables import StopPointConfig
from safeloc.models.turn_off import TurnOffConfig


class ReflectorDirectionConfig(AnchoredConfig):
    """One vehicle with odometer, balise reader and radar; the direction of travel has no figures."""

    @property
    def device(self) -> ReflectorDeviceConfig:
        """The reflector device of the same vehicle, which the simulation drives along the line."""
        limit = self.motion.position_limit_mm
        return ReflectorDeviceConfig(
            motion=self.motion,
            balise=self.balise,
            reflector=self.reflector,
            turn_off=TurnOffConfig(position_limit_mm=limit),
            stop=StopPointConfig(
                position_limit_mm=limit,
                max_speed_mm_s=self.motion.max_speed_mm_s,
                tolerance_mm=self.reflector.tolerance_mm,
            ),
        )
