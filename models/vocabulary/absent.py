"""Outputs of an interval while a machine reports none: numbers that nobody can take for a place or a margin."""

from __future__ import annotations

from typing import Final

from safeloc.language.absence import NO_BOUND, NO_PLACE, shown_if, zero_while_absent
from safeloc.language.expr import Bool, Num
from safeloc.language.machine import Machine

NO_POSITION_MM: Final = NO_PLACE
"""Shown as a position while there is none: two million kilometres off, no place of any line."""
NO_MARGIN_MM: Final = NO_BOUND
"""Shown as a margin while there is no position: beyond every tolerable error."""


def position_if(valid: Bool, position_mm: Num) -> Num:
    """Return the output of a position, or of an end of an interval, that is absent unless `valid`."""
    return shown_if(valid, position_mm, NO_POSITION_MM)


def margin_if(valid: Bool, margin_mm: Num) -> Num:
    """Return the output of a margin that is absent unless `valid`."""
    return shown_if(valid, margin_mm, NO_MARGIN_MM)


def wired_interval(machine: Machine) -> tuple[Num, Num, Num]:
    """Return position, margin below and margin above of a machine for a wire: 0 while they are absent."""
    names = ("position_mm", "margin_below_mm", "margin_above_mm")
    position, below, above = (zero_while_absent(machine.output(name)) for name in names)
    return position, below, above
