"""A measured distance: what a cycle makes of it, and the bounds that it is judged by."""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.expr import members
from safeloc.language.units import NM_PER_MM

MEASURED = members("measured", "ADMITTED", "MISSING", "TOO_FAST", "JUMP")
ADMITTED, MISSING, TOO_FAST, JUMP = MEASURED


@dataclass(frozen=True)
class Limits:
    """The physical and configured bounds a device works within; all whole numbers in the units named."""

    period_ms: int
    tolerance_mm: int
    max_speed_mm_s: int
    max_step_mm: int
    max_step_change_mm: int
    gap_limit: int
    lone_limit: int
    age_limit_ms: int
    position_limit_mm: int
    single_fault_safe: bool

    @property
    def tolerance_nm(self) -> int:
        """The tolerable error in nm."""
        return self.tolerance_mm * NM_PER_MM

    @property
    def blind_nm(self) -> int:
        """The farthest the vehicle gets in one cycle, in nm."""
        return self.max_speed_mm_s * self.period_ms * 1_000
