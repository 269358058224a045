"""A machine's own guards, read in a property: state as it was before the step, inputs as they came."""

from __future__ import annotations

from safeloc.language.expr import Bool, Expr, NumVar, Var, before, was
from safeloc.language.machine import Machine
from safeloc.language.terms import Substitution, variables


def guard(machine: Machine, term: Bool) -> Bool:
    """The term as the transition table read it in the step that a property looks at."""
    state = {*machine.state, machine.mode}
    read = [var for var in variables([term]) if var in state]
    twins: dict[Var, Expr] = {var: before(var) if isinstance(var, NumVar) else was(var) for var in read}
    return Substitution(twins).bool(term)
