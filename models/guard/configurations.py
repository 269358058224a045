"""Configurations in which the guard is proved beside its defaults, so that no case of it stays folded away."""

from __future__ import annotations

from safeloc.config import Configurations
from safeloc.models.guard.variables import GuardConfig

NEVER = {
    "models/guard/box.py: self.slow <= self.fast from box.possible": "the box of a first fix has every speed; live of the box that is carried on",
    "models/guard/variables.py: truth is None": "only a composition hands in a true place of its own: marker_device, in which its claims are proved",
}
"""Case splits that no configuration makes live, and why."""
CONFIGURATIONS = Configurations(
    {
        "brakes harder than it accelerates": GuardConfig(acceleration_mm_s2=1_000, brake_mm_s2=2_500),
        "accelerates harder than it brakes": GuardConfig(acceleration_mm_s2=1_500, brake_mm_s2=800),
    },
    NEVER,
)
