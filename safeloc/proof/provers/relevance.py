"""Selection of hypotheses about a composition: those that read no other machines than the goals do.

Omitting a hypothesis is always sound. Facts of one machine follow from facts about that machine; the others only cost
solver time. For a single machine no hypothesis is omitted.
"""

from __future__ import annotations

import weakref
from collections.abc import Iterable, Mapping

from safeloc.language.expr import Bool, Expr, Var
from safeloc.language.nodes import Node
from safeloc.language.system import TransitionSystem
from safeloc.language.terms import children, conjuncts, in_order


class Relevance:
    """The machines of a composition whose variables a term reads; computed once for each term."""

    def __init__(self, system: TransitionSystem) -> None:
        self._machine: Mapping[Var, int] = _owners(system)
        self._of: dict[Expr, frozenset[int]] = {}

    def machines(self, terms: Iterable[Bool]) -> frozenset[int]:
        """Return the numbers of the machines that the terms read; shared variables belong to none."""
        found: frozenset[int] = frozenset()
        for term in terms:
            if term not in self._of:
                for node in in_order([term], self._of):
                    self._of[node] = self._seen(node)
            found |= self._of[term]
        return found

    def _seen(self, node: Node) -> frozenset[int]:
        if isinstance(node, Var):
            return frozenset([self._machine[node]]) if node in self._machine else frozenset()
        return frozenset().union(*(self._of[child] for child in children(node)))

    def select(self, hypotheses: Iterable[Bool], goals: Iterable[Bool]) -> list[Bool]:
        """Return the conjuncts of the hypotheses that read no other machines than the goals do."""
        wanted = self.machines(goals)
        return [part for one in hypotheses for part in conjuncts(one) if self.machines([part]) <= wanted]


class Selection:
    """Hypotheses that grow in number, of which those are selected that read no other machines than some goals do.

    They are held by the machines that they read, so that a selection looks at each group once, and not at each hypothesis.
    """

    def __init__(self, relevant: Relevance) -> None:
        self._relevant, self._count = relevant, 0
        self._groups: dict[frozenset[int], list[tuple[int, Bool]]] = {}

    def add(self, hypotheses: Iterable[Bool]) -> None:
        """Add hypotheses, conjunct by conjunct."""
        for one in hypotheses:
            for part in conjuncts(one):
                self._groups.setdefault(self._relevant.machines([part]), []).append((self._count, part))
                self._count += 1

    def select(self, wanted: frozenset[int]) -> list[Bool]:
        """Return the conjuncts that read no machines but these, in the order in which they were added."""
        found = [one for read, group in self._groups.items() if read <= wanted for one in group]
        return [part for _, part in sorted(found, key=lambda one: one[0])]


_KNOWN: weakref.WeakKeyDictionary[TransitionSystem, Relevance] = weakref.WeakKeyDictionary()


def relevance(system: TransitionSystem) -> Relevance:
    """Return the relevance of a composition's machines, made once for each system."""
    if system not in _KNOWN:
        _KNOWN[system] = Relevance(system)
    return _KNOWN[system]


def _owners(system: TransitionSystem) -> dict[Var, int]:
    """Map each variable of exactly one machine of the composition to the number of that machine."""
    owners: dict[Var, int] = {}
    shared: set[Var] = set()
    for number, part in enumerate(system.parts):
        for var in (*part.alone.state, *part.alone.inputs):
            twin = part.into(var)
            if isinstance(twin, Var):
                shared |= {twin} if owners.setdefault(twin, number) != number else set()
    return {var: number for var, number in owners.items() if var not in shared}
