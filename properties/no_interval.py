"""Outputs of a machine while it reports no interval."""

from __future__ import annotations

from safeloc.language.expr import Bool, all_of
from safeloc.language.machine import Machine
from safeloc.models.vocabulary.absent import NO_MARGIN_MM, NO_POSITION_MM


def no_interval(machine: Machine) -> Bool:
    """Position and both margins are absent: what is shown can be taken for no place and for no margin."""
    margins = [machine.output(name).eq(NO_MARGIN_MM) for name in ("margin_above_mm", "margin_below_mm")]
    return all_of([machine.output("position_mm").eq(NO_POSITION_MM), *margins])
