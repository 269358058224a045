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
    "properties/satellite/__init__.py: coasted <= own.config.coast_limit_cycles from maker(model)": "its sides are the bounds of the declared range: the claim is proved by the range obligation",
    "properties/satellite/state.py: speed + speed_level >= -fast from meets(model)": "a solution's speed has this range (fix_speed_um_s): it is so for all there are",
    "properties/satellite/state.py: speed - speed_level <= fast from meets(model)": "a solution's speed has this range (fix_speed_um_s): it is so for all there are",
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
