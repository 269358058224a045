"""Configurations in which verification is proved beside its defaults, so that no case of it stays folded away."""

from __future__ import annotations

from safeloc.config import Configurations
from safeloc.models.verification.variables import VerificationConfig

NEVER = {
    "models/verification/world.py: place_kept": "an earlier machine vouches for the place in compositions only: fibre_area",
}
"""Case splits that no configuration makes live, and why."""
CONFIGURATIONS = Configurations(
    {
        "control data, no emitter": VerificationConfig(needs_control_data=True, needs_emitter=False),
        "control data and emitter": VerificationConfig(needs_control_data=True),
    },
    NEVER,
)
