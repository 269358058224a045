"""Configurations of the fibre that is timed, besides the defaults: other thresholds, and fibres that end elsewhere.

No case of it is folded away. But its threshold is computed from many figures, and each of these has its least threshold.
"""

from __future__ import annotations

from safeloc.config import Configurations
from safeloc.models.fibre import FibreConfig
from safeloc.models.fibre_timed.configuration import FibreTimedConfig
from safeloc.models.time_of_flight import TimeOfFlightConfig

CONFIGURATIONS = Configurations(
    {
        "the least threshold": FibreTimedConfig(fibre=FibreConfig(flight_threshold_mm=152_713)),
        "a fibre of 10 km along a slower line, its least threshold": FibreTimedConfig(
            fibre=FibreConfig(flight_threshold_mm=120_604, max_speed_mm_s=45_000),
            time_of_flight=TimeOfFlightConfig(fibre_mm=10_000_000),
        ),
        "a fibre of 80 km, few points, a wide threshold": FibreTimedConfig(
            fibre=FibreConfig(flight_threshold_mm=260_000),
            time_of_flight=TimeOfFlightConfig(fibre_mm=80_000_000, index_error_ppm=1_000),
            point_reach_mm=2_000_000,
        ),
    }
)
