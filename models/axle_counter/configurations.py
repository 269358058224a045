"""Case splits of the counter that no configuration makes live."""

from __future__ import annotations

from safeloc.config import Configurations

NEVER = {
    "models/axle_counter/__init__.py: maximum(high * Lit(period, MS), 0) from _first(own)": "reported speeds of axles are not negative, so neither is the greatest speed of the train",
    "models/axle_counter/__init__.py: maximum(own.axle_speed_low.value - change, -most) from _first(own)": "the configuration refuses a train that could turn within a cycle: it would give no record",
}
"Case splits that no configuration makes live, with the reason."
CONFIGURATIONS = Configurations({}, NEVER)
