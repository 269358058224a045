"""The catalogue entry of the turn-off machine."""

from __future__ import annotations

from safeloc.models import turn_off
from safeloc.models.turn_off import TurnOffConfig
from safeloc.properties import turn_off as claims
from safeloc.target import Entry, Family, Hazard, Target, single


def target(config: TurnOffConfig) -> Target:
    """Make the machine."""
    model = turn_off.build(turn_off.parts(config))
    return single(model.machine, claims.properties(model), config)


ENTRIES = (
    Entry(
        "turn_off",
        "straight on or turning off, seen by radar",
        TurnOffConfig,
        target,
        Family.MARKERS,
        place=50,
        no_interval="It tells a course through a switch, no place.",
        hazard=Hazard("a false course through a switch is reported", ("course is true",)),
    ),
)
