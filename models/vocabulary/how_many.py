"""The number of conditions that hold, as a term of a machine."""

from __future__ import annotations

from collections.abc import Iterable

from safeloc.language.expr import Bool, Num, as_num, ite
from safeloc.language.units import COUNT


def how_many(conditions: Iterable[Bool]) -> Num:
    """Return how many of the conditions hold."""
    total = as_num(0, COUNT)
    for one in conditions:
        total = total + ite(one, as_num(1, COUNT), 0)
    return total
