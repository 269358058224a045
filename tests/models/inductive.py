"""Whether a property is inductive with the lemmas of its machine, and machines that are broken on purpose."""

from __future__ import annotations

from dataclasses import replace

from safeloc.codegen.smtlib import Query
from safeloc.language.expr import all_of
from safeloc.language.machine import Machine
from safeloc.language.spec import Property, observe
from safeloc.language.system import TransitionSystem, environment, in_range, lower
from safeloc.language.terms import Substitution, variables
from safeloc.proof.provers.implication import unproved
from safeloc.proof.provers.proved_base import ranges_and_lemmas
from tests.models.spoilt import rebuilt


def inductive(machine: Machine, prop: Property, only: str = "") -> bool:
    """Whether ranges, lemmas and the property are inductive together: each step from a state in which all hold keeps them.

    only  the range, lemma or property that has to hold after the step; all of them if empty. KeyError for an unknown name
    """
    return inductive_in(lower(machine), prop, only)


def inductive_in(system: TransitionSystem, prop: Property, only: str = "") -> bool:
    """The same of a composition."""
    goal = observe(system, prop)
    ghosts = goal.original.ghosts if prop.unconditional else frozenset()
    known = {
        str(fact): term
        for fact, term in ranges_and_lemmas(goal.original).items()
        if not ghosts & set(variables([term]))
    }
    after = Substitution(dict(goal.system.next))
    wanted = {**known, prop.name: goal.good & goal.helper}
    given = [environment(goal.system), in_range(goal.system.state), *wanted.values()]
    asked = wanted[only] if only else all_of(wanted.values())
    return not unproved(Query("one step", given, {"after it": after.bool(asked)}), 60)


def changed(machine: Machine, name: str, **fields: object) -> Machine:
    """The machine with one transition changed; KeyError if it has none of that name."""
    if name not in {t.name for t in machine.transitions}:
        raise KeyError(name)
    return rebuilt(machine, [replace(t, **fields) if t.name == name else t for t in machine.transitions])  # type: ignore[arg-type]


def without(machine: Machine, name: str) -> Machine:
    """The machine without one transition."""
    return rebuilt(machine, [t for t in machine.transitions if t.name != name])
