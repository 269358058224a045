"""Rules of resolution, over clauses as sets of literals."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from safeloc.checker.proofs.logic import of, only, require, two
from safeloc.checker.proofs.steps import Inference, Rule, WrongStep
from safeloc.checker.proofs.terms import FALSE, TRUE, Term, no

Literals = frozenset[Term]


def _without(formula: Term, literal: Term) -> Literals:
    """Return the clause without the literal. WrongStep unless the formula is the literal or a disjunction that contains it."""
    if formula is literal:
        return frozenset()
    if formula.op == "or" and literal in formula.args:
        return frozenset(formula.args) - {literal}
    raise WrongStep(f"no literal {literal} in a clause")


def _as_claimed(literals: Literals, claim: Term) -> Term:
    """Return the claim. WrongStep unless it consists of these literals, in any order and with any repetitions."""
    if literals - {FALSE} == _literals(claim) - {FALSE} or literals == {claim}:
        return claim
    raise WrongStep(f"another clause follows: {sorted(map(str, literals))[:5]}")


def _literals(claim: Term) -> Literals:
    return frozenset(claim.args if claim.op == "or" else (claim,))


def _chain(premises: Sequence[Term], signs: Sequence[Term], pivots: Sequence[Term]) -> Literals:
    require(len(premises) == len(signs) + 1 == len(pivots) + 1, "not one pivot and one sign for each two clauses")
    require(bool(pivots), "no clause to resolve with")
    first, *_ = _pair(signs[0], pivots[0])
    rest = _without(premises[0], first)
    for at, (premise, sign, pivot) in enumerate(zip(premises[1:], signs, pivots, strict=True)):
        here, there = _pair(sign, pivot)
        require(at == 0 or here in rest, f"no literal {here} in the resolvent")
        rest = (rest - {here}) | _without(premise, there)
    return rest


def _pair(sign: Term, pivot: Term) -> tuple[Term, Term]:
    """Return the literal to remove from the first clause, and the opposite one for the second clause."""
    require(sign in (TRUE, FALSE), "a sign that is no truth value")
    return (pivot, no(pivot)) if sign is TRUE else (no(pivot), pivot)


def _resolution(step: Inference) -> Term:
    sign, pivot = two(step.args)
    return _as_claimed(_chain(step.premises, [sign], [pivot]), step.claim)


def _chain_resolution(step: Inference) -> Term:
    signs, pivots = two(step.args)
    return _as_claimed(_chain(step.premises, of(signs, "list"), of(pivots, "list")), step.claim)


def _chain_to(step: Inference) -> Term:
    require(len(step.args) == 3, "three arguments were expected")
    result, signs, pivots = step.args
    return _as_claimed(_chain(step.premises, of(signs, "list"), of(pivots, "list")), result)


def _same_literals(step: Inference) -> Term:
    return _as_claimed(_literals(only(step.premises)), step.claim)


RULES: Mapping[str, Rule] = {
    "RESOLUTION": _resolution,
    "CHAIN_RESOLUTION": _chain_resolution,
    "CHAIN_M_RESOLUTION": _chain_to,
    "FACTORING": _same_literals,
    "REORDERING": _same_literals,
}
