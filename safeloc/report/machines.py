"""A machine as the report shows it, as JSON-ready data: modes, transitions, variables, assumption."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from safeloc.backends.diagram import to_svg, to_table
from safeloc.catalogue import Target
from safeloc.checks import input_variables
from safeloc.expr import Expr, Num, NumVar, Var
from safeloc.machine import Machine
from safeloc.ranges import bounds
from safeloc.render import infix
from safeloc.units import Enumeration

LONGEST_TERM = 4000


def machine_data(target: Target) -> dict[str, Any]:
    """Everything the page says of a target apart from verdicts."""
    system = target.system
    signals: dict[str, Expr] = {var.name: var for var in (*system.state, *system.inputs)} | dict(system.outputs)
    return {
        "name": target.name,
        "doc": target.doc,
        "state_variables": len(system.state),
        "inputs": len(system.inputs),
        "transitions": sum(len(machine.transitions) for machine in target.machines),
        "configuration": None if target.config is None else target.config.model_dump(mode="json"),
        "reported": None if target.reported is None else asdict(target.reported),
        "signals": {name: _signal(term) for name, term in signals.items()},
        "parts": [_part(machine) for machine in target.machines],
    }


def _signal(term: Expr) -> dict[str, Any]:
    """Unit and member names, so that a trace can be read without the machine."""
    if not isinstance(term, Num):
        return {"unit": "", "members": []}
    if isinstance(term.unit, Enumeration):
        return {"unit": "", "members": list(term.unit.members)}
    return {"unit": term.unit.name, "members": []}


def _part(machine: Machine) -> dict[str, Any]:
    kinds: list[tuple[str, Sequence[Var]]] = [
        ("input", input_variables(machine)),
        ("state", list(machine.state)),
        ("ghost", [*machine.ghosts, *machine.ghost_inputs]),
    ]
    variables = [_variable(kind, var.name, var) for kind, listed in kinds for var in listed]
    return {
        "name": machine.name,
        "svg": to_svg(machine),
        "table": [
            asdict(row) | {"sets": list(row.sets), "requirements": list(row.requirements)} for row in to_table(machine)
        ],
        "variables": variables + [_variable("output", name, term) for name, term in machine.outputs.items()],
        "assumption": infix(machine.assumption, LONGEST_TERM),
    }


def _variable(kind: str, name: str, term: Expr) -> dict[str, str]:
    """Name, unit and range; of an output the bounds that its parts allow."""
    if not isinstance(term, Num):
        return {"name": name, "kind": kind, "unit": "", "range": "true, false"}
    if isinstance(term.unit, Enumeration):
        return {"name": name, "kind": kind, "unit": "", "range": ", ".join(term.unit.members)}
    low, high = (term.low, term.high) if isinstance(term, NumVar) else bounds([term])[term]
    return {"name": name, "kind": kind, "unit": term.unit.name, "range": f"{low} .. {high}"}
