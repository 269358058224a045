"""Configuration of the reflector device: its machines, and the figures that they share."""

from __future__ import annotations

from pydantic import model_validator

from safeloc.config import Config
from safeloc.models.balise.variables import BaliseConfig
from safeloc.models.delocalized import DelocalizedConfig
from safeloc.models.localizer.configuration import LocalizerConfig
from safeloc.models.motion import MotionConfig
from safeloc.models.reflector.variables import ReflectorConfig
from safeloc.models.stop_point.variables import StopPointConfig
from safeloc.models.turn_off import TurnOffConfig

LARGEST_ACCURACY_MM = 100_000
"""The reflector machine takes no reading that is less accurate."""


class AnchoredConfig(Config):
    """One vehicle with odometer, balise reader and radar; what they share is said once, in `motion`, and must be the same in each."""

    motion: MotionConfig = MotionConfig()
    balise: BaliseConfig = BaliseConfig()
    reflector: ReflectorConfig = ReflectorConfig(last_balise_identity=16_777_216, reference_tolerance_mm=25_000)

    @property
    def vehicle(self) -> LocalizerConfig:
        """The same figures as those of a localizer of these machines; ValueError where they are not those of one vehicle."""
        return LocalizerConfig(
            sources=("balise", "reflector"),
            tolerance_mm=self.reflector.tolerance_mm,
            motion=self.motion,
            balise=self.balise,
            reflector=self.reflector,
        )

    @model_validator(mode="after")
    def _drawn_from_one_vehicle(self) -> AnchoredConfig:
        """Refuse figures of machines that are not those of one vehicle."""
        _ = self.vehicle
        return self

    @model_validator(mode="after")
    def _fits(self) -> AnchoredConfig:
        """Refuse figures with which a group that the balise machine accepts is no reading of the reflector machine."""
        if self.reflector.last_balise_identity < self.balise.last_group_identity:
            raise ValueError(
                f"reflector.last_balise_identity {self.reflector.last_balise_identity} is below balise.last_group_identity "
                f"{self.balise.last_group_identity}: an accepted group could not be handed over; raise it."
            )
        if self.balise.tolerance_mm > LARGEST_ACCURACY_MM:
            raise ValueError(
                f"balise.tolerance_mm {self.balise.tolerance_mm} is above {LARGEST_ACCURACY_MM}, the widest reading that the "
                "reflector machine takes; lower it."
            )
        if self.reflector.reference_distance_mm:
            raise ValueError(
                "reflector.reference_distance_mm must be 0: it counts from the balise, and the balise machine hands over a "
                "position; let telegram or map give the distance."
            )
        return self

    @property
    def host(self) -> DelocalizedConfig:
        """The limits of what the host gets: those of the reflector machine."""
        own = self.reflector
        return DelocalizedConfig(tolerance_mm=own.tolerance_mm, position_limit_mm=own.position_limit_mm)


class ReflectorDeviceConfig(AnchoredConfig):
    """The vehicle with its course at switches and the stop at a platform."""

    turn_off: TurnOffConfig = TurnOffConfig()
    stop: StopPointConfig = StopPointConfig()

    @model_validator(mode="after")
    def _one_vehicle(self) -> ReflectorDeviceConfig:
        moves = self.vehicle.motion
        line = {"position_limit_mm": moves.position_limit_mm}
        wanted = line | {"max_speed_mm_s": moves.max_speed_mm_s, "tolerance_mm": self.reflector.tolerance_mm}
        for name, config, figures in (("turn_off", self.turn_off, line), ("stop", self.stop, wanted)):
            for figure, value in figures.items():
                if getattr(config, figure) != value:
                    raise ValueError(
                        f"{name}.{figure} is {getattr(config, figure)}, but the vehicle's is {value} (motion, reflector); make "
                        "them the same."
                    )
        return self
