"""Configuration of a localizer: its sources, and the figures that they share."""

from __future__ import annotations

from typing import Literal

from pydantic import model_validator

from safeloc.config import CompositionConfig, Config, quantity
from safeloc.models.arbitration import SOURCES, ArbitrationConfig
from safeloc.models.balise.variables import BaliseConfig
from safeloc.models.motion import MotionConfig
from safeloc.models.odometry.variables import OdometryConfig
from safeloc.models.reflector.variables import ReflectorConfig
from safeloc.models.reflector_anchor.figures import check_anchor
from safeloc.models.satellite.variables import SatelliteConfig
from safeloc.models.transmission import TransmissionConfig
from safeloc.models.verification import VerificationConfig
from safeloc.models.vocabulary.error_law import RADAR

SourceName = Literal["odometry", "balise", "reflector", "satellite", "fibre"]


CHECKED = MotionConfig(check=RADAR)
"""An odometer that a Doppler radar checks."""


class LocalizerConfig(CompositionConfig):
    """One vehicle with all its ways of locating; what they share is said once, in `motion`, and must be the same in each.

    Where `motion` has a check unit it is odometry's second unit at the front, and balises and reflectors hear of a distance
    what it is worth (`checked_distance`, with the law `motion.reported_law`).
    """

    sources: tuple[SourceName, ...] = ("odometry", "balise", "reflector", "satellite", "fibre")
    tolerance_mm: int = quantity(30_000, "mm", 1, 500_000, "[S] OCORA 7239: 30 m on main line")
    motion: MotionConfig = CHECKED
    odometry: OdometryConfig = OdometryConfig(single_fault_safe=True, tolerance_mm=45_000)
    balise: BaliseConfig = BaliseConfig(odometer=CHECKED.reported_law, checked_distance=True, tolerance_mm=45_000)
    reflector: ReflectorConfig = ReflectorConfig(
        odometer=CHECKED.reported_law, checked_distance=True, last_balise_identity=BaliseConfig().last_group_identity,
        reference_tolerance_mm=25_000,
    )  # fmt: skip
    satellite: SatelliteConfig = SatelliteConfig(
        period_ms=100, coast_limit_cycles=20, max_acceleration_mm_s2=CHECKED.max_acceleration_mm_s2
    )
    fibre: VerificationConfig = VerificationConfig(
        period_ms=100, margin_limit_mm=300_000, reference_age_limit_cycles=20, currency_cycles=50
    )
    downlink: TransmissionConfig = TransmissionConfig()
    uplink: TransmissionConfig = TransmissionConfig()

    @property
    def used(self) -> dict[str, Config]:
        """The configurations that count, by name: those of the sources that there are, and of the links."""
        chosen: dict[str, Config] = {name: getattr(self, name) for name in SOURCES if name in self.sources}
        links: dict[str, Config] = {"downlink": self.downlink} if "fibre" in self.sources else {}
        return {**chosen, **links, "uplink": self.uplink}

    @property
    def arbitration(self) -> ArbitrationConfig:
        """Configuration of arbitration."""
        return self.arbitration_of(tuple(name for name in SOURCES if name in self.sources), ())

    @property
    def widest_mm(self) -> int:
        """The greatest margin that arbitration accepts of a source."""
        return 10 * self.tolerance_mm

    def arbitration_of(self, shipped: tuple[str, ...], own: tuple[str, ...]) -> ArbitrationConfig:
        """Return the configuration of arbitration between these shipped sources and a user's own."""
        return ArbitrationConfig(
            sources=shipped,
            own=own,
            tolerance_mm=self.tolerance_mm,
            max_cycle_distance_mm=self.motion.limits.max_cycle_distance_mm,
            position_limit_mm=self.motion.position_limit_mm,
        )

    @model_validator(mode="after")
    def _one_vehicle(self) -> LocalizerConfig:
        if not self.sources or len(set(self.sources)) != len(self.sources):
            raise ValueError(f"sources {list(self.sources)} must be at least one of {list(SOURCES)}, each once.")
        if self.odometry.satellite_markers:
            raise ValueError(
                "odometry.satellite_markers must be false: nothing here checks such positions. `satellite` is a source of its "
                "own; marker_device has the guard that checks them."
            )
        checked = self.motion.check is not None
        wanted = {
            "period_ms": self.motion.period_ms,
            "position_limit_mm": self.motion.position_limit_mm,
            "max_speed_mm_s": self.motion.max_speed_mm_s,
            "max_acceleration_mm_s2": self.motion.max_acceleration_mm_s2,
            "odometer": self.motion.reported_law,
            "checked_distance": checked,
            "first_unit": self.motion.odometer,
        }
        if checked:
            wanted |= {"second_unit": self.motion.check, "measuring_step_mm": self.motion.measuring_step_mm}
        for name, config in self.used.items():
            for figure, value in wanted.items():
                slack = name == "fibre" and figure == "max_speed_mm_s"
                if not slack and getattr(config, figure, value) != value:
                    raise ValueError(
                        f"{name}.{figure} is {getattr(config, figure)}, but the vehicle's is {value} (motion); make them the same."
                    )
        return self

    @model_validator(mode="after")
    def _fits(self) -> LocalizerConfig:
        """Refuse figures of used machines that do not fit each other; unused machines are not checked."""
        widest, used = self.widest_mm, self.used
        for name, limit in {
            "odometry.tolerance_mm": self.odometry.tolerance_mm,
            "balise.tolerance_mm": self.balise.tolerance_mm,
            "reflector.tolerance_mm": self.reflector.tolerance_mm,
            "satellite.tolerance_mm": self.satellite.tolerance_mm,
            "downlink.margin_limit_mm": self.downlink.margin_limit_mm,
        }.items():
            if name.partition(".")[0] in used and limit > widest:
                raise ValueError(
                    f"{name} {limit} is beyond ten times tolerance_mm {self.tolerance_mm}: it tells nothing."
                )
        if {"balise", "reflector"} <= used.keys():
            check_anchor(self.balise, self.reflector)
        if "fibre" in used and self.fibre.margin_limit_mm > self.downlink.margin_limit_mm:
            raise ValueError(
                f"fibre.margin_limit_mm {self.fibre.margin_limit_mm} is beyond downlink.margin_limit_mm "
                f"{self.downlink.margin_limit_mm}: a report of that width cannot be sent."
            )
        if self.tolerance_mm > self.uplink.margin_limit_mm:
            raise ValueError("uplink.margin_limit_mm must not be below tolerance_mm: a report could not be sent.")
        return self
