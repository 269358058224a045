"""The catalogue entry of the turn-off machine."""

from __future__ import annotations

from safeloc.models import turn_off
from safeloc.models.turn_off import TurnOffConfig
from safeloc.properties import turn_off as claims
from safeloc.target import Entry, Family, Hazard, Pair, Target, single


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
        pairs=(
            Pair("sway beside lateral error", "lateral_error_mm:down", "sway_mm:up"),
            Pair("lateral error beside sway", "sway_mm:down", "lateral_error_mm:up"),
            Pair("lateral error beside shift of a turnout", "least_shift_mm:up", "lateral_error_mm:up"),
            Pair("shift of a turnout beside lateral error", "lateral_error_mm:down", "least_shift_mm:down"),
            Pair("shift of a turnout beside sway", "sway_mm:down", "least_shift_mm:down"),
        ),
        hazard=Hazard("a false course through a switch is reported", ("course is true",)),
    ),
)
