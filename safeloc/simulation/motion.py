"""Simulates the true motion of a train within its limits of speed, acceleration and jerk.

All randomness comes from an explicit generator. Positions are whole nanometres, so that later sums are exact.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from safeloc.config import Config, quantity

_GRAVITY_MM_S2 = 9_810
_Float = Any
"""A float, or an array of floats."""


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
    return float(_adhesion(np.float64(vehicle.adhesion_percent), np.float64(speed_mm_s)))


def _adhesion(percent: _Float, speed_mm_s: _Float) -> _Float:
    friction = 7.5 / (np.abs(speed_mm_s) * 0.0036 + 44) + 0.161
    return friction * _GRAVITY_MM_S2 * percent / 100


@dataclass(frozen=True)
class Leg:
    """A run at a speed (negative: backwards) for some time, including the time to reach it."""

    speed_mm_s: int
    seconds: float


@dataclass(frozen=True)
class _TrueMotion:
    """Position of end A in nm, and speed in mm/s, at the end of every cycle; cycles are the first axis."""

    period_ms: int
    position_nm: NDArray[np.int64]
    speed_mm_s: NDArray[np.float64]
    start_nm: int

    @property
    def distance_nm(self) -> NDArray[np.int64]:
        """The true distance of every cycle, nm."""
        return np.diff(self.position_nm, axis=0, prepend=np.int64(self.start_nm))


class Motion(_TrueMotion):
    """The true motion: position of end A in nm, and speed in mm/s, at the end of every cycle. Shapes [cycles]."""


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


class Motions(_TrueMotion):
    """The true motions of several vehicles, each as in `Motion`. Shapes [cycles, vehicles]."""

    @classmethod
    def alone(cls, motion: Motion) -> Motions:
        """Return the motion of one vehicle as those of several."""
        return cls(motion.period_ms, motion.position_nm[:, None], motion.speed_mm_s[:, None], motion.start_nm)

    def of(self, vehicle: int) -> Motion:
        """Return the motion of one vehicle."""
        return Motion(
            self.period_ms,
            np.ascontiguousarray(self.position_nm[:, vehicle]),
            np.ascontiguousarray(self.speed_mm_s[:, vehicle]),
            self.start_nm,
        )


def move(vehicle: VehicleConfig, legs: Sequence[Leg], period_ms: int, *, start_nm: int = 0) -> Motion:
    """Drive the legs, within traction, brake and jerk."""
    return move_many([vehicle], [legs], period_ms, start_nm=start_nm).of(0)


def move_many(
    vehicles: Sequence[VehicleConfig], legs: Sequence[Sequence[Leg]], period_ms: int, *, start_nm: int = 0
) -> Motions:
    """Drive the legs of each vehicle, as `move` does each of them; all legs must take the same number of cycles."""
    dt = period_ms / 1000
    wanted = np.stack([_wanted(*one, dt) for one in zip(vehicles, legs, strict=True)], axis=1)
    limits = _Limits(vehicles)
    speeds, rest = np.empty(wanted.shape), wanted == 0
    speed = acceleration = np.zeros(len(vehicles))
    for cycle, goal in enumerate(wanted):
        acceleration = limits.towards(speed, goal, acceleration, dt)
        speed = np.minimum(np.maximum(speed + acceleration * dt, -limits.top), limits.top)
        moves = ~(rest[cycle] & (np.abs(speed) < 1))
        speed, acceleration = np.where(moves, speed, 0.0), np.where(moves, acceleration, 0.0)
        speeds[cycle] = speed
    steps = np.rint(speeds * period_ms * 1000).astype(np.int64)
    return Motions(period_ms, start_nm + np.cumsum(steps, axis=0), speeds, start_nm)


def _wanted(vehicle: VehicleConfig, legs: Sequence[Leg], dt: float) -> NDArray[np.float64]:
    """Return the speed that is wanted in each cycle."""
    speeds = [min(max(float(leg.speed_mm_s), -vehicle.max_speed_mm_s), vehicle.max_speed_mm_s) for leg in legs]
    return np.repeat(np.array(speeds, dtype=np.float64), [max(1, round(leg.seconds / dt)) for leg in legs])


class _Limits:
    """The limits of vehicles, arrays [vehicle]."""

    def __init__(self, vehicles: Sequence[VehicleConfig]) -> None:
        def of(name: str) -> NDArray[np.float64]:
            return np.array([getattr(one, name) for one in vehicles], dtype=np.float64)

        self.top, self._jerk, self._adhesion = of("max_speed_mm_s"), of("jerk_mm_s3"), of("adhesion_percent")
        self._accelerates, self._brakes = of("acceleration_mm_s2"), of("brake_mm_s2")
        most = np.maximum(self._accelerates, self._brakes)
        self._sticks = bool((_adhesion(self._adhesion, self.top) >= most).all())  # it is least at the highest speed

    def towards(self, speed: _Float, wanted: _Float, acceleration: _Float, dt: float) -> _Float:
        """Return the next accelerations, which would close the gaps in speed within two seconds."""
        braking = (np.abs(wanted) < np.abs(speed)) | (wanted * speed < 0)
        limit = np.where(braking, self._brakes, self._accelerates)
        if not self._sticks:
            limit = np.minimum(limit, _adhesion(self._adhesion, speed))
        wish = np.minimum(np.maximum((wanted - speed) / 2.0, -limit), limit)
        change = self._jerk * dt
        return np.minimum(np.maximum(wish, acceleration - change), acceleration + change)
