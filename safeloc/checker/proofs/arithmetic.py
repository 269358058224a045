"""Rules of arithmetic, over exact fractions."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from math import ceil, floor

from safeloc.checker.proofs.cases import valid
from safeloc.checker.proofs.logic import of, only, require, two
from safeloc.checker.proofs.polynomials import minus, polynomial
from safeloc.checker.proofs.steps import Inference, Rule
from safeloc.checker.proofs.terms import Term, exact, make, number, same

_TURNED = {"<": ">", "<=": ">=", "=": "=", ">=": "<=", ">": "<"}


def _relation(term: Term) -> tuple[str, Term, Term]:
    require(term.op in _TURNED and term.args[0].sort in ("Int", "Real"), f"{term.op!r} compares no numbers")
    return term.op, *two(term.args)


def _poly_norm(step: Inference) -> Term:
    claim = only(step.args)
    _, left, right = _relation(claim)
    require(claim.op == "=" and polynomial(left) == polynomial(right), "the polynomials differ")
    return claim


def _poly_norm_rel(step: Inference) -> Term:
    """Conclude a ~ b iff e ~ f from c * (a - b) = d * (e - f); c and d have the same sign, unless ~ is equality."""
    claim = only(step.args)
    sides = of(claim, "=")
    factors = []
    for side, multiple in zip(sides, of(only(step.premises), "="), strict=True):
        op, left, right = _relation(side)
        factor, difference = two(of(multiple, "*"))
        require(op == sides[0].op, "the two sides compare differently")
        require(polynomial(difference) == minus(polynomial(left), polynomial(right)), "the difference is of others")
        factors.append(_nonzero(factor))
    require(sides[0].op == "=" or factors[0] * factors[1] > 0, "the factors are of different signs")
    return claim


def _nonzero(term: Term) -> Fraction:
    value = polynomial(term).get((), Fraction(0))
    require(value != 0 and len(polynomial(term)) == 1, "a factor is no number other than 0")
    return value


def _sum_ub(step: Inference) -> Term:
    parts = [_relation(premise) for premise in step.premises]
    require(bool(parts) and all(op in ("<", "<=", "=") for op, _, _ in parts), "not all are upper bounds")
    op = "<" if any(one == "<" for one, _, _ in parts) else "<="
    return make(op, make("+", *(left for _, left, _ in parts)), make("+", *(right for _, _, right in parts)))


def _mult_pos(step: Inference) -> Term:
    factor, formula = two(step.args)
    op, left, right = _relation(formula)
    condition = make("and", make(">", factor, number(0, factor.sort)), formula)
    return make("=>", condition, make(op, make("*", factor, left), make("*", factor, right)))


def _mult_neg(step: Inference) -> Term:
    factor, formula = two(step.args)
    op, left, right = _relation(formula)
    condition = make("and", make("<", factor, number(0, factor.sort)), formula)
    return make("=>", condition, make(_TURNED[op], make("*", factor, left), make("*", factor, right)))


def _tight_ub(step: Inference) -> Term:
    integer, bound = of(only(step.premises), "<")
    require(integer.sort == "Int", "only a whole number's bound is tightened")
    return make("<=", integer, number(ceil(exact(bound)) - 1))


def _tight_lb(step: Inference) -> Term:
    integer, bound = of(only(step.premises), ">")
    require(integer.sort == "Int", "only a whole number's bound is tightened")
    return make(">=", integer, number(floor(exact(bound)) + 1))


def _trichotomy(step: Inference) -> Term:
    opaque = [side for side in step.claim.args if side.op != "number"]
    require(step.claim.op in ("<", "=", ">"), "the claim is no comparison")
    require(valid(step.claim, step.premises, opaque), "the third case does not follow from these two")
    return step.claim


def _reduction(step: Inference) -> Term:
    """Return the definition of a quotient by a constant other than 0, with a new name for the quotient."""
    term = only(step.args)
    require(term.op == "div_total" and term.args[1].op == "number", "only division by constants is reduced")
    value, by = term.args
    require(exact(by) != 0, "division by 0")
    quotient = make("purify", term)
    up = make("+", quotient, number(1 if exact(by) > 0 else -1))
    bounds = make("<=", make("*", by, quotient), value), make("<", value, make("*", by, up))
    return make("and", same(term, quotient), make("and", *bounds))


def _mult_sign(step: Inference) -> Term:
    """Conclude the sign of a product from the signs of its factors."""
    conditions, product = two(step.args)
    signs: dict[Term, str] = {}
    for one in of(conditions, "and") if conditions.op == "and" else (conditions,):
        atom = only(one.args) if one.op == "not" else one
        op, factor, zero = _relation(atom)
        require(zero.op == "number" and exact(zero) == 0, "a factor is not compared with 0")
        require((op == "=") == (one.op == "not") and op in ("<", ">", "="), "no sign is stated")
        signs[factor] = op
    negative, unsigned = False, False
    for factor, power in _factors(product).items():
        require(factor in signs, "the sign of a factor is not given")
        negative ^= signs[factor] == "<" and power % 2 == 1
        unsigned |= signs[factor] == "=" and power % 2 == 1
    require(not unsigned, "a factor that is not 0 may have either sign")
    return make("=>", conditions, make("<" if negative else ">", product, number(0, product.sort)))


def _factors(product: Term) -> dict[Term, int]:
    [(monomial, coefficient)] = polynomial(product).items()
    require(coefficient > 0, "a product with a factor that is no positive number")
    return {factor: monomial.count(factor) for factor in monomial}


def _tangent(step: Inference) -> Term:
    """Conclude how x * y compares with its tangent plane in (a, b): not above it exactly where x - a and y - b differ in sign."""
    claim = step.claim
    require(len(step.args) == 5, "five arguments were expected")
    x, y, a, b, sign = step.args
    above = {"1": True, "-1": False, "true": True, "false": False}[
        str(sign.value if sign.value is not None else sign.op)
    ]
    comparison, regions = of(claim, "=")
    op, product, plane = _relation(comparison)
    require(op == (">=" if above else "<="), "the comparison is the wrong way")
    require(polynomial(product) == polynomial(make("*", x, y)), "the product is of others")
    tangent = make("+", make("*", b, x), make("*", a, y), make("neg", make("*", a, b)))
    require(polynomial(plane) == polynomial(tangent), "the plane is no tangent")
    down, up = ("<=", ">=") if above else (">=", "<=")
    corners = make("and", make("<=", x, a), make(down, y, b)), make("and", make(">=", x, a), make(up, y, b))
    require(regions is make("or", *corners), "the regions are others")
    return claim


RULES: Mapping[str, Rule] = {
    "ARITH_POLY_NORM": _poly_norm,
    "ARITH_POLY_NORM_REL": _poly_norm_rel,
    "ARITH_SUM_UB": _sum_ub,
    "ARITH_MULT_POS": _mult_pos,
    "ARITH_MULT_NEG": _mult_neg,
    "INT_TIGHT_UB": _tight_ub,
    "INT_TIGHT_LB": _tight_lb,
    "ARITH_TRICHOTOMY": _trichotomy,
    "ARITH_REDUCTION": _reduction,
    "ARITH_MULT_SIGN": _mult_sign,
    "ARITH_MULT_TANGENT": _tangent,
}
