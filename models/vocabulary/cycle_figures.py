"""The figures that every configuration with a measured distance has: names only, no terms, so that machines and worlds share them."""

from __future__ import annotations

from typing import Protocol


class DistanceConfig(Protocol):
    """The figures of a configuration that limit a measured distance."""

    @property
    def period_ms(self) -> int:
        """Length of the cycle, ms."""
        ...

    @property
    def max_speed_mm_s(self) -> int:
        """The highest speed, mm/s."""
        ...

    @property
    def max_acceleration_mm_s2(self) -> int:
        """The greatest acceleration, mm/s2."""
        ...

    @property
    def measuring_step_mm(self) -> int:
        """The step of the measurement, mm."""
        ...

    @property
    def gap_limit_cycles(self) -> int:
        """The most cycles without a usable distance."""
        ...
