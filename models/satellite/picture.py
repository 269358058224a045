"""Declares the picture of a run with satellites, and the outputs that form its interval."""

from __future__ import annotations

from safeloc.models.satellite.variables import SatelliteConfig
from safeloc.railway.pictures import Deviation, Picture, Standing, Standings, Stanford
from safeloc.reported import Reported
from safeloc.sensing.satellite.channels import satellite_name

REPORTED = Reported(
    position="position.position_mm",
    below="position.margin_below_mm",
    above="position.margin_above_mm",
    valid="position.valid",
    truth="position.truth_nm",
)
BOUNDED = Reported(
    position="position.position_mm",
    below="position.drift_bound_mm",
    above="position.drift_bound_mm",
    valid="position.drift_checked",
    truth="position.truth_nm",
)
"""The interval where nothing is assumed of any signal: its margins are the proved bound of the drift."""


def pictures(reported: Reported, config: SatelliteConfig) -> tuple[Picture, ...]:
    """List the pictures of every recorded run."""
    channels = [f"selection.channel_{number}" for number in range(1, config.selection.channels + 1)]
    rows = tuple(Standing(f"{channel}_standing", f"{channel}_held") for channel in channels)
    return (
        Deviation("Deviation along the track", reported, config.tolerance_mm, mode="position.mode"),
        Standings("Satellites by channel", reported, rows, satellite_name),
        Stanford("Error against the margin stated for it", reported, config.tolerance_mm),
    )
