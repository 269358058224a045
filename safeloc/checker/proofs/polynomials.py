"""Polynomials with exact coefficients: the normal form of terms of arithmetic."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from fractions import Fraction
from math import gcd, lcm

from safeloc.checker.proofs.terms import Term, exact, make

Monomial = tuple[Term, ...]
Polynomial = Mapping[Monomial, Fraction]
Leaf = Callable[[Term], Polynomial]


def constant(value: Fraction | int) -> Polynomial:
    """Return the polynomial of a number."""
    return {(): Fraction(value)} if value else {}


def polynomial(term: Term, leaf: Leaf | None = None, opaque: Collection[Term] = ()) -> Polynomial:
    """Return the normal form of a term.

    leaf    returns the polynomial of a term that is no sum, product or constant; the default is the term itself
    opaque  terms whose parts are not visited
    """
    if term in opaque:
        return single(term)
    match term.op:
        case "number":
            return constant(exact(term))
        case "to_real":
            return polynomial(term.args[0], leaf, opaque)
        case "neg":
            return _scaled(polynomial(term.args[0], leaf, opaque), Fraction(-1))
        case "+" | "-" | "*":
            return _operation(term.op, [polynomial(arg, leaf, opaque) for arg in term.args])
        case "/" if (by := as_constant(polynomial(term.args[1], leaf, opaque))) is not None and by:
            return _scaled(polynomial(term.args[0], leaf, opaque), 1 / by)
        case _:
            return leaf(term) if leaf else single(term)


def single(term: Term) -> Polynomial:
    """Return the polynomial of a single term; total division by a constant other than 0 counts as division."""
    if term.op in ("div_total", "mod_total") and _nonzero(term.args[1]):
        term = make(term.op.removesuffix("_total"), *term.args)
    return {(term,): Fraction(1)}


def _nonzero(term: Term) -> bool:
    return term.op == "number" and exact(term) != 0


def _operation(op: str, parts: list[Polynomial]) -> Polynomial:
    result = parts[0]
    for part in parts[1:]:
        result = _product(result, part) if op == "*" else _plus(result, part, Fraction(1 if op == "+" else -1))
    return _scaled(result, Fraction(-1)) if op == "-" and len(parts) == 1 else result


def _plus(left: Polynomial, right: Polynomial, factor: Fraction) -> Polynomial:
    """Return left + factor * right."""
    total = dict(left)
    for monomial, coefficient in right.items():
        total[monomial] = total.get(monomial, Fraction(0)) + factor * coefficient
    return {monomial: coefficient for monomial, coefficient in total.items() if coefficient}


def minus(left: Polynomial, right: Polynomial) -> Polynomial:
    """Return left - right."""
    return _plus(left, right, Fraction(-1))


def _scaled(part: Polynomial, factor: Fraction) -> Polynomial:
    """Return factor * part."""
    return {monomial: factor * coefficient for monomial, coefficient in part.items()} if factor else {}


def _product(left: Polynomial, right: Polynomial) -> Polynomial:
    """Return left * right."""
    total: dict[Monomial, Fraction] = {}
    for one, first in left.items():
        for other, second in right.items():
            monomial = tuple(sorted((*one, *other), key=id))
            total[monomial] = total.get(monomial, Fraction(0)) + first * second
    return {monomial: coefficient for monomial, coefficient in total.items() if coefficient}


def as_constant(part: Polynomial) -> Fraction | None:
    """Return the value of a polynomial that is a number; None for any other."""
    return part.get((), Fraction(0)) if not part or part.keys() == {()} else None


@dataclass(frozen=True)
class Direction:
    """A linear form without constant and factor: comparisons of one direction differ in the bound only.

    integer  all its variables are whole numbers
    """

    parts: frozenset[tuple[Monomial, Fraction]]
    integer: bool


def direction(part: Polynomial) -> tuple[Direction, Fraction, Fraction]:
    """Return (d, factor, rest) with part = factor * d + rest; d is the same for all multiples. The part is no constant."""
    rest = part.get((), Fraction(0))
    open_part = {monomial: coefficient for monomial, coefficient in part.items() if monomial}
    size = Fraction(gcd(*(c.numerator for c in open_part.values())), lcm(*(c.denominator for c in open_part.values())))
    first = min(open_part, key=lambda monomial: (len(monomial), [id(leaf) for leaf in monomial]))
    factor = size if open_part[first] > 0 else -size
    parts = frozenset((monomial, coefficient / factor) for monomial, coefficient in open_part.items())
    integer = all(leaf.sort == "Int" for monomial in open_part for leaf in monomial)
    return Direction(parts, integer), factor, rest
