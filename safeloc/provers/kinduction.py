"""k-induction: unbounded proofs, with the system's proved base as hypotheses.

k = 1 keeps a one-step inductive invariant; k > 1 is certified by its own base and step queries. Every text is
re-checked by cvc5 before the verdict is Proved.
"""

from __future__ import annotations

import time
from dataclasses import replace

from safeloc.backends.smtlib import Query, to_smtlib
from safeloc.expr import Bool, BoolVar, Expr, NumVar, Substitution, Var, all_of
from safeloc.provers.base import Base, base, unproved
from safeloc.provers.limits import Limits
from safeloc.provers.recheck import ENGINE, recheck
from safeloc.spec import Goal
from safeloc.system import environment, in_range
from safeloc.verdict import Proved, Unknown, Verdict


def kinduction(goal: Goal, limits: Limits) -> Verdict:
    """Proved, or Unknown: this engine finds no violations."""
    known, ends = base(goal.original, seconds=limits.seconds), time.monotonic() + limits.seconds
    for k in range(1, limits.induction + 1):
        left = ends - time.monotonic()
        if left <= 0:
            return Unknown(f"time limit of {limits.seconds:g} s at k = {k}", k - 2)
        first, later = queries(goal, known, k)
        if unproved(first, left, limits.seed):
            return Unknown(f"the property fails within {k - 1} steps of the start, or the solver gave up", k - 2)
        if not unproved(later, left, limits.seed):
            return _proved(goal, known, k, (first, later))
    return Unknown(f"not {limits.induction}-inductive with the declared lemmas", limits.induction - 1)


def _proved(goal: Goal, known: Base, k: int, both: tuple[Query, Query]) -> Proved:
    texts = {f"{_file(query.name)}.smt2": to_smtlib(query) for query in both}
    for name, text in texts.items():
        recheck(name, text)
    given = list(known.always.values()) if goal.prop.unconditional else known.everything
    invariant = all_of([*given, goal.good, goal.helper])
    return Proved(invariant, f"{k}-induction", k, (ENGINE,), {**known.certificates, **texts})


def _file(name: str) -> str:
    return "".join(letter if letter.isalnum() else "-" for letter in name)


def queries(goal: Goal, known: Base, k: int) -> tuple[Query, Query]:
    """Base: `good` in the first k states. Step: after k good states comes another."""
    good = all_of([goal.good, goal.helper, in_range(goal.observers)])
    name = f"{goal.original.name} {goal.prop.name}"
    states, allowed = _unrolled(goal, k)
    given = list(known.always.values()) if goal.prop.unconditional else known.everything
    hold = [state.bool(good) for state in states]
    facts = [state.bool(term) for state in states[:-1] for term in given]
    start = Query(
        f"{name} initially",
        [goal.system.init, in_range(goal.system.state), *given, *allowed[:-1]],
        _numbered(hold[:k]),
    )
    return start, Query(f"{name} in every step", [*facts, *allowed, *hold[:k]], {"good after the last step": hold[k]})


def _numbered(terms: list[Bool]) -> dict[str, Bool]:
    return {f"good after {number} steps": term for number, term in enumerate(terms)}


def _unrolled(goal: Goal, k: int) -> tuple[list[Substitution], list[Bool]]:
    """State 0 as it is, states 1 to k as terms over it and the steps' inputs, and what each step is allowed."""
    system = goal.system
    environment_ = environment(system)
    now: dict[Var, Expr] = {}
    states, allowed = [Substitution(now)], []
    for number in range(k):
        inputs: dict[Var, Expr] = {var: _numbered_input(var, number) for var in system.inputs} if number else {}
        step = Substitution({**now, **inputs})
        allowed.append(step.bool(environment_))
        now = {var: step(term) for var, term in system.next.items()}
        states.append(Substitution(now))
    return states, allowed


def _numbered_input(var: Var, number: int) -> NumVar | BoolVar:
    return replace(var, name=f"{var.name}@{number}")
