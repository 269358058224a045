"""Configurations of the machines for one vehicle, made from its figures for the audit and from its movement."""

from __future__ import annotations

from dataclasses import dataclass

from pydantic import ValidationError

from safeloc.config import Config
from safeloc.errors import InputError
from safeloc.models.balise.variables import BaliseConfig
from safeloc.models.layout_rules import LayoutConfig
from safeloc.models.layout_rules.marker_readers import MarkerReaders
from safeloc.models.odometry.variables import OdometryConfig
from safeloc.models.reflector.variables import ReflectorConfig
from safeloc.models.route.variables import RouteConfig
from safeloc.models.stop_point.variables import StopPointConfig
from safeloc.models.turn_off import TurnOffConfig
from safeloc.models.vocabulary.error_law import ErrorLaw
from safeloc.simulation.motion import VehicleConfig

SPEED_SHARE = 0.9
"""Share of the speed limit that a vehicle uses; the rest leaves room for distances that the odometer measures too long."""


@dataclass(frozen=True)
class LineVehicle:
    """A vehicle on a line.

    layout       its figures for the audit; None: every machine has its defaults
    in_time      radar and balise reader extrapolate their measurements to the end of the cycle: their latency adds no error
    trust_first  the first balise group of a run is trusted without a second one. A route with a single group needs that: otherwise
                 the machines that locate by groups alone never report a position
    """

    name: str = "default figures"
    motion: VehicleConfig = VehicleConfig()
    layout: LayoutConfig | None = None
    trust_first: bool = False
    in_time: bool = False

    @property
    def national_mm(self) -> int:
        """Location accuracy of groups without a figure of their own, mm."""
        return (self.layout or LayoutConfig()).balise_accuracy_mm

    @property
    def detection_mm(self) -> int:
        """Detection accuracy of a balise, mm."""
        return (self.layout or LayoutConfig()).detection_accuracy_mm

    @property
    def readers(self) -> MarkerReaders:
        """Its marker readers; without figures of its own those of the odometry machine."""
        return (self.layout or LayoutConfig()).readers

    @property
    def radar_error_mm(self) -> int:
        """Error of a measured reflector, without that of the map, mm."""
        return max(1, (self.layout or LayoutConfig()).radar_error_mm)

    @property
    def antenna_mm(self) -> int:
        """Distance of the balise antenna behind the front end, mm."""
        return (self.layout or LayoutConfig()).antenna_offset_mm

    def odometry(self) -> OdometryConfig:
        """Return the configuration: both units of a device have the law of the vehicle's odometry."""
        if self.layout is None:
            return OdometryConfig(trust_first_marker=self.trust_first)
        figures = {
            "first_unit": self._law("wheel"),
            "second_unit": self._law("radar"),
            "tolerance_mm": self.layout.tolerance_mm,
            "trust_first_marker": self.trust_first,
        }
        return OdometryConfig.model_validate({**figures, **self._readers()})

    def _readers(self) -> dict[str, int]:
        """Return the figures of the marker readers that the line is audited for; without them those of the movement."""
        assert self.layout is not None
        if self.layout.markers is not None:
            return self.layout.markers.model_dump(exclude={"groups_are_markers"})
        return {
            "vehicle_length_mm": self.motion.length_mm,
            "max_speed_mm_s": self._gate_mm_s,
            "max_acceleration_mm_s2": self._gate_mm_s2,
        }

    def balise(self) -> BaliseConfig:
        """Return the configuration with antenna, accuracies and error law of the vehicle."""
        if self.layout is None:
            return BaliseConfig(trust_first_group=self.trust_first)
        return BaliseConfig(
            odometer=self._law("wheel"),
            tolerance_mm=self.layout.tolerance_mm,
            max_speed_mm_s=self._gate_mm_s,
            max_acceleration_mm_s2=self._gate_mm_s2,
            antenna_mm=self.layout.antenna_offset_mm,
            detection_mm=self.layout.detection_accuracy_mm,
            default_accuracy_mm=self.layout.balise_accuracy_mm,
            trust_first_group=self.trust_first,
        )

    def reflector(self) -> ReflectorConfig:
        """Return the configuration with radar, map accuracy and error law of the vehicle."""
        plain = ReflectorConfig()
        frame_ms, balise_ms = (0, 0) if self.in_time else (plain.frame_latency_ms, plain.balise_latency_ms)
        if self.layout is None:
            return ReflectorConfig(frame_latency_ms=frame_ms, balise_latency_ms=balise_ms)
        return ReflectorConfig(
            frame_latency_ms=frame_ms,
            balise_latency_ms=balise_ms,
            odometer=self._law("wheel"),
            tolerance_mm=self.layout.tolerance_mm,
            max_speed_mm_s=self._gate_mm_s,
            radar_offset_mm=self.layout.sensor_offset_mm,
            range_limit_mm=min(2_000_000, 2 * self.layout.radar_range_mm),
            near_range_mm=max(1, self.layout.radar_blind_mm),
            map_accuracy_mm=self.layout.map_accuracy_mm,
            balise_accuracy_mm=min(63_000, self.national_mm + self.detection_mm),
            reference_distance_mm=self.layout.prescribed_distance_mm or 0,
        )

    def stop_point(self, stops: int) -> StopPointConfig:
        """Return the configuration for platforms of so many stop points."""
        number = max(StopPointConfig().stop_points, stops)
        if self.layout is None:
            return StopPointConfig(stop_points=number)
        return StopPointConfig(
            stop_points=number,
            tolerance_mm=self.layout.tolerance_mm,
            max_speed_mm_s=self._gate_mm_s,
            brake_mm_s2=self.motion.brake_mm_s2,
        )

    def route(self, routes: int, longest_mm: int) -> RouteConfig:
        """Return the configuration for so many routes, of which the longest is so long."""
        number, longest = max(RouteConfig().routes, routes), max(RouteConfig().length_limit_mm, longest_mm)
        if self.layout is None:
            return RouteConfig(routes=number, length_limit_mm=longest)
        spare = self.layout.tolerance_mm - self.layout.odometry_constant_mm
        return RouteConfig(
            odometer=self._law("wheel"),
            routes=number,
            length_limit_mm=longest,
            tolerance_mm=self.layout.tolerance_mm,
            max_speed_mm_s=self._gate_mm_s,
            max_acceleration_mm_s2=self._gate_mm_s2,
            range_limit_mm=min(2_000_000, 2 * self.layout.radar_range_mm),
            start_error_mm=max(1, min(RouteConfig().start_error_mm, spare // 2)),
        )

    def turn_off(self) -> TurnOffConfig:
        """Return the default configuration, which does not depend on the vehicle's figures."""
        return TurnOffConfig()

    def _law(self, kind: str) -> ErrorLaw:
        assert self.layout is not None
        figures = {"constant_mm": self.layout.odometry_constant_mm, "rate_ppm": self.layout.odometry_rate_ppm}
        return ErrorLaw.model_validate({"kind": kind, **figures})

    @property
    def _gate_mm_s(self) -> int:
        return int(self.motion.max_speed_mm_s / SPEED_SHARE) + 1

    @property
    def _gate_mm_s2(self) -> int:
        return max(2_500, 2 * self.motion.acceleration_mm_s2, 2 * self.motion.brake_mm_s2)


def fitting(vehicle: LineVehicle, machine: str, *figures: int) -> Config:
    """Return the configuration of a machine for a vehicle; InputError if the vehicle's figures do not suit the machine."""
    make = getattr(vehicle, machine)
    try:
        config = make(*figures)
    except ValidationError as error:
        wrong = error.errors(include_url=False)[0]
        field = ".".join(str(part) for part in wrong["loc"])
        message = wrong["msg"].removeprefix("Value error, ")
        raise InputError(f"vehicle {vehicle.name} does not suit machine {machine}: {field} {message}.") from error
    assert isinstance(config, Config)
    return config
