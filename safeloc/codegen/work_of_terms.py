"""The work to compute terms: one for each operation and for each condition, however many choices use it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from safeloc.codegen.merge_choices import chain
from safeloc.language.nodes import Choose, ChooseBool, Expr
from safeloc.language.terms import CHILDREN


def work(terms: Sequence[Expr]) -> int:
    """Return the work to compute the terms; for many sets of terms that share nodes, `Works` is faster."""
    seen, conditions, operations = set[Expr](), set[Expr](), 0
    left, below = [*terms], CHILDREN
    while left:
        node = left.pop()
        if node in seen:
            continue
        seen.add(node)
        kind = type(node)
        parts = below[kind](node)
        left += parts
        if kind is Choose or kind is ChooseBool:
            conditions.add(parts[0])
        elif parts:
            operations += 1
    return operations + len(conditions)


class Works:
    """The work of many sets of terms that share nodes: all that a term needs is one number, with a bit for each operation and condition."""

    def __init__(self) -> None:
        self._needs: dict[Expr, int] = {}
        self._tests: dict[Expr, int] = {}
        self._usual: dict[Expr, int] = {}
        self._bits = 0

    def __call__(self, terms: Iterable[Expr]) -> int:
        """Return the work to compute the terms."""
        needed = 0
        for term in terms:
            needed |= self.needs(term)
        return needed.bit_count()

    def needs(self, term: Expr) -> int:
        """Return the operations and conditions that the term needs, as bits."""
        needs, below = self._needs, CHILDREN
        if term in needs:
            return needs[term]
        left = [term]
        while left:
            node = left[-1]
            parts = below[type(node)](node)
            if waits := [part for part in parts if part not in needs]:
                left += waits
                continue
            left.pop()
            if node not in needs:
                needs[node] = self._of(node, parts)
        return needs[term]

    def usual(self, term: Expr) -> int:
        """Return what a step needs in which no condition of the term's chain of choices holds, as bits."""
        if term not in self._usual:
            rows, last = chain(term)
            needed = self.needs(last)
            for condition, _ in rows:
                needed |= self.needs(condition)
            self._usual[term] = needed
        return self._usual[term]

    def _of(self, node: Expr, parts: Sequence[Expr]) -> int:
        kind = type(node)
        if not parts:
            return 0
        if kind is Choose or kind is ChooseBool:
            needed = self._tests.get(parts[0]) or self._tests.setdefault(parts[0], self._bit())
        else:
            needed = self._bit()
        for part in parts:
            needed |= self._needs[part]
        return needed

    def _bit(self) -> int:
        self._bits += 1
        return 1 << self._bits
