"""A wire that is late by a cycle: a machine of its own stands on it, which tells in each step what it read in the step before.

An optional input comes late as a whole, with its flag of presence. In the first step it tells what stands for nothing: an absent
input, a flag that is not set, a neutral number.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from safeloc.language.checks.composition import Plan
from safeloc.language.expr import FALSE, Expr, Lit, NumVar, Var
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.nodes import Value
from safeloc.language.system import canonical, lower
from safeloc.language.units import Enumeration


def neutral(var: Var) -> Expr:
    """Return the value of a wire that tells nothing."""
    if not isinstance(var, NumVar):
        return FALSE
    return Lit(_neutral_number(var), var.unit)


def with_delay(plan: Plan, to: Sequence[Var]) -> Plan:
    """Return the plan with a machine before the one that has these wired inputs, through which their wires go."""
    place = next(number for number, system in enumerate(plan.systems) if to[0] in set(system.inputs))
    machine, inputs = _delaying(f"{plan.systems[place].name}, late {to[0].name}", to)
    wires = {**plan.wires}
    for var, read in inputs.items():
        wires[read] = plan.wires[var]
        wires[var] = machine.outputs[var.name]
    machines, systems = [*plan.machines], [*plan.systems]
    machines.insert(place, machine)
    systems.insert(place, lower(machine))
    return replace(plan, machines=machines, systems=systems, wires=wires)


def _delaying(name: str, of: Sequence[Var]) -> tuple[Machine, dict[Var, Var]]:
    """Return the machine, and for each variable the input that reads its value."""
    inputs, state, updates, outputs = dict[Var, Var](), dict[Var, Value](), dict[Var, Expr](), dict[str, Expr]()
    for var in of:
        read, kept, told = (replace(var, name=f"{var.name}, {word}") for word in ("read", "kept", "told"))
        inputs[var] = read
        state |= {kept: _first(var), told: _first(var)}
        updates |= {kept: read, told: kept}
        outputs[var.name] = told
    (on,) = modes("ON")
    return Machine(name, (on,), [*inputs.values()], state, outputs, [Transition("delays", on, on, set=updates)]), inputs


def _first(var: Var) -> Value:
    return _neutral_number(var) if isinstance(var, NumVar) else False


def _neutral_number(var: NumVar) -> int:
    return var.low if isinstance(var.unit, Enumeration) else canonical(var)
