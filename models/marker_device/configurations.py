"""Configurations in which the marker device is proved beside its defaults, so that no case of it stays folded away."""

from __future__ import annotations

from safeloc.config import Configurations
from safeloc.models.marker_device.configuration import MarkerDeviceConfig
from safeloc.models.odometry.variables import OdometryConfig

CONFIGURATIONS = Configurations(
    {
        "safe against a single fault, the first reference is believed": MarkerDeviceConfig(
            odometry=OdometryConfig(
                satellite_markers=True, trust_first_marker=True, single_fault_safe=True, tolerance_mm=45_000
            )
        ),
    }
)
