"""Configurations of the device, besides the defaults, in which its claims are proved: all machines in the counter's own cycle, and another train in the area."""

from __future__ import annotations

from safeloc.config import Configurations
from safeloc.models.area import AreaConfig
from safeloc.models.area.separation import Following
from safeloc.models.axle_counter import AxleCounterConfig
from safeloc.models.axle_section import AxleSectionConfig
from safeloc.models.fibre import FibreConfig
from safeloc.models.fibre_area import FibreAreaConfig
from safeloc.models.fibre_device.configuration import FibreDeviceConfig
from safeloc.models.sections import SectionsConfig
from safeloc.models.verification import VerificationConfig

_SPEED_MM_S = AreaConfig().max_speed_mm_s
_SHORT = FibreDeviceConfig(
    area=FibreAreaConfig(
        axle_section=AxleSectionConfig(axles_a_cycle=10, lead_cycles=50),
        fibre=FibreConfig(period_ms=100, gap_limit_cycles=20, floor_mm=400, flight_threshold_mm=155_000),
        verification=VerificationConfig(
            period_ms=100,
            length_limit_mm=1_600_000,
            max_speed_mm_s=_SPEED_MM_S,
            reference_age_limit_cycles=20,
            currency_cycles=50,
        ),
        sections=SectionsConfig(area=AreaConfig(trains=1, period_ms=100), following=Following(accuracy_mm=860_000)),
        record_wait_cycles=1_200,
    ),
    counter=AxleCounterConfig(max_speed_mm_s=_SPEED_MM_S, length_spread_mm=200_000),
)
_USUAL = FibreDeviceConfig()
_TWO_TRAINS = FibreDeviceConfig(
    area=_USUAL.area.model_copy(
        update={
            "sections": SectionsConfig(
                area=AreaConfig(trains=2, period_ms=500), following=Following(accuracy_mm=860_000)
            )
        }
    )
)
CONFIGURATIONS = Configurations({"cycles of 100 ms": _SHORT, "two trains": _TWO_TRAINS})
