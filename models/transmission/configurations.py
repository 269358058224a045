"""Case splits of transmission that the defaults fold away, and why each is folded in every configuration."""

from __future__ import annotations

from safeloc.config import Configurations

NEVER = {
    'properties/transmission.py: machine.output("age_ms") <= own.config.age_limit_ms from maker(model)': "its sides are the bounds of the declared range: the claim is proved by the range obligation"
}
"""Case splits that no configuration makes live, and why."""
CONFIGURATIONS = Configurations({}, NEVER)
