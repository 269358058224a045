"""Check that goals follow from hypotheses: one z3 solver, one query per goal, and a countermodel if a goal fails."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import z3

from safeloc.codegen.smt import Terms, constant
from safeloc.codegen.smtlib import Key, Query, to_smtlib
from safeloc.language.nodes import Value
from safeloc.language.terms import variables
from safeloc.language.trace import shown
from safeloc.proof.cache.answers import keep_proved, keeping, proved_before
from safeloc.proof.provers.asking import ask, plain_solver, why_unknown
from safeloc.proof.provers.limits import Deadline, deadline
from safeloc.proof.provers.once import alone_in_asking


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
    """Return the goals, by their keys, that do not follow, or are not decided within `seconds` for all of them together."""
    if not keeping():
        return _failures(query, seconds, seed)
    text = to_smtlib(query)
    if proved_before("z3", text):
        return {}
    with alone_in_asking("z3", text):
        failed = {} if proved_before("z3", text) else _failures(query, seconds, seed)
        if not failed:
            keep_proved("z3", text)
    return failed


def _failures(query: Query[Key], seconds: float, seed: int) -> dict[Key, Failure]:
    asked, ends = _Asked(query, seed), deadline(seconds)
    failed = asked.together(deadline(seconds / 2)) if len(query.goals) > 1 else {}
    if asked.left:
        failed |= asked.one_by_one(ends)
    return {key: failed[key] for key in query.goals if key in failed}


class _Asked:
    """A query in the terms of z3; `left` are the goals that are not decided.

    Each question has a solver of its own: one in which questions are pushed and popped can take a hundred times as long.
    """

    def __init__(self, query: Query[Key], seed: int) -> None:
        self._goals, self._seed = query.goals, seed
        self._named = {var: constant(var) for var in variables([*query.hypotheses, *query.goals.values()])}
        terms = Terms(self._named)
        self._hypotheses = [terms.bool(term) for term in query.hypotheses]
        self.left = {key: terms.bool(goal) for key, goal in query.goals.items()}

    def together(self, ends: Deadline) -> dict[Any, Failure]:
        """Goals that do not follow: every model takes out all that are false in it, until the rest follows or time is up."""
        failed: dict[Any, Failure] = {}
        while self.left and not ends.passed:
            solver = self._solver(z3.Not(z3.And(*self.left.values())))
            answer = ask(solver, ends.left)
            if answer == z3.unknown:
                break
            if answer == z3.unsat:
                self.left = {}
                break
            model = solver.model()
            false = [key for key, goal in self.left.items() if z3.is_false(model.eval(goal, model_completion=True))]
            failed |= {key: self._refuted(key, model) for key in false}
            self.left = {key: goal for key, goal in self.left.items() if key not in failed}
        return failed

    def one_by_one(self, ends: Deadline) -> dict[Any, Failure]:
        """Each goal that is left by itself: those that do not follow, or are not decided."""
        failed: dict[Any, Failure] = {}
        for key, goal in self.left.items():
            solver = self._solver(z3.Not(goal))
            answer = ask(solver, ends.left)
            if answer == z3.sat:
                failed[key] = self._refuted(key, solver.model())
            elif answer == z3.unknown:
                failed[key] = Undecided("limit reached" if ends.passed else f"solver: {why_unknown(solver)}")
        self.left = {}
        return failed

    def _solver(self, condition: z3.BoolRef | z3.Probe) -> z3.Solver:
        solver = plain_solver(self._seed)
        solver.add(*self._hypotheses, condition)
        return solver

    def _refuted(self, key: Any, model: z3.ModelRef) -> Refuted:
        return Refuted({var.name: shown(var, _value(model, self._named[var])) for var in variables([self._goals[key]])})


def _value(model: z3.ModelRef, term: z3.ExprRef) -> Value:
    value = model.eval(term, model_completion=True)
    return int(value.as_long()) if isinstance(value, z3.IntNumRef) else z3.is_true(value)
