"""Search for a run of a composition machine by machine, where the question about the whole is too much for the solver at once.

A run has to satisfy conditions that read a few machines each. The machines are taken in the order of the step: the values of one
machine are searched for, given those of the machines before it, which stay as they were found. Where that cannot be done, the
values of the last machines before it are given up and searched for again, together with its own; of more and more of them, up to
_MOST_AGAIN. So a question is about a few machines, however many there are. Not every run is found this way; but one that is found
satisfies all conditions, since the solver confirms it for the whole at the end, and "there is none" is said only where
the conditions on the first machines contradict each other by themselves.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import z3

from safeloc.language.system import TransitionSystem
from safeloc.proof.provers.asking import ask, plain_solver
from safeloc.proof.provers.limits import Deadline

SOON_S = 1.0
"""Seconds of effort for the question about the whole, before it is asked machine by machine."""
_MOST_AGAIN = 16
"""Most machines whose values are given up for those of the next one."""
_AGAIN = (0, 1, 2, 4, 8, _MOST_AGAIN)


@dataclass(frozen=True)
class _Condition:
    """A condition on a run, with the constants that it reads and the number of the last machine among theirs."""

    term: z3.BoolRef
    reads: frozenset[int]
    last: int


def run_by_machines(
    system: TransitionSystem, conditions: Sequence[Any], ends: Deadline, seed: int = 0
) -> z3.ModelRef | Literal["none", "unknown"]:
    """Return a model of all conditions, whose constants are `variable@step`; "none" if they contradict each other."""
    return _Run(system, conditions, ends, seed).model()


class _Run:
    """The conditions on a run by the last machine that they read, and the values found so far, by the number of their constant."""

    def __init__(self, system: TransitionSystem, conditions: Sequence[Any], ends: Deadline, seed: int) -> None:
        self._all, self._ends, self._seed = conditions, ends, seed
        self._number = _numbers(system)
        self._last = len(system.parts)
        self._of: dict[int, frozenset[int]] = {}
        self._constants: dict[int, tuple[Any, int]] = {}
        self._values: dict[int, Any] = {}
        self._parts: list[list[_Condition]] = [[] for _ in range(self._last + 1)]
        self._flat = _flat(conditions)
        for term in self._flat:
            reads = self._reads(term)
            last = max((self._constants[one][1] for one in reads), default=0)
            self._parts[last].append(_Condition(term, reads, last))

    def model(self) -> z3.ModelRef | Literal["none", "unknown"]:
        for number in range(len(self._parts)):
            answer = self._found(number)
            if answer != "found":
                return answer
        solver = plain_solver(self._seed)
        solver.add(*self._all, *(self._equal(one) for one in self._values))
        return solver.model() if ask(solver, self._ends.left) == z3.sat else "unknown"

    def _found(self, number: int) -> Literal["found", "none", "unknown"]:
        """Find values for the machine of this number."""
        if not self._parts[number]:
            return "found"
        for again in _AGAIN:
            first = max(0, number - again)
            answer = self._asked(first, number)
            if answer == z3.sat:
                return "found"
            if answer == z3.unknown:
                return "unknown"
            if first == 0:
                return "none"
        return "unknown"

    def _asked(self, first: int, number: int) -> z3.CheckSatResult:
        """Ask for the values of the machines from `first` to this one, given those before; keep the values if there are some."""
        conditions = [one for some in self._parts[first : number + 1] for one in some]
        reads = frozenset[int]().union(*(one.reads for one in conditions))
        given = [one for one in reads if self._constants[one][1] < first and one in self._values]
        solver = plain_solver(self._seed)
        solver.add(*(one.term for one in conditions), *(self._equal(one) for one in sorted(given)))
        answer = ask(solver, self._ends.left)
        if answer == z3.sat:
            model = solver.model()
            for one in reads.difference(given):
                self._values[one] = model.eval(self._constants[one][0], model_completion=True)
        return answer

    def _equal(self, one: int) -> Any:
        return self._constants[one][0] == self._values[one]

    def _reads(self, term: Any) -> frozenset[int]:
        """Return the numbers of the constants that a term reads; each of its parts is looked at once."""
        stack = [term]
        while stack:
            node = stack[-1]
            number, below = node.get_id(), node.children()
            waiting = [one for one in below if one.get_id() not in self._of] if number not in self._of else []
            if waiting:
                stack += waiting
                continue
            stack.pop()
            if number not in self._of:
                self._of[number] = self._own(node) if not below else self._union(below)
        return self._of[term.get_id()]

    def _union(self, below: Sequence[Any]) -> frozenset[int]:
        return frozenset[int]().union(*(self._of[one.get_id()] for one in below))

    def _own(self, node: Any) -> frozenset[int]:
        if node.decl().kind() != z3.Z3_OP_UNINTERPRETED:
            return frozenset()
        name = node.decl().name().rpartition("@")[0]
        self._constants[node.get_id()] = node, self._number.get(name, self._last)
        return frozenset([node.get_id()])


def _numbers(system: TransitionSystem) -> Mapping[str, int]:
    """Return the number of the machine of each variable, by name: of a shared one, that of the first machine; observers have none."""
    numbers: dict[str, int] = {}
    for number, part in enumerate(system.parts):
        for var in (*part.alone.state, *part.alone.inputs):
            numbers.setdefault(getattr(part.into(var), "name", ""), number)
    return numbers


def _flat(conditions: Sequence[Any]) -> list[Any]:
    """Return the conditions, conjunct by conjunct, with the values that some of them state put into the others."""
    goal = z3.Goal()
    goal.add(*conditions)
    done: Any = z3.Tactic("propagate-values")(goal)
    return [term for one in range(len(done)) for term in map(done[one].get, range(done[one].size()))]
