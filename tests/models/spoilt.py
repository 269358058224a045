"""Machines with a fault put in on purpose, to see that a proof or a test notices it."""

from __future__ import annotations

from collections.abc import Sequence

from safeloc.language.machine import Machine, Transition


def rebuilt(machine: Machine, transitions: Sequence[Transition]) -> Machine:
    """The machine with another table and the same variables."""
    fields = {
        f: getattr(machine, f) for f in machine.__dataclass_fields__ if f not in ("mode", "fired_name", "transitions")
    }
    return Machine(**{**fields, "transitions": transitions, "mode_variable": machine.mode})
