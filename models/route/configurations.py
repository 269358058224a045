"""Configurations in which the route machine is proved besides its defaults, so that proofs cover cases which the defaults fold away."""

from __future__ import annotations

from safeloc.config import Configurations
from safeloc.models.route.variables import RouteConfig
from safeloc.models.vocabulary.error_law import ErrorLaw

ERRING = ErrorLaw(kind="wheel", constant_mm=3_000, rate_ppm=40_000, floor_mm_s=200, knee_mm_s=2_000)
"""An odometer that errs at standstill, and by its rate above a speed only."""
NEVER = {
    "models/vocabulary/vehicle_world.py: between(-farthest_nm, ran, farthest_nm) from speed_law(seen.true_cycle_distance, own.config.physics.farth ...": "the choice has this range; the clause names it for the register of assumptions",
    "models/vocabulary/error_law.py: above * Lit(self.rate_ppm, PPM) + floor + drift from self.law.growth_nm(abs_(self.measured.value), as_num(0, MS), ...": "an odometer that drifts is refused: odometer.drift_mm_s2 must be 0",
}
"""Case splits that no configuration makes live, with the reason."""
CONFIGURATIONS = Configurations(
    {
        "an odometer that errs at standstill": RouteConfig(odometer=ERRING),
        "a second unit has checked the distance": RouteConfig(odometer=ERRING, checked_distance=True),
    },
    NEVER,
)
