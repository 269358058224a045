"""Terms that several laws of a line area share: the end at which a train came in, and lengths in um."""

from __future__ import annotations

from safeloc.language.expr import Bool, Num, exact_to, ite
from safeloc.language.units import UM
from safeloc.models.area.slot import ENTERS_HIGH, ENTERS_LOW, Slot


def came_in(one: Slot) -> tuple[Bool, Bool]:
    """Return the conditions that the train came in at the low end and at the high end, in this cycle or before."""
    low, high = (one.event.eq(end) for end in (ENTERS_LOW, ENTERS_HIGH))
    return ite(one.enters, low, one.from_low), ite(one.enters, high, one.from_high)


def um(term: Num) -> Num:
    """Return a length in mm as um."""
    return exact_to(term, UM)
