"""Configuration of the marker device: its odometry, the guard of its receiver, and where the antenna is."""

from __future__ import annotations

from pydantic import model_validator

from safeloc.config import CompositionConfig, quantity
from safeloc.models.guard.variables import GuardConfig
from safeloc.models.odometry.variables import OdometryConfig


class MarkerDeviceConfig(CompositionConfig):
    """One vehicle with its readers, its odometers and its receiver; figures of the vehicle are those of `odometry`."""

    odometry: OdometryConfig = OdometryConfig(satellite_markers=True)
    guard: GuardConfig = GuardConfig()
    antenna_mm: int = quantity(6_000, "mm", 0, 1_000_000, "[D] antenna on the roof of the leading coach, behind end A")
    antenna_tolerance_mm: int = quantity(100, "mm", 0, 10_000, "[D] of that distance along the vehicle")

    @model_validator(mode="after")
    def _one_vehicle(self) -> MarkerDeviceConfig:
        if not self.odometry.satellite_markers:
            raise ValueError(
                "odometry.satellite_markers must be true: without positions of satellites the device is supervised_odometry."
            )
        for figure in ("period_ms", "max_speed_mm_s", "position_limit_mm"):
            vehicle, receiver = getattr(self.odometry, figure), getattr(self.guard, figure)
            if vehicle != receiver:
                raise ValueError(
                    f"guard.{figure} is {receiver}, but the vehicle's is {vehicle} (odometry); make them the same."
                )
        fastest = max(self.guard.acceleration_mm_s2, self.guard.brake_mm_s2)
        if fastest > self.odometry.max_acceleration_mm_s2:
            raise ValueError(
                f"odometry.max_acceleration_mm_s2 {self.odometry.max_acceleration_mm_s2} is below the {fastest} that guard gives the "
                "same vehicle: its distances would be refused as jumps; raise it."
            )
        return self

    @model_validator(mode="after")
    def _fits(self) -> MarkerDeviceConfig:
        """Refuse figures with which the guard's position would not be an input of odometry."""
        beyond = 2 * (self.guard.window_limit_mm + self.antenna_mm + self.antenna_tolerance_mm)
        if beyond > self.odometry.position_limit_mm:
            raise ValueError(
                f"odometry.position_limit_mm {self.odometry.position_limit_mm} is below {beyond}, by which the guard's window and the "
                "antenna may reach beyond the line; raise it."
            )
        return self

    @property
    def farthest_mm(self) -> int:
        """The farthest true place of end A: the line, and beyond it what odometry's or the guard's interval may hold, with two runs of a cycle."""
        own, run_mm = self.odometry, -(-self.odometry.max_speed_mm_s * self.odometry.period_ms // 1_000)
        of_odometry = 2 * own.tolerance_mm + own.vehicle_length_mm
        of_guard = 2 * self.guard.window_limit_mm + self.antenna_mm + self.antenna_tolerance_mm + 2 * run_mm
        return own.position_limit_mm + max(of_odometry, of_guard)
