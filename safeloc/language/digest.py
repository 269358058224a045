"""Digests of the meaning of a system.

declaration_digest  equal for declarations with the same variables and the same moves; snapshots carry it, so that a
                    snapshot of another declaration is refused
full_digest         also covers everything that a proof rests on (assumption, lemmas, ghosts, parts); reports carry it
term_digest         equal for terms of equal structure over variables of equal names; it tells laws of different targets apart
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator

from safeloc.language.expr import BoolVar, Expr, Lit, NumVar, Var
from safeloc.language.first_values import Any_
from safeloc.language.nodes import Compare, FloorDiv, Past, Truth
from safeloc.language.system import TransitionSystem
from safeloc.language.terms import Sharing, children, in_order
from safeloc.language.units import Enumeration


def declaration_digest(system: TransitionSystem) -> str:
    """Return the SHA-256, in hexadecimal, of variables, first values, moves and outputs, but not of places in source files."""
    total = hashlib.sha256()
    for line in _lines(system):
        total.update(line.encode("utf-8") + b"\n")
    return total.hexdigest()


def full_digest(system: TransitionSystem) -> str:
    """Return the SHA-256, in hexadecimal, of everything that verdicts depend on: declaration, assumption, lemmas, ghosts, parts."""
    total = hashlib.sha256()
    for line in _full_lines(system):
        total.update(line.encode("utf-8") + b"\n")
    return total.hexdigest()


def term_digest(term: Expr) -> str:
    """Return the SHA-256, in hexadecimal, of a term alone: the same whether its equal parts are one node or several."""
    return hashlib.sha256("\n".join(_terms([Sharing()(term)])).encode("utf-8")).hexdigest()


def _full_lines(system: TransitionSystem) -> Iterator[str]:
    yield from _lines(system)
    yield f"init and assumption, then lemmas {list(system.lemmas)!r}"
    yield from _terms([system.init, system.assume, *system.lemmas.values()])
    yield f"ghosts {[var.name for var in (*system.state, *system.inputs) if var in system.ghosts]!r}"
    yield f"optionals {[(one.value.name, one.present.name) for one in system.optionals]!r}"
    yield from (f"fired {_variable(var)}" for var in system.fired)
    yield from _terms(system.fired.values())
    for part in system.parts:
        yield f"part {part.name!r}"
        yield from _full_lines(part.alone)
        translated = [part.into(var) for var in (*part.alone.state, *part.alone.inputs)]
        yield from _terms([part.inputs_in_range, part.contract, *translated])


def _lines(system: TransitionSystem) -> Iterator[str]:
    yield f"system {system.name!r}"
    for kind, variables in (("state", system.state), ("input", system.inputs)):
        yield from (f"{kind} {_variable(var)}" for var in variables)
    yield from (f"first {var.name!r} {_first(system, var)}" for var in system.state)
    terms = [system.init, *system.next.values(), *system.fired.values(), *system.outputs.values()]
    yield from _terms(terms)
    yield f"outputs {list(system.outputs)!r}"


def _variable(var: Var) -> str:
    if isinstance(var, BoolVar):
        return f"{var.name!r} truth"
    members = var.unit.members if isinstance(var.unit, Enumeration) else ()
    return f"{var.name!r} {var.unit.name!r} {members!r} {var.low} {var.high}"


def _first(system: TransitionSystem, var: Var) -> str:
    value = system.initial[var]
    return "any" if isinstance(value, Any_) else str(int(value.value if isinstance(value, Lit) else value))


def _terms(roots: Iterable[Expr]) -> Iterator[str]:
    """List every node once, with its number; then the numbers of the roots."""
    roots = list(roots)
    number: dict[int, int] = {}
    for node in in_order(roots):
        number[id(node)] = len(number)
        yield f"{type(node).__name__} {_data(node)} {[number[id(part)] for part in children(node)]}"
    yield f"roots {[number[id(root)] for root in roots]}"


def _data(node: Expr) -> str:
    """Return the data of a node besides its parts: two nodes of one kind with equal parts and equal data are equal."""
    match node:
        case Lit(value, _) | Truth(value):
            return str(value)
        case NumVar(name=name) | BoolVar(name=name):
            return repr(name)
        case FloorDiv(_, divisor, _):
            return str(divisor)
        case Compare(op, _, _) | Past(op, _):
            return op
        case _:
            return ""
