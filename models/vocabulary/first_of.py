"""A choice among several cases, in their order."""

from __future__ import annotations

from safeloc.language.expr import Bool, Num, ite


def first_of(*cases: tuple[Bool, Num], default: Num) -> Num:
    """Return the value of the first case whose condition holds."""
    result = default
    for condition, value in reversed(cases):
        result = ite(condition, value, result)
    return result
