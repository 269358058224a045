"""The catalogue entry of the example of a new machine."""

from __future__ import annotations

from safeloc.models import standstill
from safeloc.models.standstill import StandstillConfig
from safeloc.properties import standstill as claims
from safeloc.target import Entry, Family, Target, single


def target(config: StandstillConfig) -> Target:
    """Make the machine."""
    model = standstill.build(standstill.Parts(config))
    return single(model.machine, claims.properties(model), config)


ENTRIES = (
    Entry(
        "standstill",
        "whether the vehicle stands",
        StandstillConfig,
        target,
        Family.ODOMETRY,
        no_interval="It tells no place.",
    ),
)
