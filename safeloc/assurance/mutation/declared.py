"""A declaration for mutation: a list of all its terms, and the declaration with some of them replaced.

A `Root` is a complete term, such as a guard, an update, an output, a clause of the world or a claim. Guards, updates and outputs
are the machine itself; the other terms are the specification that it is checked against.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from enum import Enum
from typing import Any

from safeloc.assurance.mutation import world
from safeloc.catalogue import load_target
from safeloc.errors import InputError
from safeloc.language.expr import Lit, Num, ite
from safeloc.language.machine import Machine, Transition
from safeloc.language.nodes import Bool, Expr, Value
from safeloc.language.spec import Property
from safeloc.language.system import TransitionSystem, lower
from safeloc.language.terms import Substitution
from safeloc.language.units import Enumeration
from safeloc.proof.verification.other_figures import with_fitting_recordings
from safeloc.target import Target


class Part(Enum):
    """The part of a declaration to which a term belongs."""

    GUARD = "guard"
    UPDATE = "update"
    OUTPUT = "output"
    CLAUSE = "clause"
    MOVE = "move"
    INITIALLY = "initially"
    LEMMA = "lemma"
    CLAIM = "claim"


ON_BOARD = frozenset({Part.GUARD, Part.UPDATE, Part.OUTPUT})
"""The parts that are the machine itself, and run on board."""


@dataclass(frozen=True, eq=False)
class Root:
    """A complete term, with its part of the declaration and its name there; `row` is set for guards and updates."""

    part: Part
    name: str
    term: Expr
    row: Transition | None = None

    def __str__(self) -> str:
        return f"{self.part.value} {self.name}"


@dataclass(frozen=True, eq=False)
class Declared:
    """A machine and its claims: the declaration of which mutants are made."""

    machine: Machine
    properties: tuple[Property, ...]
    further: tuple[Property, ...] = ()
    """For a machine of a composition: the claims of the composition, which may contain terms of the machine."""

    @property
    def roots(self) -> Iterator[Root]:
        """All complete terms, those of the machine first."""
        machine = self.machine
        for row in machine.transitions:
            yield Root(Part.GUARD, f"of {row.name!r}", row.when, row)
            for var, value in row.set.items():
                if isinstance(value, Expr):
                    yield Root(Part.UPDATE, f"of {var.name} in {row.name!r}", value, row)
        yield from (Root(Part.OUTPUT, name, term) for name, term in machine.outputs.items())
        yield from (Root(Part.CLAUSE, name, term) for name, term in world.clauses(machine))
        yield from (Root(Part.MOVE, name, term) for name, term in world.moves(machine))
        yield Root(Part.INITIALLY, "the first state", machine.initially)
        yield from (Root(Part.LEMMA, name, term) for name, term in machine.lemmas.items())
        for prop in (*self.properties, *self.further):
            for term in (prop.term, prop.response, prop.further_assumption):
                yield Root(Part.CLAIM, prop.name, term)

    def lowered(self) -> TransitionSystem:
        """Return the lowered machine. Fired rows keep the numbers that claims use, even if the order of rows has changed."""
        system = lower(self.machine)
        [(fired, term)] = system.fired.items()
        table = fired.unit
        names = [row.name for row in self.machine.transitions]
        if not isinstance(table, Enumeration) or list(table.members[1:]) == names:
            return system
        told: Num = Lit(0, table)
        for number, name in enumerate(names, 1):
            told = ite(term.eq(Lit(number, table)), Lit(table.index(name), table), told)
        return replace(system, fired={fired: told})


def declared(spec: str, config: Any = None) -> tuple[Target, Declared]:
    """Return a target and its declaration; InputError for a composition."""
    target = with_fitting_recordings(load_target(spec, config))
    if len(target.machines) != 1:
        raise InputError(
            f"{target.name} is a composition of {', '.join(one.name for one in target.machines)}; give one of them."
        )
    return target, declared_of(target)


def declared_of(target: Target) -> Declared:
    """Return the declaration of a target of one machine."""
    [machine] = target.machines
    return Declared(machine, target.properties)


def exchanged(declared: Declared, on_board: Substitution, beyond: Substitution | None) -> Declared:
    """Return the declaration with rewritten terms: the machine by `on_board`; world, lemmas and claims by `beyond`, if given.

    ModelError or PropertyError if the result is not a valid declaration.
    """
    rows = [_row(row, on_board) for row in declared.machine.transitions]
    outputs = {name: on_board(term) for name, term in declared.machine.outputs.items()}
    if beyond is None:
        return replace(declared, machine=remade(declared.machine, transitions=rows, outputs=outputs))
    changed = remade(
        declared.machine,
        transitions=rows,
        outputs=outputs,
        initially=beyond.bool(declared.machine.initially),
        lemmas={name: beyond.bool(term) for name, term in declared.machine.lemmas.items()},
        **world.rewritten(declared.machine, beyond),
    )
    claims, further = (
        tuple(claimed(prop, beyond) for prop in some) for some in (declared.properties, declared.further)
    )
    return Declared(changed, claims, further)


def remade(machine: Machine, **fields: Any) -> Machine:
    """Return the machine with some fields replaced. The variable of the fired row stays the same, since claims read it."""
    made = replace(machine, **fields)
    object.__setattr__(made, "fired_name", machine.fired_name)
    return made


def claimed(prop: Property, change: Substitution) -> Property:
    """Return the claim with its terms rewritten, including those of its helper."""
    helper = prop.helper
    return replace(
        prop,
        term=change.bool(prop.term),
        response=change.bool(prop.response),
        further_assumption=change.bool(prop.further_assumption),
        helper=None if helper is None else lambda waiting: _helped(change, helper(waiting)),
    )


def _helped(change: Substitution, term: Bool) -> Bool:
    return change.bool(term)


def _row(row: Transition, change: Substitution) -> Transition:
    updates: Mapping[Any, Expr | Value] = {
        var: change(value) if isinstance(value, Expr) else value for var, value in row.set.items()
    }
    return replace(row, when=change.bool(row.when), set=updates)
