"""Machines with a fault put in on purpose, to see that a proof or a test notices it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from safeloc.language.expr import Expr
from safeloc.language.machine import Machine, Transition


def rebuilt(
    machine: Machine, transitions: Sequence[Transition], *, outputs: Mapping[str, Expr] | None = None
) -> Machine:
    """The machine with another table, or other outputs as well, and the same variables."""
    fields = {
        f: getattr(machine, f) for f in machine.__dataclass_fields__ if f not in ("mode", "fired_name", "transitions")
    }
    given = {} if outputs is None else {"outputs": outputs}
    return Machine(**{**fields, **given, "transitions": transitions, "mode_variable": machine.mode})
