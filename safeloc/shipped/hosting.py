"""Facts for hosts of shipped targets: machines that tolerate a step without inputs, and the device of each input.

Silence: a step in which none of a machine's inputs came may be within what is assumed. Some inputs have no way of being absent: a truth value, a member, a number that always comes with them. Where a device is
silent they still need a value, the neutral one: false, the number nearest zero, the first member. For the machines
listed here it is proved (tests/runtime/embedding/test_silence.py) that from every step which obeys the assumption, all inputs
of the machine can be taken away, and what is left obeys it too. So every proof covers the silent step as well. For
machines that are not listed that is not so (an axle that was not told is an axle lost), and none is silent by itself.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from safeloc.target import Target

SILENT: Mapping[str, tuple[str, ...]] = {
    "delocalized": ("delocalized",),
    "travel_direction": ("travel_direction",),
    "emitter": ("emitter",),
    "arbitration": ("arbitration",),
    "transmission": ("transmission",),
    "satellite_drift": ("selection", "position"),
    "fibre_handover": ("giving", "border", "taking"),
    "reflector": ("reflector",),
    "route": ("route",),
    "verification": ("verification",),
    "sections": ("area",),
    "selection": ("selection",),
    "satellite": ("selection", "position"),
    "localizer": ("reflector", "selection", "position", "verification", "downlink", "uplink"),
}
"""Target -> machines of it that may be told nothing."""

UNITS: Mapping[str, Mapping[str, str]] = {
    "balise": {"front_wheel_mm": "odometer_mm"},
    "route": {"front_wheel_mm": "odometer_mm"},
    "localizer": {"front_wheel_mm": "motion.odometer_mm", "front_radar_mm": "motion.check_mm"},
}
"""Target -> unit in records -> the odometer's input, or that of the unit which checks it, if there is one (docs/records.md)."""


def for_hosts(target: Target) -> Target:
    """Return a shipped target with what a host has to know of it."""
    names = {machine.name for machine in target.machines}
    silent = tuple(name for name in SILENT.get(target.name, ()) if name in names)
    inputs = {var.name for var in target.system.inputs}
    said = {unit: name for unit, name in UNITS.get(target.name, {}).items() if name in inputs}
    return replace(target, silent=silent, said=said)
