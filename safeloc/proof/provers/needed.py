"""The hypotheses that a proof needs: z3's unsatisfiable core of a query, conjunct by conjunct.

A goal that follows from fewer hypotheses follows from all, so leaving some out is sound. What is left is what cvc5 has to
decide, and what a certificate holds.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import z3

from safeloc.codegen.smt import Terms, constant
from safeloc.codegen.smtlib import Key, Query, to_smtlib
from safeloc.language.expr import Bool
from safeloc.language.terms import conjuncts, variables
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
    return replace(query, hypotheses=parts if numbers is None else [parts[number] for number in numbers])


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
