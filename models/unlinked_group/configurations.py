"""Configurations in which the machine of the unlinked group is proved beside its defaults, so that no case stays folded away."""

from __future__ import annotations

from safeloc.config import Configurations
from safeloc.models.balise.configurations import ERRING
from safeloc.models.unlinked_group.variables import UnlinkedGroupConfig

NEVER = {
    "models/unlinked_group/world.py: between(-farthest, seen.true_cycle_distance, farthest) from _odometer_law(own)": "the choice has this range; the clause names it for the register of assumptions",
    "models/vocabulary/error_law.py: above * Lit(self.rate_ppm, PPM) + floor + drift from self.law.growth_nm(abs_(self.measured.value), as_num(0, MS), ...": "an odometer that drifts is refused: odometer.drift_mm_s2 must be 0",
}
"""Case splits that no configuration makes live, and why."""
CONFIGURATIONS = Configurations(
    {
        "an odometer that errs at standstill": UnlinkedGroupConfig(odometer=ERRING, tolerance_mm=60_000),
        "packets tell short distances": UnlinkedGroupConfig(reach_mm=60_000, tolerance_mm=60_000),
    },
    NEVER,
)
