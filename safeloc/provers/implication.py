"""Whether goals follow from hypotheses: one z3 solver, one question a goal, and what speaks against it if not."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import z3

from safeloc.backends.smt import Terms, constant
from safeloc.backends.smtlib import Key, Query, to_smtlib
from safeloc.cache.answers import keep_proved, keeping, proved_before
from safeloc.expr import Bool, Var
from safeloc.nodes import And, Value
from safeloc.provers.limits import deadline, milliseconds
from safeloc.terms import variables
from safeloc.trace import shown


@dataclass(frozen=True)
class Refuted:
    """The goal does not follow; `example` gives values under which the hypotheses hold and it does not."""

    example: Mapping[str, str]

    @property
    def values(self) -> str:
        """The example as text."""
        return ", ".join(f"{name} = {value}" for name, value in self.example.items())

    def __str__(self) -> str:
        return f"does not follow, for example when {self.values}"


@dataclass(frozen=True)
class Undecided:
    """The solver gave up, for the reason it states."""

    reason: str

    def __str__(self) -> str:
        return f"undecided: {self.reason}"


Failure = Refuted | Undecided


def unproved(query: Query[Key], seconds: float, seed: int = 0) -> dict[Key, Failure]:
    """The goals, by their keys, that do not follow, or are not decided within `seconds` for all of them together."""
    text = to_smtlib(query) if keeping() else ""
    if text and proved_before("z3", text):
        return {}
    failed = _failures(query, seconds, seed)
    if text and not failed:
        keep_proved("z3", text)
    return failed


def _failures(query: Query[Key], seconds: float, seed: int) -> dict[Key, Failure]:
    named = {var: constant(var) for var in variables([*query.hypotheses, *query.goals.values()])}
    terms, solver, ends = Terms(named), z3.Solver(), deadline(seconds)
    solver.set("random_seed", seed)
    solver.add(*(terms.bool(term) for term in query.hypotheses))
    failed: dict[Key, Failure] = {}
    for key, goal in query.goals.items():
        if ends.passed:
            failed[key] = Undecided(f"time limit of {seconds:g} s")
            continue
        solver.set("timeout", milliseconds(ends.left))
        solver.push()
        solver.add(z3.Not(terms.bool(goal)))
        failure = _failure(solver, goal, named)
        if failure is not None:
            failed[key] = failure
        solver.pop()
    return failed


def _failure(solver: z3.Solver, goal: Bool, named: Mapping[Var, z3.ExprRef]) -> Failure | None:
    answer = solver.check()
    if answer == z3.unsat:
        return None
    if answer == z3.unknown:
        return Undecided(f"solver: {solver.reason_unknown()}")
    model = solver.model()
    return Refuted({var.name: shown(var, _value(model, named[var])) for var in variables([goal])})


def _value(model: z3.ModelRef, term: z3.ExprRef) -> Value:
    value = model.eval(term, model_completion=True)
    return int(value.as_long()) if isinstance(value, z3.IntNumRef) else z3.is_true(value)


def conjuncts(term: Bool) -> Iterable[Bool]:
    """The parts of a conjunction, of its conjunctions, and so on; the term itself if it is none."""
    stack = [term]
    while stack:
        part = stack.pop()
        if isinstance(part, And):
            stack.extend(reversed(part.parts))
        else:
            yield part
