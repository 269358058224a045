"""The tables of a JavaScript machine: its variables, its transitions, and the names of what it computes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from safeloc.codegen.javascript_parts import Member, Parts, Terms, claims, laws, members, terms_of
from safeloc.language.absence import stand_in_of, value_while_present
from safeloc.language.expr import Expr, Lit, Num, NumVar, Var
from safeloc.language.first_values import Any_
from safeloc.language.nodes import Value
from safeloc.language.ranges import bounds
from safeloc.language.render import infix
from safeloc.language.spec import Property
from safeloc.language.system import TransitionSystem, canonical
from safeloc.language.transition_rows import transition_rows
from safeloc.language.transition_table import Modes
from safeloc.language.units import Enumeration

Table = dict[str, Any]


def tables(parts: Parts, first: Mapping[str, Value], properties: Sequence[Property]) -> Table:
    """Return all tables, as JSON holds them; what they need the value of gets a place in `parts`.

    first       first values of variables whose first value is open, instead of those nearest to zero
    properties  what the machine monitors
    """
    system = parts.system
    every = members(system)
    rows = [_Rows(parts, member, terms_of(parts, member)) for member in every]
    return {
        "name": system.name,
        "machines": [member.machine.name for member in every],
        "variables": [*_state(system, first), *_inputs(system), *_outputs(system)],
        "inputs": [var.name for var in system.inputs],
        "recorded": _recorded(system),
        "fired": [_labels(var) for var in system.fired],
        "transitions": [row for one in rows for row in one.transitions()],
        "rows": _home(system, rows),
        "named": [one for row in rows for one in row.named()],
        "laws": [{"name": name, "place": parts.place(term)} for name, term in laws(system).items()],
        "claims": claims(parts, tuple(properties)),
        "slots": parts.slots,
        "nodes": parts.nodes,
        "names": [place for one in parts.names for place in one],
        "units": parts.units,
        "texts": list(parts.texts),
    }


# ------------------------------------------------------------------ variables


def _state(system: TransitionSystem, first: Mapping[str, Value]) -> list[Table]:
    return [{**_variable(system, var, "state"), **_first(system, var, first)} for var in system.state]


def _inputs(system: TransitionSystem) -> list[Table]:
    flags = {option.present: option.value for option in system.optionals}
    present = {option.value: option.present.name for option in system.optionals}
    found = []
    for var in system.inputs:
        if var in flags:
            continue
        table = {**_variable(system, var, "input"), "optional": var in present}
        if isinstance(var, NumVar) and var in present:
            table |= {"present": present[var], "absent": str(canonical(var))}
        found.append(table)
    return found


def _recorded(system: TransitionSystem) -> list[str]:
    """Return the inputs in the order in which the interpreter reads and recordings hold them: those that may be absent first."""
    optional = [option.value.name for option in system.optionals]
    flags = [option.present.name for option in system.optionals]
    return [*optional, *(var.name for var in system.inputs if var.name not in {*optional, *flags})]


def _outputs(system: TransitionSystem) -> list[Table]:
    of = bounds(system.outputs.values())
    found = []
    for name, term in system.outputs.items():
        stand_in = stand_in_of(term)
        low, high = of[value_while_present(term)] if isinstance(term, Num) else (0, 1)
        table = {"name": name, "role": "output", **_kind(term, low, high), "optional": stand_in is not None}
        found.append({**table, "text": infix(term), **({} if stand_in is None else {"absent": str(stand_in)})})
    return found


def _variable(system: TransitionSystem, var: Var, role: str) -> Table:
    low, high = (var.low, var.high) if isinstance(var, NumVar) else (0, 1)
    ghost = {"ghost": True} if var in system.ghosts else {}
    return {
        "name": var.name,
        "role": role,
        **_kind(var, low, high),
        "optional": False,
        "text": _place(var.src),
        **ghost,
    }


def _kind(term: Expr, low: int, high: int) -> Table:
    """Return the kind of a value, its unit or members, and its range."""
    if not isinstance(term, Num):
        return {"kind": "boolean", "unit": "", "values": [], "least": "", "most": ""}
    if isinstance(term.unit, Enumeration):
        kind = "mode" if isinstance(term.unit, Modes) else "enumeration"
        return {"kind": kind, "unit": "", "values": _labels(term), "least": str(low), "most": str(high)}
    return {"kind": "integer", "unit": term.unit.name, "values": [], "least": str(low), "most": str(high)}


def _labels(term: Num) -> list[str]:
    assert isinstance(term.unit, Enumeration)
    return list(term.unit.members)


def _first(system: TransitionSystem, var: Var, chosen: Mapping[str, Value]) -> Table:
    """Return the first value as text, or as truth value, and whether it is open."""
    declared = system.initial[var]
    is_open = isinstance(declared, Any_)
    if isinstance(declared, Any_):
        value = chosen.get(var.name, canonical(var) if isinstance(var, NumVar) else False)
    else:
        value = declared.value if isinstance(declared, Lit) else declared
    return {"first": str(int(value)) if isinstance(var, NumVar) else value, "open": is_open}


def _place(declared: str) -> str:
    """Return file and line of a declaration, the file by its name alone."""
    return declared.rpartition("/")[2]


# ------------------------------------------------------------------ transitions and named terms


class _Rows:
    """The transitions of one machine, with the parts of their guards."""

    def __init__(self, parts: Parts, member: Member, terms: Terms) -> None:
        self._terms, self._parts, self._member = terms, parts, member
        self._machine = member.machine
        self._mode = member.in_a_step(member.machine.mode)
        self._rows = transition_rows(self._machine)

    @property
    def mode(self) -> Expr:
        """The variable of the machine's mode."""
        return self._mode

    @property
    def order(self) -> list[int]:
        """The places of the transitions in the order in which they are tried."""
        ranks = [one.rank for one in self._machine.transitions]
        return sorted(range(len(ranks)), key=ranks.__getitem__)

    def transitions(self) -> list[Table]:
        """Return the transitions as declared."""
        return [
            {
                "name": row.name,
                "machine": self._machine.name,
                "source": row.source,
                "sources": [mode.label for mode in one.sources],
                "target": row.target,
                "guard": self._parts.text(row.guard),
                "order": row.rank,
                "declared": row.declared,
                "sets": [self._parts.text(text) for text in row.sets],
                "part": self._terms.place(one.when),
            }
            for one, row in zip(self._machine.transitions, self._rows, strict=True)
        ]

    def named(self) -> list[Table]:
        """Return the terms that the machine names, and in a composition its wired inputs; on board those that read no ghost."""
        member, parts = self._member, self._parts
        every = {**member.machine.definitions, **{var.name: var for var in member.wired}}
        found = []
        for name, term in every.items():
            if parts.knows(member.in_a_step(term)):
                low, high = bounds([term])[term] if isinstance(term, Num) else (0, 1)
                table = {"name": f"{member.prefix}{name}", "machine": member.machine.name, **_kind(term, low, high)}
                found.append({**table, "place": self._terms.place(term)})
        return found


def _home(system: TransitionSystem, rows: Sequence[_Rows]) -> list[Table]:
    """Return of each machine the place of its mode in the state, and its transitions in the order in which they are tried."""
    places: Mapping[Expr, int] = {var: place for place, var in enumerate(system.state)}
    found, before = list[Table](), 0
    for one in rows:
        found.append({"mode": places[one.mode], "order": [before + place for place in one.order]})
        before += len(one.order)
    return found
