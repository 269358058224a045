"""Many questions to z3 about one set of conditions, which is translated once."""

from __future__ import annotations

from collections.abc import Sequence

import z3

from safeloc.codegen.smt import Terms, constant, value_of
from safeloc.language.expr import Bool, Expr, Var
from safeloc.language.nodes import Value
from safeloc.language.terms import variables
from safeloc.proof.provers.asking import ask, plain_solver


class GaveUpError(Exception):
    """z3 does not decide a question within the seconds of effort."""


class Models:
    """Values of variables under which all conditions hold.

    about   terms that the questions speak of, besides the conditions
    The solver keeps what it learns from one question to the next, until one is too hard for it: the next gets a new solver, since one that
    has learned much can take a hundred times as long.
    """

    def __init__(self, conditions: Sequence[Bool], about: Sequence[Expr], seed: int = 0) -> None:
        self._named = {var: constant(var) for var in variables([*conditions, *about])}
        self._terms, self._seed = Terms(self._named), seed
        self._conditions = [self._terms.bool(one) for one in conditions]
        self._solver = self._new()

    def in_which(self, condition: Bool, seconds: float) -> dict[Var, Value] | None:
        """Return values under which this condition holds too; None if there are none. GaveUpError if z3 does not decide that."""
        self._solver.push()
        self._solver.add(self._terms.bool(condition))
        answer = ask(self._solver, seconds)
        model = self._solver.model() if answer == z3.sat else None
        self._solver.pop()
        if answer == z3.unknown:
            self._solver = self._new()
            raise GaveUpError
        return None if model is None else {var: value_of(model, term) for var, term in self._named.items()}

    def _new(self) -> z3.Solver:
        solver = plain_solver(self._seed)
        solver.add(*self._conditions)
        return solver
