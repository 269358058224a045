"""Configurations of the time of flight, besides the defaults."""

from __future__ import annotations

from safeloc.config import Configurations
from safeloc.models.time_of_flight.variables import TimeOfFlightConfig

CONFIGURATIONS = Configurations(
    {
        "a cable as long as its track": TimeOfFlightConfig(slack_ppm=0),
        "another index and faster pulses": TimeOfFlightConfig(
            fibre_mm=10_000_000, pulse_hz=10_000, index_ppm=1_450_000, index_error_ppm=1_000
        ),
    }
)
