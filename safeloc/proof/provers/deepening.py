"""Incremental bounded search: one solver, and runs that become longer by one step at a time."""

from __future__ import annotations

from collections.abc import Iterable

import z3

from safeloc.codegen.smt import Unrolling
from safeloc.language.expr import Bool, Var
from safeloc.language.nodes import Value
from safeloc.proof.provers.asking import ask, why_unknown
from safeloc.proof.provers.limits import Deadline, deadline
from safeloc.proof.provers.machine_by_machine import SOON_S, run_by_machines


class Deepening:
    """Runs of a system, searched length by length, from its first states or from those that `begins` describes.

    depth  number of steps searched completely; -1 until the first states are searched
    stuck  the reason why the solver did not answer the last question; "" if it did
    """

    def __init__(
        self, unrolling: Unrolling, solver: z3.Solver, begins: Iterable[z3.BoolRef | bool] | None = None
    ) -> None:
        self._unrolling, self._solver = unrolling, solver
        self._solver.add(*([unrolling.initially()] if begins is None else begins))
        self.depth, self.stuck = -1, ""

    def fails(self, *terms: Bool) -> z3.BoolRef:
        """Return the condition that one of the terms fails at the end of the runs that are searched now."""
        failed = [z3.Not(self._unrolling.at(term, self.depth + 1)) for term in terms]
        one_fails: z3.BoolRef = failed[0] if len(failed) == 1 else z3.Or(*failed)  # pyright: ignore[reportAssignmentType] # no Probe here
        return one_fails

    def run(self, condition: z3.BoolRef, ends: Deadline) -> z3.ModelRef | None:
        """Return a run of depth + 1 steps that meets the condition; None if there is none, or the solver is stuck."""
        self._solver.push()
        self._solver.add(condition)
        answer = ask(self._solver, ends.left)
        self.stuck = why_unknown(self._solver) if answer == z3.unknown else ""
        model = self._solver.model() if answer == z3.sat else None
        self._solver.pop()
        return model

    def run_by_machines(self, condition: z3.BoolRef, ends: Deadline, seed: int) -> z3.ModelRef | None:
        """Do as `run`, for a short time; then search machine by machine. `stuck` says that neither decided."""
        model = self.run(condition, deadline(min(SOON_S, ends.left)))
        if not self.stuck:
            return model
        found = run_by_machines(self._unrolling.system, [*self._solver.assertions(), condition], ends, seed)
        if isinstance(found, str):
            self.stuck = "" if found == "none" else self.stuck
            return None
        self.stuck = ""
        return found

    def run_anew(self, condition: z3.BoolRef, ends: Deadline, solver: z3.Solver) -> z3.ModelRef | None:
        """Do as `run`, in a new solver: quicker where the one that has been asked before gets lost."""
        solver.add(*self._solver.assertions(), condition)
        answer = ask(solver, ends.left)
        self.stuck = why_unknown(solver) if answer == z3.unknown else ""
        return solver.model() if answer == z3.sat else None

    def deeper(self, *known: Bool) -> None:
        """Make the runs one step longer; the terms hold at the end of all runs of the length searched so far."""
        self.depth += 1
        self._solver.add(
            *(self._unrolling.at(term, self.depth) for term in known), self._unrolling.transition(self.depth)
        )

    def failed(self, model: z3.ModelRef, term: Bool) -> bool:
        """Return whether the term fails at the end of a run that was found."""
        return bool(z3.is_false(model.eval(self._unrolling.at(term, self.depth + 1), model_completion=True)))

    def first(self, model: z3.ModelRef, variables: Iterable[Var]) -> dict[str, Value]:
        """Return the values of variables in the first state of a run that was found."""
        return self._unrolling.values(model, 0, variables)

    def end(self, model: z3.ModelRef, variables: Iterable[Var]) -> dict[str, Value]:
        """Return the values of variables at the end of a run that was found."""
        return self._unrolling.values(model, self.depth + 1, variables)

    def stream(self, model: z3.ModelRef) -> list[dict[str, Value]]:
        """Return the inputs of every step of a run that was found."""
        inputs = self._unrolling.system.inputs
        return [self._unrolling.values(model, number, inputs) for number in range(self.depth + 1)]
