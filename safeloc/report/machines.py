"""A machine as JSON-ready data for the report: modes, transitions, variables, assumption, configuration.

Terms are written in full (safeloc.report.exact), so that a reader can see exactly what was verified.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from typing import Any

from safeloc.assurance.register import Assumption, register
from safeloc.catalogue import Target
from safeloc.codegen.diagram import to_svg
from safeloc.config import figures
from safeloc.language.checks.machine import input_variables, read_of_machine
from safeloc.language.digest import declaration_digest, full_digest
from safeloc.language.machine import Any_, Machine, Transition
from safeloc.language.nodes import Bool, Expr, Lit, Num, NumVar, Truth, Value, Var
from safeloc.language.ranges import bounds
from safeloc.language.render import infix
from safeloc.language.spec import Property
from safeloc.language.system import without_ghosts
from safeloc.language.terms import Sharing, conjuncts
from safeloc.language.units import Enumeration
from safeloc.report.declared import declarations, place
from safeloc.report.exact import Exact, spelled_alone
from safeloc.reported import Reported


def machine_data(target: Target) -> dict[str, Any]:
    """Return everything on a target that the page shows, except verdicts."""
    system = target.system
    assumed = {(one.machine, one.name): one for one in register(target)}
    signals: dict[str, Expr] = {var.name: var for var in (*system.state, *system.inputs)} | dict(system.outputs)
    return {
        "name": target.name,
        "spec": target.spec,
        "declaration": full_digest(system),
        "exported": declaration_digest(without_ghosts(system)),
        "doc": target.doc,
        "state_variables": len(system.state),
        "inputs": len(system.inputs),
        "transitions": sum(len(machine.transitions) for machine in target.machines),
        "configuration": configuration_of(target),
        "figures": [] if target.config is None else list(figures(target.config)),
        "reported": None if target.reported is None else _interval(target.reported),
        "signals": {name: _signal(term) for name, term in signals.items()},
        "parts": [
            {"section": target.sections.get(machine.name, machine.name), **_part(machine, assumed)}
            for machine in target.machines
        ],
        "formulas": {
            prop.name: _formula(target, prop) for prop in target.properties if prop.statement in ("", prop.name)
        },
        "declared": declarations(target),
    }


def _formula(target: Target, prop: Property) -> dict[str, Any]:
    """Return what a property requires, term by term, for a property that is not stated in words."""
    named = {name: term for machine in target.machines for name, term in machine.definitions.items()}
    required = {"always": prop.term, "within": prop.response, "reachable": prop.term}[prop.kind]
    before = [prop.term] if prop.kind == "within" else []
    terms, lines = spelled_alone([*before, *conjuncts(required)], named if len(target.machines) == 1 else {})
    words = {
        "always": ["always"] * len(terms),
        "within": ["whenever", *[f"within {prop.steps} steps"] * (len(terms) - 1)],
        "reachable": ["in some run"] * len(terms),
    }[prop.kind]
    return {
        "terms": [f"{word}: {term}" for word, term in zip(words, terms, strict=True)],
        "parts": [asdict(line) for line in lines],
    }


def _interval(reported: Reported) -> dict[str, Any]:
    """Return the names that make up the interval; the track that it lies on is among the signals."""
    return {name: value for name, value in asdict(reported).items() if name != "tracks"}


def configuration_of(target: Target) -> Any:
    """Return the machine's configuration, from which it can be rebuilt; dates in a user's file become text."""
    if target.config is not None:
        return target.config.model_dump(mode="json")
    return None if target.given is None else json.loads(json.dumps(target.given, default=str))


def _signal(term: Expr) -> dict[str, Any]:
    """Return unit and labels, which make a trace readable without the machine."""
    if not isinstance(term, Num):
        return {"unit": "", "members": []}
    if isinstance(term.unit, Enumeration):
        return {"unit": "", "members": list(term.unit.members)}
    return {"unit": term.unit.name, "members": []}


_Assumed = Mapping[tuple[str, str], Assumption]
"""The assumptions of the register by machine and name."""


def _part(machine: Machine, assumed: _Assumed) -> dict[str, Any]:
    guards = {f"when {t.name}": t.when for t in machine.transitions}
    updates = {f"set {number}": update for number, update in enumerate(_updates(machine))}
    moves = {f"move {var.name}": term for var, term in machine.world.moves.items()}
    outputs = {f"output {name}": term for name, term in machine.outputs.items()}
    set_to = {key: update.term for key, update in updates.items()}
    exact = Exact({**guards, **set_to, **moves, **outputs}, machine.definitions)
    return {
        "name": machine.name,
        "svg": to_svg(machine),
        "clauses": list(_clauses(machine, assumed)),
        "table": [_row(t, exact.texts[f"when {t.name}"]) for t in machine.transitions],
        "updates": [
            {"variable": update.variable, "term": exact.texts[key], "transitions": update.transitions}
            for key, update in updates.items()
        ],
        "variables": _variables(machine, exact.texts),
        "definitions": [asdict(line) for line in exact.lines],
    }


def _clauses(machine: Machine, assumed: _Assumed) -> Iterator[dict[str, Any]]:
    """Yield every law of the world with its term in parts, its owner, and the values of the machine that it reads."""
    read = read_of_machine(machine)
    for name, law in machine.world.laws.items():
        terms, lines = spelled_alone(list(conjuncts(law.term)), machine.definitions)
        one = assumed[machine.name, name]
        yield {
            "id": one.id,
            "name": name,
            "terms": terms,
            "parts": [asdict(line) for line in lines],
            "guaranteed": one.guaranteed,
            "observable": one.monitored,
            "statement": law.statement,
            "figures": list(law.figures),
            "source": law.source,
            "owner": law.owner,
            "check": law.check,
            "declared": place(law.src) if law.src else "",
            "reads": [var.name for var in read.get(f"clause {name!r}", ())],
        }


@dataclass(frozen=True)
class _Update:
    """A term to which a variable is set, and the numbers of the transitions that do so."""

    variable: str
    term: Expr
    transitions: list[int]


def _updates(machine: Machine) -> list[_Update]:
    share, found = Sharing(), dict[tuple[Var, Expr], _Update]()
    for var in machine.state:
        for number, t in enumerate(machine.transitions, 1):
            if var in t.set:
                term = share(_term(var, t.set[var]))
                found.setdefault((var, term), _Update(var.name, term, [])).transitions.append(number)
    return list(found.values())


def _term(var: Var, value: Expr | Value) -> Expr:
    if isinstance(value, (Num, Bool)):
        return value
    return Lit(int(value), var.unit) if isinstance(var, NumVar) else Truth(bool(value))


def _row(t: Transition, guard: str) -> dict[str, Any]:
    return {
        "name": t.name,
        "source": ", ".join(mode.label for mode in t.sources),
        "target": t.target.label,
        "guard": guard,
        "rank": t.rank,
        "requirements": list(t.requirements),
        "declared": place(t.src),
    }


def _variables(machine: Machine, texts: Mapping[str, str]) -> list[dict[str, str]]:
    """Return inputs, state with first values, ghosts with their moves, and outputs with their terms."""
    rows = [_variable("input", var.name, var) for var in input_variables(machine)]
    rows += [_variable("state", var.name, var, first=_first(var, value)) for var, value in machine.state.items()]
    for var, value in machine.world.ghosts.items():
        rows.append(_variable("ghost", var.name, var, texts.get(f"move {var.name}", ""), _first(var, value)))
    rows += [_variable("ghost input", var.name, var) for var in machine.world.choices]
    return rows + [_variable("output", name, term, texts[f"output {name}"]) for name, term in machine.outputs.items()]


def _first(var: Var, value: object) -> str:
    if isinstance(value, Any_):
        return "any"
    return infix(_term(var, value)) if isinstance(value, (int, bool, Lit)) else str(value)


def _variable(kind: str, name: str, term: Expr, text: str = "", first: str = "") -> dict[str, str]:
    """Return name, unit, range (for an output: bounds derived from its term), term and first value."""
    row = {"name": name, "kind": kind, "unit": "", "range": "true, false", "first": first, "term": text}
    if not isinstance(term, Num):
        return row
    if isinstance(term.unit, Enumeration):
        return row | {"range": ", ".join(term.unit.members)}
    low, high = (term.low, term.high) if isinstance(term, NumVar) else bounds([term])[term]
    return row | {"unit": term.unit.name, "range": f"{low} .. {high}"}
