"""The hypotheses that a proof needs: z3's unsatisfiable core of a query, conjunct by conjunct.

Leaving hypotheses out is sound: a goal that follows from some of them follows from all. the second solver decides the shorter query,
and the certificate holds it. Facts about products of its variables stay as well: models state them because solvers do not
find them, and even where z3 finds one by itself, cvc5 does not.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from safeloc.codegen.smtlib import Key, Query
from safeloc.language.expr import Bool, Expr
from safeloc.language.nodes import Mul
from safeloc.language.terms import children, in_order, variables
from safeloc.proof.cache.answers import keep_needed, keeping, needed_before
from safeloc.proof.provers.implication import CORE_SECONDS, core_of, find_core, parts_of, text_of


def only_needed(query: Query[Key], seconds: float = CORE_SECONDS) -> Query[Key]:
    """Return the query with the hypotheses from which z3 proves all its goals together.

    All hypotheses stay, conjunct by conjunct, if z3 does not prove the goals within the seconds of effort.
    """
    parts = parts_of(query)
    text = text_of(query) if keeping() else ""
    numbers = core_of(query)
    if numbers is None and text:
        numbers = needed_before(text, len(parts))
    if numbers is None:
        numbers = find_core(query, seconds)
    if numbers is not None and text:
        keep_needed(text, numbers)
    if numbers is None:
        return replace(query, hypotheses=parts)
    named = set(variables([*(parts[number] for number in numbers), *query.goals.values()]))
    multiply = _of_products(parts)
    products = {n for n, part in enumerate(parts) if part in multiply and named.issuperset(variables([part]))}
    return replace(query, hypotheses=[parts[number] for number in sorted(products.union(numbers))])


def _of_products(parts: Sequence[Bool]) -> set[Expr]:
    """Return every term in these parts that multiplies two numbers of which none is a constant."""
    found = set[Expr]()
    for node in in_order(parts):  # operands first
        if (isinstance(node, Mul) and not node.by_constant) or not found.isdisjoint(children(node)):
            found.add(node)
    return found
