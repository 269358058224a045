"""Figures of the run of a vehicle that counts as standing.

The machine adds the run as it is computed here. The world computes its limit from the figures itself, so that a wrong conversion
here is no longer covered by an equally wrong law.
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.units import NM_PER_MM


@dataclass(frozen=True)
class Unmeasured:
    """The run of a vehicle that counts as standing.

    creep_mm_s         its fastest creep beyond what is between two pulses, in every cycle
    between_pulses_mm  the farthest that it gets between two pulses of its odometer, in all cycles of one stop together
    """

    creep_mm_s: int
    between_pulses_mm: int

    @property
    def between_pulses_nm(self) -> int:
        """The farthest run between two pulses, nm."""
        return self.between_pulses_mm * NM_PER_MM

    def creep_nm(self, period_ms: int) -> int:
        """Return the farthest creep of a cycle, nm."""
        return self.creep_mm_s * period_ms * (NM_PER_MM // 1_000)
