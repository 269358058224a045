"""Machines that may be told nothing: a step in which none of their inputs came is within what is assumed.

Some inputs have no way of being absent: a truth value, a member, a number that always comes with them. Where a device is
silent they still need a value, the neutral one: false, the number nearest zero, the first member. For the machines
listed here it is proved (tests/embedding/test_silence.py) that from every step which obeys the assumption, all inputs
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
"""Target -> machines of it."""


def with_silence(target: Target) -> Target:
    """A shipped target that knows which of its machines may be silent."""
    names = {machine.name for machine in target.machines}
    return replace(target, silent=tuple(name for name in SILENT.get(target.name, ()) if name in names))
