"""The hypotheses that a proof needs: z3's unsatisfiable core of a query, conjunct by conjunct.

A goal that follows from fewer hypotheses follows from all, so leaving some out is sound. What is left is what cvc5 has to
decide, and what a certificate holds. Facts about products stay as well: a model states them since solvers do not find them,
and what z3 happens to find by itself, cvc5 does not.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import z3

from safeloc.codegen.smt import Terms, constant
from safeloc.codegen.smtlib import Key, Query, to_smtlib
from safeloc.language.expr import Bool
from safeloc.language.nodes import Mul
from safeloc.language.terms import conjuncts, in_order, variables
from safeloc.proof.cache.answers import keep_needed, needed_before
from safeloc.proof.provers.asking import ask, plain_solver

SECONDS = 10.0
"""Of effort, to find the core: most take 0.1 s, and without one nothing is lost but time."""


def only_needed(query: Query[Key], seconds: float = SECONDS) -> Query[Key]:
    """Return the query with the hypotheses from which z3 proves all its goals together.

    All of them, conjunct by conjunct, if z3 does not prove the goals within the seconds of effort.
    """
    parts = list(dict.fromkeys(part for term in query.hypotheses for part in conjuncts(term)))
    text = to_smtlib(replace(query, hypotheses=parts, witnesses={}))
    numbers = needed_before(text, len(parts))
    if numbers is None:
        numbers = _core(parts, list(query.goals.values()), seconds)
        if numbers is not None:
            keep_needed(text, numbers)
    if numbers is None:
        return replace(query, hypotheses=parts)
    named = set(variables([*(parts[number] for number in numbers), *query.goals.values()]))
    products = {n for n, part in enumerate(parts) if _of_products(part) and named.issuperset(variables([part]))}
    return replace(query, hypotheses=[parts[number] for number in sorted(products.union(numbers))])


def _of_products(part: Bool) -> bool:
    """Return whether the term multiplies two numbers of which none is a constant."""
    return any(isinstance(node, Mul) and not node.by_constant for node in in_order([part]))


def _core(parts: Sequence[Bool], goals: Sequence[Bool], seconds: float) -> list[int] | None:
    """Return the numbers of the parts that z3 uses; None if it finds no proof in time."""
    terms = Terms({var: constant(var) for var in variables([*parts, *goals])})
    switches = [z3.Bool(number) for number in range(len(parts))]  # a number is no variable's name
    solver = plain_solver()
    for switch, part in zip(switches, parts, strict=True):
        solver.add(z3.Implies(switch, terms.bool(part)))
    solver.add(z3.Not(z3.And(*(terms.bool(goal) for goal in goals))))
    if ask(solver, seconds, *switches) != z3.unsat:
        return None
    used = {str(switch) for switch in solver.unsat_core()}
    return [number for number, switch in enumerate(switches) if str(switch) in used]
