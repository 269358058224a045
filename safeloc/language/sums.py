"""Decomposition of a number into a sum of multiples.

factors(term, of)   variable -> factor for the variables `of`, and a rest that reads none of them
atoms(term)         term -> factor for the smallest terms of the sum, and a constant
least(term)         a lower bound; equal terms on both sides of a difference cancel
"""

from __future__ import annotations

from collections.abc import Container, Mapping
from dataclasses import dataclass

from safeloc.language.nodes import Add, Lit, Mul, Num, NumVar, Sub, Var, arith, product
from safeloc.language.ranges import bounds
from safeloc.language.terms import variables


@dataclass(frozen=True, eq=False)
class Sum:
    """A sum of variables with factors (`of`: variable -> factor, none 0), and a `rest` that reads none of the variables."""

    of: Mapping[NumVar, int]
    rest: Num


def factors(term: Num, of: Container[Var]) -> Sum | None:
    """Return the term as a sum over the variables `of`; None if it is not linear in them."""
    if isinstance(term, NumVar) and term in of:
        return Sum({term: 1}, Lit(0, term.unit))
    if not any(var in of for var in variables([term])):
        return Sum({}, term)
    match term:
        case Add(left, Lit(0)):  # a conversion of unit
            return factors(left, of)
        case Add(left, right) | Sub(left, right):
            return _added(term, factors(left, of), factors(right, of))
        case Mul(Lit(factor) as constant, inner) | Mul(inner, Lit(factor) as constant):
            one = factors(inner, of)
            return None if one is None else Sum(_scaled(one.of, factor), product(one.rest, constant))
        case _:
            return None


def _added(term: Add | Sub, left: Sum | None, right: Sum | None) -> Sum | None:
    if left is None or right is None:
        return None
    sign = 1 if isinstance(term, Add) else -1
    rest: Num = type(term)(left.rest, right.rest, term.unit)
    if left.rest.unit.same(right.rest.unit):  # not where a conversion gives the sum its unit
        rest = arith(type(term), left.rest, right.rest, lambda a, b: a + sign * b)
    return Sum(_together(left.of, _scaled(right.of, sign)), rest)


def _scaled(of: Mapping[NumVar, int], factor: int) -> dict[NumVar, int]:
    return {var: one * factor for var, one in of.items()} if factor else {}


def _together(one: Mapping[NumVar, int], other: Mapping[NumVar, int]) -> dict[NumVar, int]:
    both = {var: one.get(var, 0) + other.get(var, 0) for var in {**one, **other}}
    return {var: factor for var, factor in both.items() if factor}


def least(term: Num) -> int:
    """Return a lower bound of the term while variables stay in their ranges."""
    found, constant = atoms(term)
    within = bounds(found)
    return constant + sum(factor * within[atom][0 if factor > 0 else 1] for atom, factor in found.items())


def atoms(term: Num) -> tuple[dict[Num, int], int]:
    """Return the terms, each with its factor, and the constant that the term is the sum of."""
    match term:
        case Lit(value, _):
            return {}, value
        case Add(left, right) | Sub(left, right):
            sign = 1 if isinstance(term, Add) else -1
            (found, constant), (others, more) = atoms(left), atoms(right)
            for atom, factor in others.items():
                found[atom] = found.get(atom, 0) + sign * factor
            return {atom: factor for atom, factor in found.items() if factor}, constant + sign * more
        case Mul(Lit(factor), inner) | Mul(inner, Lit(factor)):
            found, constant = atoms(inner)
            return {atom: one * factor for atom, one in found.items() if factor}, constant * factor
        case _:
            return {term: 1}, 0
