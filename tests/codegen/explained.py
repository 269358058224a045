"""What `safeloc step` tells of a step, in the form in which a script tells it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from safeloc.explain.failing_parts import Part, unfolded
from safeloc.explain.stepping import RowView, _parts, laws_broken, rows_at
from safeloc.language.expr import Expr, Var
from safeloc.language.interpret import evaluate
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
    return {
        "transition": row.name,
        "machine": row.machine,
        "target": row.target,
        "enabled": row.enabled,
        "fires": row.fires,
        "parts": [part_told(part) for part in row.why],
    }


def part_told(part: Part) -> dict[str, Any]:
    """A part of a tree."""
    return {
        "text": part.text,
        "value": part.holds,
        "depth": part.depth,
        "values": part.values,
        "leftOut": part.left_out,
    }


def unfolded_rows(
    system: TransitionSystem, state: Mapping[Var, Value], inputs: Mapping[Var, Value], deep: int
) -> list[list[dict[str, Any]]]:
    """The guard of each transition of the present modes, some levels down; a wire leads on in the whole, which this leaves out."""
    found = []
    views = rows_at(system, state, inputs)
    for machine in _parts(system):
        terms = machine.terms()
        values = evaluate([machine.in_a_step(term) for term in terms], {**state, **inputs})
        known = dict(zip(terms, values, strict=True))
        own = [view.name for view in views if view.machine == machine.machine.name]
        found += [_levels(machine.guards[name], known, machine.names, deep) for name in own]
    return found


def _levels(term: Expr, known: Mapping[Expr, Value], names: Mapping[Expr, str], deep: int) -> list[dict[str, Any]]:
    if not deep:
        return []
    return [
        {
            "name": one.name,
            "text": one.text,
            "value": one.value,
            "decides": one.decides,
            "reads": [list(read) for read in one.reads],
            "parts": _levels(one.term, known, names, deep - 1),
        }
        for one in unfolded(term, known, names)
    ]


def without_wires(rows: list[Any], own: list[Any]) -> list[Any]:
    """The levels of a script without the one part that a wire brings from another machine, below a variable that has no parts."""
    return [_without_wire(row, one) for row, one in zip(rows, own, strict=True)]


def _without_wire(level: list[Any], own: list[Any]) -> list[Any]:
    if not own:
        return level[1:]
    return [
        {**part, "parts": _without_wire(part["parts"], other["parts"])}
        for part, other in zip(level, own, strict=len(level) == len(own))
    ]
