"""Machines with a fault put in on purpose, to see that a proof or a test notices it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from safeloc.language.expr import Expr
from safeloc.language.machine import Machine, Transition


def rebuilt(
    machine: Machine, transitions: Sequence[Transition], *, outputs: Mapping[str, Expr] | None = None
) -> Machine:
    """The machine with another table, or other outputs as well, and the same variables."""
    return replace(machine, transitions=transitions, outputs=machine.outputs if outputs is None else outputs)
