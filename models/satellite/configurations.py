"""Configurations in which position from satellites is proved beside its defaults, so that no case of it stays folded away."""

from __future__ import annotations

from safeloc.config import Configurations
from safeloc.models.satellite.variables import SatelliteConfig
from safeloc.models.satellite_selection import SelectionConfig

NEVER = {
    "models/satellite/__init__.py: ite(anchor.kept, anchor.margin, nothing) from _anchor(own, anchor)": "at a reference the anchor is kept; live in all other rows",
    "models/satellite/__init__.py: ite(anchor.kept, anchor.offset, nothing) from _anchor(own, anchor)": "at a reference the anchor is kept; live in all other rows",
    "models/satellite/motion.py: between(-limit, state.position, limit) from reportable(own, known)": "a reference has this range; live of all other states",
    "models/satellite/variables.py: truth is None": "a truth is handed over where motion moves the vehicle: in the localizer",
}
"""Case splits that no configuration makes live, and why."""
CONFIGURATIONS = Configurations(
    {
        "pseudorange alone": SatelliteConfig(selection=SelectionConfig(compared="pseudorange")),
        "Doppler alone": SatelliteConfig(selection=SelectionConfig(compared="doppler")),
        "odometry required": SatelliteConfig(drift_check="required"),
    },
    NEVER,
)
