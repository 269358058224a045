"""What `safeloc step` tells of a step, in the form in which a script tells it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from safeloc.explain.stepping import RowView, laws_broken, rows_at
from safeloc.language.expr import Var
from safeloc.language.nodes import Value
from safeloc.language.system import TransitionSystem


def broken(system: TransitionSystem, state: Mapping[Var, Value], inputs: Mapping[Var, Value]) -> list[str]:
    """The laws that the step breaks; on board there are none."""
    return laws_broken(system, state, inputs) if system.ghosts else []


def explained(
    system: TransitionSystem, state: Mapping[Var, Value], inputs: Mapping[Var, Value]
) -> list[dict[str, Any]]:
    """The transitions of each present mode, with the reason why they are enabled or refused."""
    return [_row(row) for row in rows_at(system, state, inputs)]


def _row(row: RowView) -> dict[str, Any]:
    parts = [
        {"text": part.text, "value": part.holds, "depth": part.depth, "values": part.values, "leftOut": part.left_out}
        for part in row.why
    ]
    return {
        "transition": row.name,
        "machine": row.machine,
        "target": row.target,
        "enabled": row.enabled,
        "fires": row.fires,
        "parts": parts,
    }
