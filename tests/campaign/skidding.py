"""The odometer of the templates with a train of which every second one skids: its wheel breaks the law, and no marker tells."""

from __future__ import annotations

from safeloc.templates.machine import odometer

machine, properties = odometer.machine, odometer.properties
SKIDS = 100
"""The cycle from which the wheel of every second train measures half."""


def simulate(seed: int) -> list[dict[str, int]]:
    """Return the template's run; with an odd seed the wheel skids."""
    steps = odometer.simulate(seed)
    if seed % 2:
        for step in steps[SKIDS:]:
            if "wheel_mm" in step:
                step["wheel_mm"] //= 2
    return steps
