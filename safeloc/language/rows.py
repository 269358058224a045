"""The updates of one row of a transition table, put together from named groups.

    heard = {own.band: cycle.band, own.gap: cycle.gap}          # the groups stand beside the table
    anew = {own.since: 0, own.drift: cycle.fresh}
    yield Transition("section passed", located, located, cycle.leaves, together(heard, anew, {own.base: own.far}))

Mappings joined with `|` or `**` let the last one win in silence. Groups joined with `together` set each variable once.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeAlias

from safeloc.errors import ModelError, declared_at
from safeloc.language.expr import Expr, Var
from safeloc.language.nodes import Value

Updates: TypeAlias = Mapping[Var, Expr | Value]
"""Variable of state -> its next value."""


def together(*groups: Updates) -> dict[Var, Expr | Value]:
    """Return the updates of all groups as one mapping. ModelError if two groups set the same variable."""
    row: dict[Var, Expr | Value] = {}
    for group in groups:
        twice = [var.name for var in group if var in row]
        if twice:
            raise ModelError(
                f"{declared_at()}: {', '.join(twice)}: set by two groups of one row; leave the variable out of one of them."
            )
        row.update(group)
    return row
