"""Terms as shared nodes: equal terms have the same number, so that two terms are compared by their numbers.

A node is an operator with its operands, a variable (name, sort) or a constant. In the normal form nested conjunctions are
one (nested disjunctions too), truth constants are folded, two numbers are compared, and a double negation is removed.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from operator import eq, ge, le, lt

Node = tuple[str | int, ...]
INT, BOOL = "Int", "Bool"
_UNIT = {"and": True, "or": False}
_COMPARISONS = {"<": lt, "<=": le, ">=": ge, "=": eq}


class Dag:
    """All nodes of one run of the checker; a term is its number."""

    def __init__(self) -> None:
        self.nodes: list[Node] = []
        self._number: dict[Node, int] = {}
        self._variables: dict[int, frozenset[int]] = {}
        self.truth = {value: self._kept(("truth", int(value))) for value in (False, True)}

    def _kept(self, node: Node) -> int:
        number = self._number.setdefault(node, len(self.nodes))
        if number == len(self.nodes):
            self.nodes.append(node)
        return number

    def variable(self, name: str, sort: str) -> int:
        """Return the term of a free variable; sort is Int or Bool."""
        return self._kept(("var", name, sort))

    def number(self, value: int) -> int:
        """Return the term of a whole number."""
        return self._kept(("lit", value))

    def make(self, operator: str, parts: Iterable[int]) -> int:
        """Return the operator applied to its operands, in normal form."""
        if operator in _UNIT:
            return self._joined(operator, parts)
        found = tuple(parts)
        if operator == "not":
            return self._negated(found[0])
        if operator in _COMPARISONS and all(self.nodes[part][0] == "lit" for part in found):
            one, other = (int(self.nodes[part][1]) for part in found)
            return self.truth[_COMPARISONS[operator](one, other)]
        return self._chosen(*found) if operator == "ite" else self._kept((operator, *found))

    def _negated(self, part: int) -> int:
        node = self.nodes[part]
        if node[0] == "truth":
            return self.truth[not node[1]]
        return self.parts(part)[0] if node[0] == "not" else self._kept(("not", part))

    def _chosen(self, condition: int, then: int, other: int) -> int:
        yes, no = self.truth[True], self.truth[False]
        if condition in (yes, no):
            return then if condition == yes else other
        if then in (yes, no):
            return (
                self._joined("or", (condition, other))
                if then == yes
                else self._joined("and", (self._negated(condition), other))
            )
        if other in (yes, no):
            return (
                self._joined("or", (self._negated(condition), then))
                if other == yes
                else self._joined("and", (condition, then))
            )
        return self._kept(("ite", condition, then, other))

    def _joined(self, operator: str, parts: Iterable[int]) -> int:
        unit, flat = _UNIT[operator], list[int]()
        for part in parts:
            flat += self.parts(part) if self.nodes[part][0] == operator else (part,)
        flat = [part for part in flat if part != self.truth[unit]]
        if self.truth[not unit] in flat:
            return self.truth[not unit]
        return self.truth[unit] if not flat else flat[0] if len(flat) == 1 else self._kept((operator, *flat))

    def parts(self, term: int) -> tuple[int, ...]:
        """Return the operands of an operator; none for variables and constants."""
        operator, *rest = self.nodes[term]
        return () if operator in ("var", "lit", "truth") else tuple(int(part) for part in rest)

    def conjuncts(self, terms: Iterable[int]) -> frozenset[int]:
        """Return the conjuncts of all these terms, without the constant true."""
        found = set[int]()
        for term in terms:
            found.update(self.parts(term) if self.nodes[term][0] == "and" else (term,))
        return frozenset(found - {self.truth[True]})

    def variables(self, term: int) -> frozenset[int]:
        """Return the variables that a term reads."""
        for node in self.below(term, self._variables):
            itself = frozenset([node]) if self.nodes[node][0] == "var" else frozenset[int]()
            self._variables[node] = itself.union(*(self._variables[part] for part in self.parts(node)))
        return self._variables[term]

    def sort(self, term: int) -> str:
        """Return the sort of a term, Int or Bool."""
        operator, *rest = self.nodes[term]
        if operator in ("var", "ite"):
            return str(rest[1]) if operator == "var" else self.sort(int(rest[1]))
        return INT if operator in ("lit", "+", "-", "*", "div") else BOOL

    def below(self, term: int, done: Mapping[int, object]) -> list[int]:
        """Return a term and the nodes below it, operands first, without those in `done` and the nodes below these."""
        order, stack, seen = list[int](), [(term, False)], set[int]()
        while stack:
            node, complete = stack.pop()
            if complete:
                order.append(node)
            elif node not in seen and node not in done:
                seen.add(node)
                stack.append((node, True))
                stack += [(part, False) for part in self.parts(node)]
        return order


class Rewriting:
    """Replaces variables by terms."""

    def __init__(self, dag: Dag, replaced: Mapping[int, int]) -> None:
        self._dag, self._done = dag, dict(replaced)

    def __call__(self, term: int) -> int:
        """Return the term after replacement."""
        for node in self._dag.below(term, self._done):
            parts = self._dag.parts(node)
            after = [self._done[part] for part in parts]
            same = after == list(parts)
            self._done[node] = node if same else self._dag.make(str(self._dag.nodes[node][0]), after)
        return self._done[term]

    def all(self, terms: Iterable[int]) -> frozenset[int]:
        """Return the conjuncts of these terms, after replacement."""
        return self._dag.conjuncts(map(self, terms))
