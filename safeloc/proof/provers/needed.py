"""The hypotheses that a proof needs: z3's unsatisfiable core of a query, conjunct by conjunct.

Leaving hypotheses out is sound: a goal that follows from some of them follows from all. the second solver decides the shorter query,
and the certificate holds it. Facts about products of its variables stay as well: models state them because solvers do not
find them, and even where z3 finds one by itself, cvc5 does not.
"""

from __future__ import annotations

from dataclasses import replace

from safeloc.codegen.smtlib import Key, Query, to_smtlib
from safeloc.language.expr import Bool
from safeloc.language.nodes import Mul
from safeloc.language.terms import in_order, variables
from safeloc.proof.cache.answers import keep_needed, keeping, needed_before
from safeloc.proof.provers.implication import CORE_SECONDS, core_of, find_core, parts_of


def only_needed(query: Query[Key], seconds: float = CORE_SECONDS) -> Query[Key]:
    """Return the query with the hypotheses from which z3 proves all its goals together.

    All hypotheses stay, conjunct by conjunct, if z3 does not prove the goals within the seconds of effort.
    """
    parts = parts_of(query)
    text = to_smtlib(replace(query, hypotheses=parts, witnesses={})) if keeping() else ""
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
    products = {n for n, part in enumerate(parts) if _of_products(part) and named.issuperset(variables([part]))}
    return replace(query, hypotheses=[parts[number] for number in sorted(products.union(numbers))])


def _of_products(part: Bool) -> bool:
    """Return whether the term multiplies two numbers of which none is a constant."""
    return any(isinstance(node, Mul) and not node.by_constant for node in in_order([part]))
