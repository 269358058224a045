"""Mutants of the wires of a composition: another wire of the same unit, a wire that is cut, and a wrong term or output on one."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from safeloc.assurance.mutation.glue import Wire, glue_edits
from safeloc.assurance.mutation.members import Composed
from safeloc.assurance.mutation.mutants import LONGEST, Mutant, numbered
from safeloc.assurance.mutation.places import Places
from safeloc.language.expr import FALSE, Expr, Lit, NumVar, Optional, Var
from safeloc.language.machine import Machine
from safeloc.language.render import infix
from safeloc.language.system import canonical
from safeloc.language.units import Enumeration

_CROSSED = "another wire of the same unit"
_CUT = "wire cut"


@dataclass(frozen=True, eq=False)
class WireEdit:
    """A wrong wire: its mutant, and all wires of the composition with the change."""

    mutant: Mutant
    wires: Mapping[Var, Expr]


def wire_edits(composed: Composed, places: Places) -> list[WireEdit]:
    """Return all wrong wires, machine by machine, then the wrong terms on them; wires to ghosts of the world are not changed."""
    made = [pair for machine in composed.plan.machines for pair in _of_machine(composed, machine)]
    wires = composed.plan.wires
    wired = [
        Wire(machine, var, wires[var]) for machine in composed.plan.machines for var in _inputs(machine) if var in wires
    ]
    made += glue_edits(composed, places, wired)
    named = numbered(mutant for mutant, _ in made)
    return [WireEdit(mutant, wires) for mutant, (_, wires) in zip(named, made, strict=True)]


def _of_machine(composed: Composed, machine: Machine) -> Iterator[tuple[Mutant, Mapping[Var, Expr]]]:
    wires = composed.plan.wires
    wired = [var for var in _inputs(machine) if var in wires]
    for var, other in _next_of_unit(wired).items():
        if wires[var] is not wires[other]:
            words = f"{var.name} gets the value of {other.name}"
            yield _mutant(composed, machine, var, _CROSSED, words, wires[other]), {**wires, var: wires[other]}
    for var, changed in _cut(machine, wires):
        words = f"the wire to {var.name} is cut"
        yield _mutant(composed, machine, var, _CUT, words, changed[var]), {**wires, **changed}


def _inputs(machine: Machine) -> list[Var]:
    return [
        part for one in machine.inputs for part in ((one.value, one.present) if isinstance(one, Optional) else (one,))
    ]


def _next_of_unit(wired: list[Var]) -> dict[Var, Var]:
    """Return for each wired input the next one of the same unit and range; a value of another range could be inadmissible."""
    alike: dict[object, list[Var]] = defaultdict(list)
    for var in wired:
        alike[(var.unit, var.low, var.high) if isinstance(var, NumVar) else bool].append(var)
    found: dict[Var, Var] = {}
    for group in alike.values():
        if len(group) > 1:
            found |= dict(zip(group, [*group[1:], group[0]], strict=True))
    return found


def _cut(machine: Machine, wires: Mapping[Var, Expr]) -> Iterator[tuple[Var, dict[Var, Expr]]]:
    """Return the changed wires of each cut: an optional input is absent, any other one always has a neutral value."""
    for one in machine.inputs:
        if isinstance(one, Optional):
            if one.value in wires and one.present in wires:
                yield one.present, {one.value: _rest(one.value), one.present: FALSE}
        elif one in wires:
            yield one, {one: _rest(one)}


def _rest(var: Var) -> Expr:
    if not isinstance(var, NumVar):
        return FALSE
    return Lit(var.low if isinstance(var.unit, Enumeration) else canonical(var), var.unit)


def _mutant(composed: Composed, machine: Machine, var: Var, kind: str, words: str, becomes: Expr) -> Mutant:
    return Mutant(
        machine=composed.target.name,
        kind=kind,
        words=words,
        term=infix(composed.plan.wires[var], LONGEST),
        becomes=infix(becomes, LONGEST),
        where=(f"wire to {var.name} of {machine.name}",),
        alone=lambda of: of,
    )
