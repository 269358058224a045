"""A claim read twice in one run: with the stored number of an absent input, and with any other number in its place.

An absent input is stored as a number (`canonical`). A claim that reads it then says of a silent sensor that it measures that number.
It does so exactly if some run tells the two readings apart.
"""

from __future__ import annotations

from dataclasses import replace

from safeloc.language.expr import TRUE, Bool, BoolVar, Expr, Num, NumVar, Optional, all_of, ite
from safeloc.language.folding import Folding
from safeloc.language.nodes import FALSE, Past
from safeloc.language.spec import Goal, Property, observe, reachable
from safeloc.language.system import TransitionSystem
from safeloc.language.terms import Substitution, children, in_order, logical, numeric, variables

_OTHER = "other reading"


def other_value(option: Optional) -> NumVar:
    """Return a variable for any other number that might be stored for the input."""
    return replace(option.value, name=f"{option.value.name} (other)")


def reads(claim: Property, option: Optional) -> bool:
    """Return whether the claim reads the value of the input at all."""
    return option.value in set(variables(_terms(claim)))


def reads_while_absent(claim: Property, option: Optional) -> bool:
    """Return whether the value stays in the claim if the input is taken as absent.

    What a past operator asks is taken apart from the rest, since it asks of another step.
    """
    absent = Folding({option.present: FALSE})
    return any(option.value in set(variables([absent(part)])) for part in _of_one_step(claim))


def read_alike(system: TransitionSystem, claim: Property, option: Optional, other: NumVar) -> Bool:
    """Return the condition on a step that it leaves every observer of the claim the same, whatever the absent input is.

    It is over the state before the step, the inputs, and `other` (`other_value`). Its further assumption has to be the same as well.
    """
    swap, wider = Substitution({option.value: other}), _with_input(system, other)
    one, two = observe(wider, claim), observe(wider, _swapped(claim, swap))
    names = Substitution(dict(zip(two.observers, one.observers, strict=True)))
    same = [
        _same(one.system.next[var], names(two.system.next[twin]))
        for var, twin in zip(one.observers, two.observers, strict=True)
    ]
    further = claim.further_assumption
    return all_of([*same, _same(further, swap(further))])


def told_apart(system: TransitionSystem, claim: Property, option: Optional, other: NumVar) -> Goal:
    """Return the goal of a run after which the two readings of the claim differ; while the input is present, they read one value."""
    swap = Substitution({option.value: ite(option.present, option.value, other)})
    one = observe(_with_input(system, other), claim)
    two = observe(one.system, _swapped(claim, swap))
    differ = one.good.iff(two.good) & swap.bool(claim.further_assumption)
    return observe(two.system, reachable("two readings of one claim", ~differ))


def _with_input(system: TransitionSystem, other: NumVar) -> TransitionSystem:
    return replace(system, inputs=(*system.inputs, other))


def _swapped(claim: Property, swap: Substitution) -> Property:
    return replace(
        claim,
        name=_OTHER,
        term=swap.bool(claim.term),
        response=swap.bool(claim.response),
        further_assumption=TRUE,
        unconditional=False,
        helper=None,
        kept_by=None,
    )


def _terms(claim: Property) -> tuple[Bool, ...]:
    return claim.term, claim.response, claim.further_assumption


def _of_one_step(claim: Property) -> list[Expr]:
    """Return the claim's terms and what its past operators ask, each without the past operators in it."""
    past = [node for node in in_order(_terms(claim)) if isinstance(node, Past)]
    opaque = Substitution({}, [(node, BoolVar(f"past {number}")) for number, node in enumerate(past)])
    return [opaque(part) for part in (*_terms(claim), *(child for node in past for child in children(node)))]


def _same(left: Expr, right: Expr) -> Bool:
    if isinstance(left, Num):
        return left.eq(numeric(right))
    return logical(left).iff(logical(right))
