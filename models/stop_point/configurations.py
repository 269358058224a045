"""Case splits of the stop-point machine that the defaults fold away, with the reason why every configuration does."""

from __future__ import annotations

from safeloc.config import Configurations

NEVER = {
    "properties/stop_point/orders.py: 0 * own.speed from yield from maker(model)": "a zero with the unit of a speed",
}
"""Case splits that no configuration makes live, with the reason."""
CONFIGURATIONS = Configurations({}, NEVER)
