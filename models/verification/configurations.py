"""Configurations of verification, besides the defaults, in which all its case splits are live in some proof."""

from __future__ import annotations

from safeloc.config import Configurations
from safeloc.models.verification.variables import VerificationConfig

NEVER = {
    "models/verification/world.py: place_kept": "an earlier machine guarantees the place in compositions only: fibre_area",
    "models/verification/variables.py: truth is None": "another machine moves the train in compositions only: localizer",
}
"Case splits that no configuration makes live, with the reason."
CONFIGURATIONS = Configurations(
    {
        "control data, no emitter": VerificationConfig(needs_control_data=True, needs_emitter=False),
        "control data and emitter": VerificationConfig(needs_control_data=True),
    },
    NEVER,
)
