"""Configurations of the device, besides the defaults, in which its claims are proved: all machines in the counter's own cycle."""

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

_SHORT = FibreDeviceConfig(
    area=FibreAreaConfig(
        axle_section=AxleSectionConfig(axles_a_cycle=10, lead_cycles=50),
        fibre=FibreConfig(period_ms=100, gap_limit_cycles=20, flight_threshold_mm=155_000),
        verification=VerificationConfig(
            period_ms=100, length_limit_mm=1_600_000, reference_age_limit_cycles=20, currency_cycles=50
        ),
        sections=SectionsConfig(area=AreaConfig(trains=1, period_ms=100), following=Following(accuracy_mm=860_000)),
        record_wait_cycles=1_200,
    ),
    counter=AxleCounterConfig(),
)
CONFIGURATIONS = Configurations({"cycles of 100 ms": _SHORT})
