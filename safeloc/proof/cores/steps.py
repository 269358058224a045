"""A claim's k-induction for z3 with a switch for each element, to find out which of them the proof needs.

A lemma that is switched on is a hypothesis, and has to hold after the step as well. An element that is switched off has no
effect.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import z3

from safeloc.codegen.smt import Terms, constant
from safeloc.language.expr import Bool, all_of
from safeloc.language.system import environment, in_range
from safeloc.proof.cores.elements import Asked, Element, nothing_fires
from safeloc.proof.provers.asking import ask, new_solver
from safeloc.proof.provers.limits import Limits


class Switched:
    """Start and step of a k-induction, in two solvers that answer all queries.

    k          the number of consecutive states that the induction step assumes
    undecided  True if the last query was not decided within the limits
    """

    def __init__(self, claim: Asked, k: int, limits: Limits) -> None:
        self._claim, self._limits = claim, limits
        self.elements, self.k, self.undecided = claim.elements, k, False
        self._wanted = all_of([claim.goal.good, claim.goal.helper, in_range(claim.goal.observers)])
        self._always = _in_every_step(claim)
        self._states = [_named(claim, number) for number in range(k + 1)]
        self._switch = {one: z3.Bool(f"element {number}") for number, one in enumerate(claim.elements)}
        self._start, self._step = new_solver(limits.seed), new_solver(limits.seed)
        self._begin(k)
        self._go_on(k)

    def proved_by(self, chosen: Sequence[Element]) -> tuple[Element, ...] | None:
        """Return those of the chosen elements that the solvers used; None if the claim does not follow from the chosen
        ones, or if this was not decided within the limits."""
        on, used = set(chosen), set[str]()
        self.undecided = False
        switches = [term if one in on else z3.Not(term) for one, term in self._switch.items()]
        for solver in (self._step, self._start):
            answer = ask(solver, self._limits.seconds, *switches)
            if answer != z3.unsat:
                self.undecided = answer == z3.unknown
                return None
            used |= {str(term) for term in solver.unsat_core()}
        return tuple(one for one in chosen if str(self._switch[one]) in used)

    def _begin(self, k: int) -> None:
        """Add the query of the start: one of the first k states violates the claim."""
        goal = self._claim.goal
        self._start.add(self._states[0].bool(all_of([goal.system.init, in_range(goal.system.state)])))
        for number in range(k - 1):
            self._start.add(*self._moves(number))
        if not self._claim.together:
            for number in range(k):
                self._start.add(*self._facts(number))
        self._start.add(z3.Or(*(self._wrong(number) for number in range(k))))

    def _go_on(self, k: int) -> None:
        """Add the query of the step: k good states are followed by one that violates the claim."""
        for number in range(k):
            self._step.add(self._states[number].bool(self._wanted), *self._facts(number), *self._moves(number))
        self._step.add(self._wrong(k))

    def _wrong(self, number: int) -> Any:
        now = self._states[number]
        lemmas = self._claim.states if self._claim.together else {}
        broken = [z3.And(self._switch[one], z3.Not(now.bool(term))) for one, term in lemmas.items()]
        return z3.Or(z3.Not(now.bool(self._wanted)), *broken)

    def _facts(self, number: int) -> Iterator[z3.BoolRef]:
        return self._switched(number, self._claim.states)

    def _switched(self, number: int, terms: Mapping[Element, Bool]) -> Iterator[z3.BoolRef]:
        for one, term in terms.items():
            yield z3.Implies(self._switch[one], self._states[number].bool(term))

    def _moves(self, number: int) -> Iterator[Any]:  # z3 builds terms by operators that type checkers cannot see
        now, after = self._states[number], self._states[number + 1]
        yield now.bool(self._always)
        yield from (after(var) == now(term) for var, term in self._claim.goal.system.next.items())
        yield from self._switched(number, self._claim.steps)


def _in_every_step(claim: Asked) -> Bool:
    """Return the hypotheses of every step: ranges of inputs and on-board state, and the claim's further assumption."""
    goal = claim.goal
    on_board = [var for var in goal.original.state if var not in goal.original.ghosts]
    always = [environment(goal.system, assume=False), in_range(on_board), nothing_fires(goal.original, goal)]
    return all_of([*always, goal.prop.further_assumption])


def _named(claim: Asked, number: int) -> Terms:
    system = claim.goal.system
    return Terms({var: constant(var, f"@{number}") for var in (*system.state, *system.inputs)})
