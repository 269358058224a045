"""Many queries over terms that mostly stay the same: each term is translated for z3 only once.

They serve to ask the same question about a thousand variants of a system. No other solver confirms the answers, so no
verdict is made from them.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping, Sequence
from typing import Protocol, TypeVar

import z3

from safeloc.codegen.smt import Terms, constant
from safeloc.language.expr import Bool, Expr, Var
from safeloc.language.terms import in_order
from safeloc.proof.provers.asking import ask, plain_solver
from safeloc.proof.provers.limits import deadline

Key = TypeVar("Key", bound=Hashable)
_AT_FIRST = 0.25
"""Share of the limit for the first question of `Under`, before the goals are asked in other ways."""


class Standing:
    """Queries that decide if goals follow from hypotheses; variables are identified by name.

    Until `learnt` is called, it learns how many goals z3 can decide together. After that no answer depends on earlier
    queries.
    """

    def __init__(self) -> None:
        self._met: set[Expr] = set()
        self._terms = Terms({})
        self._together, self._learning = 1_000_000, True

    def learnt(self) -> None:
        """End the learning: from now on ask for as many goals together as it has learnt."""
        self._learning = False

    def failures(self, hypotheses: Sequence[Bool], goals: Mapping[Key, Bool], seconds: float) -> dict[Key, bool]:
        """Return the goals that do not follow: True if a counterexample refutes the goal, False if it is undecided."""
        asked = {key: self._translated(goal) for key, goal in goals.items()}
        premises = [self._translated(term) for term in hypotheses]
        return self.decided(premises, asked, seconds)

    def all_follow(self, hypotheses: Sequence[Bool], goals: Mapping[Key, Bool], seconds: float) -> bool:
        """Return whether all goals follow; one counterexample ends the question."""
        return not goals or not self.under(hypotheses).some_failures((), goals, seconds)

    def under(self, facts: Sequence[Bool]) -> Under:
        """Return questions with these facts as hypotheses, and further ones that change from question to question."""
        return Under(self.decided, self._translated, [self._translated(term) for term in facts])

    def decided(
        self, premises: Sequence[z3.BoolRef], goals: Mapping[Key, z3.BoolRef], seconds: float
    ) -> dict[Key, bool]:
        """Decide translated goals together, and halve a set that is undecided; each part has the whole limit."""
        failed = dict[Key, bool]()
        waiting = [dict(goals)]
        while waiting:
            part = waiting.pop(0)
            if len(part) > self._together:
                waiting = [*_halves(part), *waiting]
                continue
            found = _decided(premises, part, seconds)
            undecided = {key: goal for key, goal in part.items() if found.get(key) is False}
            failed |= found
            if len(undecided) > 1:
                self._together = len(undecided) // 2 if self._learning else self._together
                failed = {key: refuted for key, refuted in failed.items() if key not in undecided}
                waiting = [*_halves(undecided), *waiting]
        return failed

    def _translated(self, term: Bool) -> z3.BoolRef:
        new = in_order([term], self._met)
        self._met.update(new)
        self._terms.add({var: constant(var) for var in new if isinstance(var, Var)})
        return self._terms.bool(term)


class _Decided(Protocol):
    """Decides translated goals, as `Standing.decided` does."""

    def __call__(
        self, premises: Sequence[z3.BoolRef], goals: Mapping[Key, z3.BoolRef], seconds: float
    ) -> dict[Key, bool]: ...


class Under:
    """Questions with the same facts: one solver has these once, and keeps what it learns; other hypotheses are switched on by literals."""

    def __init__(
        self, decided: _Decided, translated: Callable[[Bool], z3.BoolRef], facts: Sequence[z3.BoolRef]
    ) -> None:
        self._decided, self._translated, self._facts = decided, translated, facts
        self._literals: dict[Bool, z3.BoolRef] = {}
        self._solver: z3.Solver | None = None

    def some_failures(self, hypotheses: Sequence[Bool], goals: Mapping[Key, Bool], seconds: float) -> dict[Key, bool]:
        """Return goals that do not follow, as `Standing.failures` does: all that one model makes false; none only if all goals follow.

        If no model is found, and the goals are not proved together either, all that do not follow are returned.
        """
        asked = {key: self._translated(goal) for key, goal in goals.items()}
        solver, premises = self._asked(), [self._literal(term) for term in hypotheses]
        some = z3.FreshBool("fails")
        solver.add(z3.Implies(some, z3.Not(z3.And(*asked.values()))))
        answer = ask(solver, _AT_FIRST * seconds, *premises, some)
        if answer == z3.unsat:
            return {}
        if answer == z3.sat:
            return dict.fromkeys(_false(solver.model(), asked), True)
        return self._decided([*self._facts, *map(self._translated, hypotheses)], asked, seconds)

    def _asked(self) -> z3.Solver:
        if self._solver is None:
            self._solver = plain_solver()
            self._solver.add(*self._facts)
        return self._solver

    def _literal(self, term: Bool) -> z3.BoolRef:
        """Return the literal that switches the hypothesis on."""
        if term not in self._literals:
            literal = z3.FreshBool("given")
            self._asked().add(z3.Implies(literal, self._translated(term)))
            self._literals[term] = literal
        return self._literals[term]


def _decided(premises: Sequence[z3.BoolRef], goals: Mapping[Key, z3.BoolRef], seconds: float) -> dict[Key, bool]:
    """Decide goals together; return True for each refuted goal and False for each undecided one.

    One solver serves for all models: `not all of the goals left` implies the same of more goals, so nothing has to be taken back.
    """
    failed, left, ends = dict[Key, bool](), dict(goals), deadline(seconds)
    solver = plain_solver()
    solver.add(*premises)
    while left:
        solver.add(z3.Not(z3.And(*left.values())))
        answer = ask(solver, ends.left)
        if answer == z3.unknown:
            return failed | dict.fromkeys(left, False)
        if answer == z3.unsat:
            return failed
        false = _false(solver.model(), left)
        failed |= dict.fromkeys(false, True)
        left = {key: goal for key, goal in left.items() if key not in false}
    return failed


def _halves(goals: dict[Key, z3.BoolRef]) -> list[dict[Key, z3.BoolRef]]:
    keys, middle = list(goals), len(goals) // 2
    parts = [keys[:middle], keys[middle:]]
    return [{key: goals[key] for key in part} for part in parts if part]


def _false(model: z3.ModelRef, goals: Mapping[Key, z3.BoolRef]) -> set[Key]:
    """Return the goals that a model makes false. They are evaluated as one number, a bit for each, so that z3 evaluates shared parts once."""
    bits = [z3.If(goal, 0, 1 << number) for number, goal in enumerate(goals.values())]
    value = model.eval(z3.Sum(bits), model_completion=True)
    assert isinstance(value, z3.IntNumRef)
    number = value.as_long()
    return {key for place, key in enumerate(goals) if number >> place & 1}
