"""Case splits of stop_point that the defaults fold away, and why each is folded in every configuration."""

from __future__ import annotations

from safeloc.config import Configurations

NEVER = {
    "properties/stop_point/orders.py: 0 * own.speed from yield from maker(model)": "a zero with the unit of a speed",
}
"""Case splits that no configuration makes live, and why."""
CONFIGURATIONS = Configurations({}, NEVER)
