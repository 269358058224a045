"""A claim of a composition that is exactly one of a machine's own: what the machine proves by itself carries over.

The machine alone is enough if its inputs are in range and its assumption is discharged.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from safeloc.codegen.smtlib import Query
from safeloc.language.composition import inherited_term
from safeloc.language.expr import TRUE, Bool
from safeloc.language.spec import Goal, Property, observe
from safeloc.language.system import Part, in_range
from safeloc.language.terms import alike, variables
from safeloc.language.verdict import Proved, Unknown, Verdict
from safeloc.proof.provers.facts import about, contract_of
from safeloc.proof.provers.kinduction import given_facts
from safeloc.proof.provers.limits import Deadline, Limits, deadline
from safeloc.proof.provers.proved_base import Base, base
from safeloc.proof.provers.recheck import confirmed_by
from safeloc.proof.provers.relevance import relevance
from safeloc.proof.provers.settle import Settled, settled


def by_its_machine(goal: Goal, limits: Limits, prover: Callable[[Goal], Verdict]) -> Verdict | None:
    """Return what the prover says of the machine alone, a proof as one of the composition; None if the machine alone is not enough.

    The verdict is Unknown without a question to the prover if the claim is not shown in the first state of the composition.
    """
    of_machine = inherited(goal)
    if of_machine is None:
        return None
    part, of_part = of_machine
    known = base(goal.original, seconds=limits.seconds)
    free = of_part.unconditional and part.alone.ghosts.isdisjoint(variables([of_part.term]))
    discharged = free or part.contract is TRUE or contract_of(part) in known.kept
    if not discharged or part.name not in known.in_range:
        return None
    first = _at_first(goal, known, limits)
    if first.failed:
        return Unknown("not shown in the first state of the composition")
    verdict = prover(observe(part.alone, of_part))
    if not isinstance(verdict, Proved):
        return verdict
    texts = {**known.certificates, **verdict.certificates, **first.texts}
    engine, by = f"{verdict.engine} of {part.name} by itself", confirmed_by(texts)
    return replace(verdict, invariant=None, engine=engine, rechecked=by, certificates=texts)


def inherited(goal: Goal) -> tuple[Part, Property] | None:
    """Return the machine and its own property if the claim about the composition is exactly that property."""
    if goal.prop.kept_by is None:
        return None
    machine, of_part = goal.prop.kept_by
    part = next((part for part in goal.original.parts if part.machine is machine), None)
    plain = (
        of_part.kind == goal.prop.kind == "always"
        and of_part.further_assumption is goal.prop.further_assumption is TRUE
    )
    if part is None or not plain or of_part.unconditional != goal.prop.unconditional:
        return None
    return (part, of_part) if alike(inherited_term(part.into, of_part), goal.prop.term) else None


def _at_first(goal: Goal, known: Base, limits: Limits) -> Settled[str]:
    """Prove in the first state a property that is inherited from a machine.

    A property of steps becomes one of states if an input is wired; it then has to hold in the first state too. What is said of
    other machines is left out, unless that is not enough.
    """
    if goal.observers:
        return Settled({}, {})
    first = [goal.system.init, in_range(goal.system.state), *given_facts(goal, known)]
    needed, ends = relevance(goal.original).select(first, [goal.good]), deadline(limits.seconds)
    settled_ = _first_state(goal, known, needed, ends)
    return settled_ if not settled_.failed else _first_state(goal, known, first, ends)


def _first_state(goal: Goal, known: Base, first: Sequence[Bool], ends: Deadline) -> Settled[str]:
    head = about(goal.original, "first state", property=goal.prop.name)
    query = Query(f"{goal.original.name} {goal.prop.name} first state", first, {"good": goal.good}, head)
    return settled(query, ends, list(known.certificates))
