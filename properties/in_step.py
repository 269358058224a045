"""Terms of a guard in a property: over the state before the step and the inputs of the step.

A property reads the state after the step. What a transition looked at is written with these.
"""

from __future__ import annotations

from safeloc.language.expr import Bool, Expr, Num, NumVar, Var, before, was
from safeloc.language.machine import Machine
from safeloc.language.terms import Substitution


def _in_step(machine: Machine, term: Bool) -> Bool:
    """Return a truth-valued term with its value in the step."""
    return _before(machine).bool(term)


def _num_in_step(machine: Machine, term: Num) -> Num:
    """Return a numeric term with its value in the step."""
    return _before(machine).num(term)


def _before(machine: Machine) -> Substitution:
    twins: dict[Var, Expr] = {
        var: before(var) if isinstance(var, NumVar) else was(var)
        for var in (machine.mode, *machine.state, *machine.world.ghosts)
    }
    return Substitution(twins)
