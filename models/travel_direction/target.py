"""The catalogue entry of the machine that finds the direction of travel."""

from __future__ import annotations

from safeloc.models import travel_direction
from safeloc.models.travel_direction import DirectionConfig
from safeloc.properties import travel_direction as claims
from safeloc.target import Entry, Family, Hazard, Target, single


def target(config: DirectionConfig) -> Target:
    """Make the machine."""
    model = travel_direction.build(travel_direction.parts(config))
    return single(model.machine, claims.properties(model), config)


ENTRIES = (
    Entry(
        "travel_direction",
        "direction of travel from reflectors around a balise",
        DirectionConfig,
        target,
        Family.MARKERS,
        place=60,
        no_interval="It tells a direction, no place.",
        hazard=Hazard("a false direction of travel is reported", ("direction is true",)),
        silent=("travel_direction",),
    ),
)
