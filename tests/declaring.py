"""Declares machines for tests from keywords in which the world's fields stand beside the machine's own."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

from safeloc.language.machine import Machine
from safeloc.language.world import World

OF_THE_WORLD = frozenset(field.name for field in fields(World))


def declared(**given: Any) -> Machine:
    """A machine; ghosts, choices, moves and clauses become its world."""
    world = World(**{name: value for name, value in given.items() if name in OF_THE_WORLD})
    return Machine(**{name: value for name, value in given.items() if name not in OF_THE_WORLD}, world=world)


def changed(machine: Machine, **given: Any) -> Machine:
    """The machine with some fields replaced, those of its world among them."""
    world = replace(machine.world, **{name: value for name, value in given.items() if name in OF_THE_WORLD})
    return replace(machine, **{name: value for name, value in given.items() if name not in OF_THE_WORLD}, world=world)
