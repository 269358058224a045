"""The catalogue entry of the arbitration between sources."""

from __future__ import annotations

from safeloc.models import arbitration
from safeloc.models.arbitration import ArbitrationConfig
from safeloc.models.arbitration.configurations import CONFIGURATIONS
from safeloc.properties import arbitration as claims
from safeloc.reported import Reported
from safeloc.target import Entry, Family, Pair, Target, single


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
        pairs=(
            Pair("length of the line beside tolerance", "tolerance_mm:down", "position_limit_mm:up", "design"),
            Pair("length of the line beside lag", "lag_limit_mm:down", "position_limit_mm:up", "design"),
            Pair("lag beside tolerance", "tolerance_mm:down", "lag_limit_mm:up", "design"),
            Pair("run of a cycle beside lag", "lag_limit_mm:down", "max_cycle_distance_mm:up", "design"),
            Pair("run of a cycle beside tolerance", "tolerance_mm:down", "max_cycle_distance_mm:up", "design"),
        ),
        silent=("arbitration",),
    ),
)
