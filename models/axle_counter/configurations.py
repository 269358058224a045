"""Case splits of the counter that the defaults fold away, and why each is folded in every configuration."""

from __future__ import annotations

from safeloc.config import Configurations

NEVER = {
    "models/axle_counter/__init__.py: maximum(high * Lit(period, MS), 0) from _first(own)": "told speeds of axles are not "
    "negative, so the greatest of the train is none",
    "models/axle_counter/__init__.py: maximum(own.slow.value - change, -most) from _first(own)": "a train that could turn "
    "within a cycle is refused by the configuration: it would give no record",
}
"""Case splits that no configuration makes live, and why."""
CONFIGURATIONS = Configurations({}, NEVER)
