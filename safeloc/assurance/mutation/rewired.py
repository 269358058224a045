"""A composition with wrong wires, and its claims about the wires that it has then.

A claim about a wired input contains the term on the wire. So a composition with a wrong wire is made again, with all its claims:
otherwise a claim would still speak of the right wire, and could not detect the wrong one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from safeloc.assurance.mutation.declared import claimed
from safeloc.assurance.mutation.delay import with_delay
from safeloc.assurance.mutation.members import Composed, asked_of_the_whole, in_variables_of, joined
from safeloc.language.checks.composition import Plan
from safeloc.language.composition import plans_changed
from safeloc.language.expr import Expr, Var, before_step
from safeloc.language.machine import Machine
from safeloc.language.spec import Property
from safeloc.language.system import TransitionSystem
from safeloc.language.terms import Substitution, variables


@dataclass(frozen=True, eq=False)
class Rewired:
    """The composition with wrong wires, and its claims, in the variables of the right one."""

    system: TransitionSystem
    claims: tuple[Property, ...]


def rewired(composed: Composed, wires: Mapping[Var, Expr], late: Sequence[Var] = ()) -> Rewired:
    """Return the composition made again with these wires; if it cannot be made again, only its wires are replaced.

    late  wired inputs of one machine that get the values of the step before

    ModelError or PropertyError if the result is not a valid composition, or has no valid claims.
    """
    made, wrong = list[Plan](), _changed(composed.plan.wires, wires)
    like = composed.target.system
    with plans_changed(lambda plan: _wired(plan, composed.plan, wrong, late, made)):
        target = None if composed.again is None else composed.again()
        if target is None or not made:
            return Rewired(_told_as(like, joined(composed, composed.plan.machines[0])), composed.claims)
    system, change = in_variables_of(target.system, like)
    claims, renaming = asked_of_the_whole(target.properties), _Renaming(change)
    return Rewired(_told_as(like, system), tuple(claimed(prop, renaming) for prop in claims))


def _told_as(like: TransitionSystem, system: TransitionSystem) -> TransitionSystem:
    """Return the system with the outputs of `like` only, and its machines by themselves as they are there."""
    alone = {part.name: part.alone for part in like.parts}
    parts = tuple(replace(part, alone=alone.get(part.name, part.alone)) for part in system.parts)
    return replace(system, parts=parts, outputs={name: system.outputs[name] for name in like.outputs})


def _changed(right: Mapping[Var, Expr], wires: Mapping[Var, Expr]) -> dict[Var, Expr]:
    return {var: term for var, term in wires.items() if right.get(var) is not term}


def _wired(plan: Plan, right: Plan, wrong: Mapping[Var, Expr], late: Sequence[Var], made: list[Plan]) -> Plan:
    """Return the plan with the wrong and the late wires, in its own variables, if it is that of the composition; otherwise the plan itself."""
    if plan.name != right.name or _names(plan.machines) != _names(right.machines):
        return plan
    into = _Renaming(
        Substitution(
            {
                var: twin
                for one, other in zip(right.systems, plan.systems, strict=True)
                for var, twin in zip(_variables(one), _variables(other), strict=True)
            }
        )
    )
    changed = {_var(into(var)): into(term) for var, term in wrong.items()}
    rewired = replace(plan, wires={**plan.wires, **changed})
    made.append(with_delay(rewired, [_var(into(var)) for var in late]) if late else rewired)
    return made[-1]


def _names(machines: Sequence[Machine]) -> list[str]:
    return [one.name for one in machines]


def _variables(system: TransitionSystem) -> tuple[Var, ...]:
    return (*system.state, *system.inputs)


class _Renaming(Substitution):
    """The same change, also of values before the step, of which each claim has variables of its own."""

    def __init__(self, change: Substitution) -> None:
        super().__init__({})
        self._change = change

    def __call__(self, term: Expr) -> Expr:
        """Return the term in the other variables."""
        before = {
            var: before_step(_var(self._change(var.before))) for var in variables([term]) if var.before is not None
        }
        return self._change(Substitution(before)(term))


def _var(term: Expr) -> Var:
    assert isinstance(term, Var)
    return term
