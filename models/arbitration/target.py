"""The catalogue entry of the arbitration between sources."""

from __future__ import annotations

from safeloc.models import arbitration
from safeloc.models.arbitration import ArbitrationConfig
from safeloc.models.arbitration.configurations import CONFIGURATIONS
from safeloc.properties import arbitration as claims
from safeloc.reported import Reported
from safeloc.target import Entry, Family, Target, single


def target(config: ArbitrationConfig) -> Target:
    """Make the machine."""
    model = arbitration.build(arbitration.parts(config))
    return single(model.machine, claims.properties(model), config, reported=Reported())


ENTRIES = (
    Entry(
        "arbitration",
        "what several positions have in common",
        ArbitrationConfig,
        target,
        Family.LOCALIZER,
        place=10,
        configurations=CONFIGURATIONS,
        silent=("arbitration",),
    ),
)
