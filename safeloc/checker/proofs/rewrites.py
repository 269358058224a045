"""Rules of rewriting: an instance of a rewrite, whatever its name, is shown to be valid by cases or by a normal form."""

from __future__ import annotations

from collections.abc import Mapping

from safeloc.checker.proofs.cases import valid
from safeloc.checker.proofs.logic import of, only, require
from safeloc.checker.proofs.polynomials import polynomial
from safeloc.checker.proofs.steps import Inference, Rule
from safeloc.checker.proofs.terms import FALSE, TRUE, Term

_NEUTRAL = {"and": TRUE, "or": FALSE}
_ABSORBING = {"and": FALSE, "or": TRUE}


def _evaluate(step: Inference) -> Term:
    """Check the value of a term without variables."""
    term, value = of(step.claim, "=")
    require(only(step.args) is term, "the value is of another term")
    require(value.op in ("number", "true", "false") and valid(step.claim), "the value is another one")
    return step.claim


def _aci_norm(step: Inference) -> Term:
    """Check that two terms have the same parts, in any order, repetition and nesting."""
    claim = only(step.args)
    left, right = of(claim, "=")
    op = left.op if left.op in _NEUTRAL else right.op
    if op in _NEUTRAL:
        require(_parts(left, op) == _parts(right, op), "the parts differ")
    else:
        require(left.sort in ("Int", "Real"), f"no rule of order for {op!r}")
        require(polynomial(left) == polynomial(right), "the sums differ")
    return claim


def _parts(term: Term, op: str) -> frozenset[Term]:
    found, waiting = set[Term](), [term]
    while waiting:
        one = waiting.pop()
        if one.op == op:
            waiting += one.args
        else:
            found.add(one)
    return frozenset(found - {_NEUTRAL[op]})


def _absorb(step: Inference) -> Term:
    claim = only(step.args)
    left, right = of(claim, "=")
    require(left.op in _ABSORBING and right is _ABSORBING[left.op], "neither `or` with true nor `and` with false")
    require(right in _parts(left, left.op), "nothing absorbs the rest")
    return claim


def _instance(step: Inference) -> Term:
    """Check that an instance of a rewrite is valid for any meaning of the terms that were substituted for its variables.

    One of these terms may contain another, so each of them is also tried as not opaque. NotImplementedError if it is not shown.
    """
    opaque = _put_in(step.args[1:])
    choices = [opaque, *([other for other in opaque if other is not one] for one in opaque), []]
    if any(valid(step.claim, step.premises, choice) for choice in choices):
        return step.claim
    raise NotImplementedError


def _without_rule(step: Inference) -> Term:
    """Check that a step without a rule of cvc5 is valid by itself. NotImplementedError if it is not shown."""
    if valid(step.claim, step.premises):
        return step.claim
    raise NotImplementedError


def _put_in(args: tuple[Term, ...]) -> list[Term]:
    """Return the terms that were substituted for the rewrite's variables, without constants and negations."""
    plain = [_affirmed(part) for arg in args for part in (arg.args if arg.op == "list" else (arg,))]
    return [one for one in plain if one.op not in ("number", "true", "false")]


def _affirmed(term: Term) -> Term:
    while term.op == "not":
        term = term.args[0]
    return term


RULES: Mapping[str, Rule] = {"EVALUATE": _evaluate, "ACI_NORM": _aci_norm, "ABSORB": _absorb}
FAMILIES: Mapping[str, Rule] = {
    "DSL_REWRITE": _instance,
    "THEORY_REWRITE": _instance,
    "TRUST": _without_rule,
    "TRUST_THEORY_REWRITE": _without_rule,
}
