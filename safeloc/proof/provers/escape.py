"""A counterexample to induction as a run: it begins in a state that keeps all that is proved, and a good step leads to a bad one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from safeloc.language.expr import NumVar, Var
from safeloc.language.interpret import named, taken
from safeloc.language.nodes import Value
from safeloc.language.spec import Goal
from safeloc.language.system import canonical
from safeloc.language.trace import Trace
from safeloc.proof.provers.implication import countermodel
from safeloc.proof.provers.kinduction import numbered_input, queries
from safeloc.proof.provers.limits import Limits, deadline
from safeloc.proof.provers.proved_base import base


@dataclass(frozen=True)
class Escape:
    """The run: its first `good_steps` states keep the property, the last one does not.

    No run of the machine need come to its first state: it keeps every proved range and lemma, and that is all that is known of it.
    """

    run: Trace
    good_steps: int

    @property
    def row(self) -> str:
        """The transitions of the last step, which leads out."""
        return ", ".join(self.run.steps[-1].fired.values())


def escape(goal: Goal, limits: Limits) -> Escape | None:
    """Return the counterexample to the longest induction within the limits for which z3 finds one; None if it finds none."""
    known, ends = base(goal.original, seconds=limits.seconds), deadline(limits.seconds)
    for k in range(limits.induction, 0, -1):
        _, later = queries(goal, known, k)
        values = countermodel(later, ends.left, limits.seed)
        if values is not None:
            return Escape(_run(goal, values, k), k)
    return None


def _run(goal: Goal, values: Mapping[Var, Value], steps: int) -> Trace:
    """Run the interpreter from the state of the model, with its inputs; what the question does not read is at rest."""
    system, hidden = goal.system, frozenset(goal.observers)
    state = {var: values.get(var, _rest(var)) for var in system.state}
    stream = []
    for number in range(steps):
        numbered = {var: numbered_input(var, number) if number else var for var in system.inputs}
        given = {var: values.get(one, _rest(var)) for var, one in numbered.items()}
        for option in system.optionals:
            if not given[option.present]:
                given[option.value] = _rest(option.value)
        stream.append({var.name: value for var, value in given.items()})
    made = tuple(one for one, _ in taken(system, state, stream, hidden=hidden))
    return Trace(goal.plain, named(state, hidden), made)


def _rest(var: Var) -> Value:
    return canonical(var) if isinstance(var, NumVar) else False
