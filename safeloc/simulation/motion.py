"""Simulates the true motion of a train within its limits of speed, acceleration and jerk.

All randomness comes from an explicit generator. Positions are whole nanometres, so that later sums are exact.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from safeloc.config import Config, quantity

_GRAVITY_MM_S2 = 9_810


class VehicleConfig(Config):
    """Limits of a vehicle's motion."""

    length_mm: int = quantity(41_700, "mm", 1_000, 2_000_000, "[S] Desiro BR 642: 41.7 m")
    max_speed_mm_s: int = quantity(33_333, "mm/s", 100, 138_889, "[S] Desiro BR 642: 120 km/h")
    acceleration_mm_s2: int = quantity(975, "mm/s2", 1, 3_000, "[S] Desiro BR 642: start 0.975 m/s2")
    brake_mm_s2: int = quantity(1_000, "mm/s2", 1, 5_000, "[S] service brake 0.8 to 1.0 m/s2")
    jerk_mm_s3: int = quantity(800, "mm/s3", 1, 10_000, "[M] 0.6 to 1.0 m/s3 in service")
    adhesion_percent: int = quantity(100, "% of Curtius-Kniffler", 1, 100, "[S] 100: dry; below 30: leaves or ice")


def adhesion_mm_s2(vehicle: VehicleConfig, speed_mm_s: float) -> float:
    """Return the greatest acceleration by adhesion at a speed (Curtius-Kniffler): gravity x (7.5 / (v + 44 km/h) + 0.161)."""
    friction = 7.5 / (abs(speed_mm_s) * 0.0036 + 44) + 0.161
    return friction * _GRAVITY_MM_S2 * vehicle.adhesion_percent / 100


@dataclass(frozen=True)
class Leg:
    """A run at a speed (negative: backwards) for some time, including the time to reach it."""

    speed_mm_s: int
    seconds: float


@dataclass(frozen=True)
class Motion:
    """The true motion: position of end A in nm, and speed in mm/s, at the end of every cycle. Shapes [cycles]."""

    period_ms: int
    position_nm: NDArray[np.int64]
    speed_mm_s: NDArray[np.float64]
    start_nm: int

    @property
    def distance_nm(self) -> NDArray[np.int64]:
        """The true distance of every cycle, nm."""
        return np.diff(self.position_nm, prepend=np.int64(self.start_nm))


def plan(vehicle: VehicleConfig, seconds: float, rng: np.random.Generator, *, reversals: bool = True) -> list[Leg]:
    """Return the legs of a random service: run, stop, sometimes reverse."""
    legs: list[Leg] = []
    left = seconds
    forward = 1
    while left > 0:
        speed = forward * int(vehicle.max_speed_mm_s * rng.choice([0.05, 0.3, 0.6, 0.95]))
        legs += [Leg(speed, float(rng.uniform(20, 60))), Leg(0, float(rng.uniform(25, 60)))]
        left -= legs[-1].seconds + legs[-2].seconds
        if reversals and rng.random() < 0.2:
            forward = -forward
    return legs


def move(vehicle: VehicleConfig, legs: Sequence[Leg], period_ms: int, *, start_nm: int = 0) -> Motion:
    """Drive the legs, within traction, brake and jerk."""
    dt = period_ms / 1000
    speed = acceleration = 0.0
    speeds: list[float] = []
    for leg in legs:
        wanted = float(np.clip(leg.speed_mm_s, -vehicle.max_speed_mm_s, vehicle.max_speed_mm_s))
        for _ in range(max(1, round(leg.seconds / dt))):
            acceleration = _towards(vehicle, speed, wanted, acceleration, dt)
            speed = float(np.clip(speed + acceleration * dt, -vehicle.max_speed_mm_s, vehicle.max_speed_mm_s))
            if abs(speed) < 1 and wanted == 0:
                speed = acceleration = 0.0
            speeds.append(speed)
    steps = np.rint(np.array(speeds) * period_ms * 1000).astype(np.int64)
    return Motion(period_ms, start_nm + np.cumsum(steps), np.array(speeds), start_nm)


def _towards(vehicle: VehicleConfig, speed: float, wanted: float, acceleration: float, dt: float) -> float:
    """Return the next acceleration, which would close the gap in speed within two seconds."""
    braking = abs(wanted) < abs(speed) or wanted * speed < 0
    limit = min(vehicle.brake_mm_s2 if braking else vehicle.acceleration_mm_s2, adhesion_mm_s2(vehicle, speed))
    wish = float(np.clip((wanted - speed) / 2.0, -limit, limit))
    change = vehicle.jerk_mm_s3 * dt
    return float(np.clip(wish, acceleration - change, acceleration + change))
