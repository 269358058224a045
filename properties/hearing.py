"""Terms of claims on what one machine of a composition hears of another in the same step."""

from __future__ import annotations

from collections.abc import Iterable

from safeloc.language.expr import Bool, Num, Optional, all_of
from safeloc.language.machine import Machine
from safeloc.language.terms import Substitution

INTERVAL = ("position_mm", "margin_below_mm", "margin_above_mm")
"""Outputs of every machine that states an interval."""


def hears_interval(into: Substitution, heard: Iterable[Num], said: Substitution, machine: Machine) -> Bool:
    """Return whether position, margin below and margin above are heard as the machine states them; `into` and `said` as `Composition.of`."""
    return all_of(into.num(mine).eq(said.num(machine.output(name))) for mine, name in zip(heard, INTERVAL, strict=True))


def hears_value(into: Substitution, to: Optional, present: Bool, value: Num) -> Bool:
    """Return whether a value is heard in exactly the cycles in which there is one, and that very value."""
    return into.bool(to.present).iff(present) & present.implies(into.num(to.value).eq(value))
