"""Access to the world of a machine for mutation: only this file knows how a machine declares its world."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from safeloc.language.machine import Machine
from safeloc.language.nodes import Bool, Expr
from safeloc.language.terms import Substitution


def clauses(machine: Machine) -> Iterator[tuple[str, Bool]]:
    """Return name and term of each clause of the world."""
    yield from machine.world.terms.items()


def moves(machine: Machine) -> Iterator[tuple[str, Expr]]:
    """Return name and next value of each ghost that has one declared."""
    yield from ((var.name, move) for var, move in machine.world.moves.items())


def rewritten(machine: Machine, change: Substitution) -> dict[str, Any]:
    """Return the field that declares the world, with clauses and moves rewritten."""
    world = machine.world
    laws = {name: replace(law, term=change.bool(law.term)) for name, law in world.laws.items()}
    return {"world": replace(world, clauses=laws, moves={var: change(term) for var, term in world.moves.items()})}


def with_clauses(machine: Machine, change: Substitution) -> dict[str, Any]:
    """Return the field that declares the world, with clauses rewritten."""
    laws = {name: replace(law, term=change.bool(law.term)) for name, law in machine.world.laws.items()}
    return {"world": replace(machine.world, clauses=laws)}


def without_clause(machine: Machine, left_out: str) -> dict[str, Any]:
    """Return the field that declares the world, without one of its clauses."""
    laws = {name: law for name, law in machine.world.laws.items() if name != left_out}
    return {"world": replace(machine.world, clauses=laws)}
