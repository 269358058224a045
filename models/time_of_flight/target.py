"""The catalogue entry of the time of flight of one end of a train."""

from __future__ import annotations

from safeloc.models import time_of_flight
from safeloc.models.time_of_flight import TimeOfFlightConfig
from safeloc.models.time_of_flight.configurations import CONFIGURATIONS
from safeloc.models.time_of_flight.simulate import simulate
from safeloc.properties import time_of_flight as claims
from safeloc.reported import Reported
from safeloc.target import Entry, Family, Hazard, Pair, Target, single


def target(config: TimeOfFlightConfig) -> Target:
    """Make the machine."""
    model = time_of_flight.build(time_of_flight.parts(config))
    properties = claims.properties(model)
    return single(
        model.machine, properties, config, reported=Reported(), simulate=lambda seed: simulate(config, seed=seed)
    )


ENTRIES = (
    Entry(
        "time_of_flight",
        "distance along a fibre by the time of flight of light",
        TimeOfFlightConfig,
        target,
        Family.FIBRE,
        place=15,
        simulates=True,
        pairs=(
            Pair("rate of pulses beside length of the fibre", "pulse_hz:up", "fibre_mm:up"),
            Pair("error of the index beside length of the fibre", "index_error_ppm:up", "fibre_mm:up"),
            Pair("error of the trigger beside resolution", "trigger_error_ps:up", "resolution_ps:up"),
            Pair("slack of the cable beside error of its map", "slack_ppm:up", "map_error_mm:up"),
            Pair("slack of the cable beside place of the pattern", "pattern_error_mm:up", "slack_ppm:up"),
        ),
        configurations=CONFIGURATIONS,
        hazard=Hazard(
            "a distance along the fibre is reported that is not the vehicle's",
            ("the distance holds the vehicle",),
        ),
        silent=("time_of_flight",),
    ),
)
